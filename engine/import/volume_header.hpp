#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace sulcus {

/// Voxels that a volume may have: 1024 cubed, the largest grid of ours.
inline constexpr std::uint64_t kMaxVolumeVoxels = std::uint64_t{1} << 30;

/// What is wanted from a volume's header ahead of the library that reads the rest.
struct VolumeHeaderFacts {
  bool spacing_known = true;
  double length_unit_m = 1e-3;  // what a length of 1 in the file means
};

// Light checks of headers that announce more than the file holds, made before anybody takes memory
// for the voxels. They look only at sizes, type and length; everything else is the library's.
// All throw InputError.

/// NRRD: sizes, type, spacings, and the length of raw or gzip data [teem, NRRD format 5].
VolumeHeaderFacts check_nrrd_header(const std::string& path);
/// MetaImage: the same for DimSize, ElementType, ElementSpacing and ElementDataFile.
VolumeHeaderFacts check_meta_image_header(const std::string& path);
/// NIfTI-1, plain or gzip (which is read through once, to see that it is whole): dim, datatype and
/// pixdim. NIfTI-2 passes.
void check_nifti_header(const std::string& path);

/// Product of the sizes. Throws where one is not positive or the product exceeds
/// kMaxVolumeVoxels; `place` names the header's field.
std::uint64_t checked_voxel_count(const std::string& path, const std::string& place,
                                  std::span<const std::int64_t> sizes);
/// Throws unless the value is finite and positive.
void check_spacing(const std::string& path, const std::string& place, double spacing);

}  // namespace sulcus
