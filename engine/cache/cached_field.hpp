#pragma once

#include <optional>

#include "engine/cache/load_cache.hpp"
#include "engine/tool/distance_field.hpp"

namespace sulcus {

// A distance field in the load cache (CacheKind::kField), f32: the samples that it keeps, as they
// lie in memory.

/// Empty where there is no such entry, or one that does not fill the field with finite distances.
/// The grid must be a part of the key, and the mirrors follow from it.
std::optional<DistanceField> read_cached_field(LoadCache& cache, const Hash128& key,
                                               const FieldGrid& grid, FieldMirrors mirrors);
void write_cached_field(LoadCache& cache, const Hash128& key, const DistanceField& field);

}  // namespace sulcus
