#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace sulcus {

/// OME: slices that follow each other on pages of a file, from the first of either.
struct TiffTextBlock {
  std::string file;  // empty: the one that says so
  std::int64_t page = 0, slice = 0;
};

/// What the description of a TIFF's first page says of the stack, as ImageJ, OME and tifffile
/// write it.
struct TiffText {
  std::optional<std::int64_t> slices;   // as many as pages, unless it is no single stack
  bool one_stack = true;                // false: several channels or points in time
  std::vector<TiffTextBlock> blocks;    // where slices lie; none: page by page
  std::vector<std::int64_t> shape;      // of tifffile's array; empty: not said
  std::optional<double> x_m, y_m, z_m;  // of a voxel
  std::optional<double> unit_m;         // ImageJ: what resolutions count by
  std::string unknown_unit;             // of a length that is therefore not known
};

/// @throws InputError (`file`): an OME text that is none.
TiffText read_tiff_text(const std::string& file, const std::string& description);

}  // namespace sulcus
