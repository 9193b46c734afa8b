#pragma once

#include <optional>

#include "engine/cache/load_cache.hpp"
#include "engine/tool/distance_field.hpp"

namespace sulcus {

// A distance field in the load cache (CacheKind::kField), f32: its samples as they lie in memory;
// or, where it is its own mirror image in x and in z, as that of a generated burr is, those of a
// quarter, x fastest. The length tells which.

/// Empty where there is no such entry, or one that does not fill the grid with finite distances.
/// The grid must be a part of the key.
std::optional<DistanceField> read_cached_field(LoadCache& cache, const Hash128& key,
                                               const FieldGrid& grid);
void write_cached_field(LoadCache& cache, const Hash128& key, const DistanceField& field);

}  // namespace sulcus
