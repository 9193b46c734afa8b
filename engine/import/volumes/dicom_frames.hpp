#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/input_limits.hpp"
#include "engine/import/volumes/dicom_pixels.hpp"

namespace sulcus {

/// A picture of a file, and where it lies.
struct DicomFrame {
  std::size_t file = 0;
  std::uint32_t index = 0;  // in its file
  std::optional<Eigen::Vector3d> position_mm;
  double slope = 1.0, intercept = 0.0;
  double instance = 0.0;
};

/// What must be the same of all frames.
struct DicomPlane {
  /// Of a plane that says how it is turned.
  Eigen::Vector3d normal() const { return orientation->head<3>().cross(orientation->tail<3>()); }

  std::optional<Eigen::Matrix<double, 6, 1>> orientation;
  std::optional<Eigen::Vector2d> spacing_mm;  // between rows, between columns
};

/// The frames of one file.
struct DicomFrames {
  std::vector<DicomFrame> frames;
  DicomPixelForm form;
  DicomPlane plane;
  std::string series;
  std::optional<double> between_mm;  // SpacingBetweenSlices
  bool spread_out = false;           // places that follow from one, not each frame's own
};

// Names of attributes in messages.
inline constexpr const char* kDicomPosition = "ImagePositionPatient";
inline constexpr const char* kDicomOrientation = "ImageOrientationPatient";
inline constexpr const char* kDicomBetweenSlices = "SpacingBetweenSlices";

/// What a file says of its frames; `number` is the file's. None: a file without pixels, as
/// structured reports and plans are, and directories of others.
/// @throws InputError: damaged, frames that are not alike, or follow each other in time.
std::optional<DicomFrames> read_dicom_frames(const std::string& path, std::size_t number,
                                             const InputLimits& limits);

/// Refuses a frame of the file at `path` that is not in the plane of the first.
void check_dicom_plane(const std::string& path, const DicomPlane& plane, const DicomPlane& first);

}  // namespace sulcus
