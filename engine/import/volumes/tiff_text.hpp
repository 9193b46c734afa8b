#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

namespace sulcus {

/// What the description of a TIFF's first page says of the stack, as ImageJ and OME write it.
struct TiffText {
  std::optional<std::int64_t> slices;   // as many as pages, unless it is no single stack
  std::int64_t others = 1;              // channels times points in time
  std::optional<double> x_m, y_m, z_m;  // of a voxel
  std::optional<double> unit_m;         // ImageJ: what resolutions count by
};

/// @throws InputError (`file`): a unit of length that is not known.
TiffText read_tiff_text(const std::string& file, const std::string& description);

}  // namespace sulcus
