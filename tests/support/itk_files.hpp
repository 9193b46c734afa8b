#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace sulcus::test {

// Volumes written by ITK, as other programs write them: in plain types, since its Eigen and ours
// cannot meet in one source file.

struct PlainVolume {
  std::array<int, 3> sizes{};
  std::array<double, 3> spacing_mm{}, origin_mm{};
  std::array<std::array<double, 3>, 3> axes{};  // axes[d]: unit vector along index d
  std::vector<std::uint16_t> values;            // x fastest
};

/// As one file, or a header and its raw data: .nrrd .nhdr .mha .mhd .nii .nii.gz .tif; a TIFF says
/// neither origin nor direction.
void write_with_itk(const std::string& path, const PlainVolume& volume);

/// As a folder of slices, "slice_1.EXT" first: .tif, .png, or .dcm, which alone says where they
/// lie.
void write_slices_with_itk(const std::string& folder, const std::string& extension,
                           const PlainVolume& volume);

}  // namespace sulcus::test
