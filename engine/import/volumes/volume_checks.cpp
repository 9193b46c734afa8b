#include "engine/import/volumes/volume_checks.hpp"

#include <limits>
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

void set_sizes(MedicalVolume& volume, std::span<const std::int64_t> sizes) {
  std::size_t count = 1;
  for (std::size_t d = 0; d < 3; ++d) {
    volume.sizes[static_cast<Eigen::Index>(d)] = static_cast<int>(sizes[d]);
    count *= static_cast<std::size_t>(sizes[d]);
  }
  volume.values.resize(count);
}

}  // namespace sulcus
