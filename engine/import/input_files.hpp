#pragma once

#include <optional>
#include <string>

#include "engine/cache/hash128.hpp"

namespace sulcus {

/// Hash of all that a volume or mesh file holds and of what its name says of its format: with a
/// header the data file that it names, of a folder every file in it, with their names. Files are
/// hashed in parallel (oneTBB). Empty where one of them cannot be read, or where a header names its
/// data in a way that only the reader understands (a list, a numbered pattern).
std::optional<Hash128> hash_input(const std::string& path);

}  // namespace sulcus
