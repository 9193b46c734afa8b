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

/// Whether a volume that was just written compressed, as NRRD, MetaImage in one file or NIfTI,
/// holds all of its stream: that it ends where the file ends, and unpacks to these many bytes at
/// least (of the voxels; NIfTI's header comes ahead). Their writer does not see a full disk.
/// @throws std::runtime_error where it cannot be read.
bool is_whole_volume(const std::string& path, std::uint64_t bytes);

}  // namespace sulcus
