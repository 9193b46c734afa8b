#pragma once

#include <string>
#include <string_view>

namespace sulcus {

/// Refuses a text in which arrays and inline tables lie deeper than InputLimits::kSceneDepth or
/// whose keys have more parts, before toml++ reads it: it removes a table of tables by recursion,
/// and a key of 10^5 parts makes as many tables. Anything else that is no TOML passes.
/// @throws InputError with line and column.
void check_toml_depth(std::string_view text, const std::string& file);

}  // namespace sulcus
