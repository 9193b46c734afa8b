#include "engine/cache/cached_field.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

namespace sulcus {
namespace {

/// Samples of a quarter of a field, in x and z from the low faces to the middle, x fastest.
struct Quarter {
  Eigen::Vector3i samples;
  std::size_t row, slice;

  explicit Quarter(const Eigen::Vector3i& n)
      : samples((n.x() + 1) / 2, n.y(), (n.z() + 1) / 2),
        row(static_cast<std::size_t>(samples.x())),
        slice(row * static_cast<std::size_t>(samples.y())) {}
  std::size_t count() const { return slice * static_cast<std::size_t>(samples.z()); }
};

bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

/// Whether all of a field follows from its quarter by mirrors.
bool is_mirrored(const DistanceField& field) {
  const Eigen::Vector3i n = field.samples();
  const Quarter quarter(n);
  using Range = tbb::blocked_range<int>;
  return tbb::parallel_reduce(
      Range(0, quarter.samples.z()), true,
      [&](const Range& range, bool same) {
        for (int k = range.begin(); same && k < range.end(); ++k) {
          for (int j = 0; same && j < n.y(); ++j) {
            for (int i = 0; i < quarter.samples.x(); ++i) {
              const int i2 = n.x() - 1 - i, k2 = n.z() - 1 - k;
              const float d = field.at(i, j, k);
              same = same && same_bits(d, field.at(i2, j, k)) && same_bits(d, field.at(i, j, k2)) &&
                     same_bits(d, field.at(i2, j, k2));
            }
          }
        }
        return same;
      },
      [](bool a, bool b) { return a && b; });
}

void copy_mirrored(const std::vector<float>& from, const Quarter& quarter, DistanceField& field) {
  const Eigen::Vector3i n = field.samples();
  tbb::parallel_for(0, quarter.samples.z(), [&](int k) {
    const int k2 = n.z() - 1 - k;
    for (int j = 0; j < n.y(); ++j) {
      const float* row = from.data() + quarter.slice * static_cast<std::size_t>(k) +
                         quarter.row * static_cast<std::size_t>(j);
      float* to = &field.at(0, j, k);
      std::copy_n(row, quarter.row, to);
      std::reverse_copy(row, row + quarter.row, to + n.x() - quarter.samples.x());
      std::copy_n(to, n.x(), &field.at(0, j, k2));
    }
  });
}

}  // namespace

std::optional<DistanceField> read_cached_field(LoadCache& cache, const Hash128& key,
                                               const FieldGrid& grid) {
  if (!cache.keeps()) return std::nullopt;
  const Quarter quarter(grid.samples);
  std::vector<float> samples;
  std::optional<DistanceField> field;
  const bool read = cache.read(CacheKind::kField, key, [&](std::uint64_t bytes) {
    field.emplace(grid);
    if (bytes == quarter.count() * sizeof(float)) {
      samples.resize(quarter.count());
      return std::as_writable_bytes(std::span(samples));
    }
    // Read to where it stays: it is the largest thing that a run keeps.
    const std::span<float> all(&field->at(0, 0, 0), field->values().size());
    return all.size_bytes() == bytes ? std::as_writable_bytes(all) : std::span<std::byte>();
  });
  if (!read) return std::nullopt;
  const auto finite = [](std::span<const float> values) {
    return std::ranges::all_of(values, [](float d) { return std::isfinite(d); });
  };
  if (!finite(samples.empty() ? field->values() : samples)) {
    cache.refuse(key);
    return std::nullopt;
  }
  if (!samples.empty()) copy_mirrored(samples, quarter, *field);
  return field;
}

void write_cached_field(LoadCache& cache, const Hash128& key, const DistanceField& field) {
  if (!cache.keeps()) return;
  if (!is_mirrored(field)) {
    return cache.write(CacheKind::kField, key, {std::as_bytes(field.values())});
  }
  const Quarter quarter(field.samples());
  std::vector<float> samples;
  samples.reserve(quarter.count());
  for (int k = 0; k < quarter.samples.z(); ++k) {
    for (int j = 0; j < quarter.samples.y(); ++j) {
      const float* row = field.values().data() + j * field.row_pitch() + k * field.slice_pitch();
      samples.insert(samples.end(), row, row + quarter.row);
    }
  }
  cache.write(CacheKind::kField, key, {std::as_bytes(std::span(samples))});
}

}  // namespace sulcus
