#pragma once

#include <string_view>

namespace sulcus {

/// Text of assets/tissues.toml, built into the program.
std::string_view tissue_table_toml();

}  // namespace sulcus
