#include "engine/import/volumes/volume_checks.hpp"

#include <algorithm>
#include <sstream>

#include "engine/core/error.hpp"

namespace sulcus {
namespace {

// In any unit; beyond these the inverse of a direction is no good number.
constexpr double kLeastSpacing = 1e-9, kMostSpacing = 1e9;
constexpr std::int64_t kMaxVoxelsPerAxis = 1 << 24;

}  // namespace

std::uint64_t checked_voxel_count(const std::string& path, const std::string& place,
                                  std::span<const std::int64_t> sizes, const InputLimits& limits) {
  std::uint64_t count = 1;
  for (const std::int64_t size : sizes) {
    if (size <= 0) throw InputError(path, place, std::to_string(size), "at least 1 voxel");
    // Compared by division: the product itself may not fit in 64 bits.
    if (size > kMaxVoxelsPerAxis || static_cast<std::uint64_t>(size) > limits.voxels() / count) {
      std::string text;
      for (const std::int64_t s : sizes) text += (text.empty() ? "" : " x ") + std::to_string(s);
      throw InputError(path, place, text + " voxels",
                       "at most " + std::to_string(limits.voxels()) + " (--limit-gib)");
    }
    count *= static_cast<std::uint64_t>(size);
  }
  return count;
}

void check_three_axes(const std::string& path, std::span<const std::int64_t> sizes) {
  if (sizes.size() >= 3 &&
      std::ranges::all_of(sizes.subspan(3), [](std::int64_t size) { return size == 1; })) {
    return;
  }
  throw InputError(path, "dimension", std::to_string(sizes.size()), "3");
}

void check_data_bytes(const std::string& path, std::uint64_t held, std::uint64_t least,
                      DataLength length) {
  const bool exact = length == DataLength::kExact;
  if (held == least || (held > least && !exact)) return;
  throw InputError(path, "data", std::to_string(held) + " bytes",
                   (exact ? "" : "at least ") + std::to_string(least) + " bytes after the header");
}

void check_spacing(const std::string& path, const std::string& place, double spacing) {
  if (spacing >= kLeastSpacing && spacing <= kMostSpacing) return;
  std::ostringstream found;
  found << spacing;
  throw InputError(path, place, found.str(), "a positive length");
}

void set_steps(MedicalVolume& volume, const std::string& place, const Eigen::Matrix3d& steps,
               double unit_m) {
  for (int d = 0; d < 3; ++d) {
    const double length = steps.col(d).norm();
    check_spacing(volume.file, place, length);
    volume.spacing_m[d] = length * unit_m;
    volume.direction.col(d) = steps.col(d) / length;
  }
}

void rescale(std::span<float> values, double slope, double offset) {
  if (slope == 1.0 && offset == 0.0) return;
  for (float& value : values) {
    value = static_cast<float>(slope * static_cast<double>(value) + offset);
  }
}

void set_sizes(MedicalVolume& volume, std::span<const std::int64_t> sizes) {
  std::size_t count = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    volume.sizes[static_cast<Eigen::Index>(d)] = static_cast<int>(sizes[d]);
    count *= static_cast<std::size_t>(sizes[d]);
  }
  volume.values.resize(count);
}

}  // namespace sulcus
