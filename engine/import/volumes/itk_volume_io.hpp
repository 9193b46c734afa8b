#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace sulcus {

// The seam to ITK's writers, in plain types: ITK brings an Eigen of its own, which cannot meet ours
// in one source file. Everybody else writes through write_volume.hpp.

/// A uint8 volume to be written.
struct ItkMask {
  std::array<int, 3> sizes{};
  std::array<double, 3> spacing_m{};
  std::array<double, 3> origin_m{};             // centre of the first voxel
  std::array<std::array<double, 3>, 3> axes{};  // axes[d]: unit vector along index d
  std::vector<std::uint8_t> voxels;             // x fastest
};

/// Its name decides the format. @throws std::runtime_error where the file cannot be written.
void write_volume_with_itk(const std::string& path, const ItkMask& mask);

}  // namespace sulcus
