#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "engine/core/input_limits.hpp"

namespace sulcus {

/// What is wanted from a volume's header ahead of the library that reads the rest.
struct VolumeHeaderFacts {
  bool spacing_known = true;
  double length_unit_m = 1e-3;  // what a length of 1 in the file means
};

// Light checks of headers that announce more than the file holds, made before anybody takes memory
// for the voxels. They look only at sizes, type and length; everything else is the library's.
// All throw InputError.

/// What of a text header is read.
inline constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 20;

/// NRRD: sizes, type, spacings, and the length of raw or gzip data [teem, NRRD format 5].
VolumeHeaderFacts check_nrrd_header(const std::string& path, const InputLimits& limits);
/// MetaImage: the same for DimSize, ElementType, ElementSpacing and ElementDataFile.
VolumeHeaderFacts check_meta_image_header(const std::string& path, const InputLimits& limits);
/// NIfTI-1, plain or gzip (which is read through once, to see that it is whole): dim, datatype and
/// pixdim, and that what it says of directions is finite.
void check_nifti_header(const std::string& path, const InputLimits& limits);

/// Product of the sizes. Throws where one is not positive or the product exceeds what the limits
/// allow; `place` names the header's field.
std::uint64_t checked_voxel_count(const std::string& path, const std::string& place,
                                  std::span<const std::int64_t> sizes, const InputLimits& limits);
/// Throws unless the value is positive, finite and of a size that a length may have.
void check_spacing(const std::string& path, const std::string& place, double spacing);

}  // namespace sulcus
