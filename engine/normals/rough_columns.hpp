#pragma once

#include "engine/normals/height_map.hpp"

namespace sulcus {

/// Whether columns out of line with their neighbours along either axis of a map are many and spread
/// over it (kFewestOutOfLine, kLeastSpread): the surface is rough. Along an edge they lie in a row.
/// The same in every turn of the map.
bool has_rough_columns(const HeightMap& map) noexcept;

}  // namespace sulcus
