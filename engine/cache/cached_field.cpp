#include "engine/cache/cached_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace sulcus {

std::optional<DistanceField> read_cached_field(LoadCache& cache, const Hash128& key,
                                               const FieldGrid& grid, FieldMirrors mirrors) {
  if (!cache.keeps()) return std::nullopt;
  std::optional<DistanceField> field;
  const bool read = cache.read(CacheKind::kField, key, [&](std::uint64_t bytes) {
    // Read to where it stays: it is one of the largest things that a run keeps.
    field.emplace(grid, mirrors);
    return bytes == field->memory_bytes() ? std::as_writable_bytes(field->values())
                                          : std::span<std::byte>();
  });
  if (!read) return std::nullopt;
  if (!std::ranges::all_of(field->values(), [](float d) { return std::isfinite(d); })) {
    cache.refuse(key);
    return std::nullopt;
  }
  return field;
}

void write_cached_field(LoadCache& cache, const Hash128& key, const DistanceField& field) {
  if (cache.keeps()) cache.write(CacheKind::kField, key, {std::as_bytes(field.values())});
}

}  // namespace sulcus
