#include "engine/cache/cached_field.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

namespace sulcus {

std::optional<DistanceField> read_cached_field(LoadCache& cache, const Hash128& key,
                                               const FieldGrid& grid) {
  if (!cache.keeps()) return std::nullopt;
  std::optional<DistanceField> field;
  const bool read = cache.read(CacheKind::kField, key, [&](std::uint64_t bytes) {
    field.emplace(grid);
    // Read to where it stays: it is the largest thing that a run keeps.
    const std::span<float> samples(&field->at(0, 0, 0), field->values().size());
    return samples.size_bytes() == bytes ? std::as_writable_bytes(samples) : std::span<std::byte>();
  });
  if (!read) return std::nullopt;
  if (std::ranges::any_of(field->values(), [](float d) { return !std::isfinite(d); })) {
    cache.refuse(key);
    return std::nullopt;
  }
  return field;
}

void write_cached_field(LoadCache& cache, const Hash128& key, const DistanceField& field) {
  cache.write(CacheKind::kField, key, {std::as_bytes(field.values())});
}

}  // namespace sulcus
