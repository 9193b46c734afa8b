#pragma once

#include <string>
#include <vector>

#include "engine/core/input_limits.hpp"
#include "engine/scene/scene.hpp"

namespace sulcus {

/// A table of poses, as it is read.
struct PoseTable {
  std::vector<TimedPose> poses;   // at least one; times from 0, strictly rising
  double clock_at_start_s = 0.0;  // what the file's clock says at the first of them
};

/// Reads a CSV of poses, world from tool. The first line names the columns: t_s, x_mm, y_mm, z_mm,
/// qw, qx, qy, qz in any order; or those of `sulcus export --csv`, time_s and device_x_mm to
/// device_qz, or where these are not there tool_x_mm to tool_qz. Others are passed over. Blanks
/// about a field, empty lines, lines that begin with #, and the mark that some programs put before
/// UTF-8 mean nothing.
/// @throws InputError with the line: a column that is missing, a field that is no finite number,
/// times that do not rise, a place beyond 1 km, more than 10^6 s, a quaternion that is no rotation,
/// more rows than the limits allow.
PoseTable read_pose_table(const std::string& file, const InputLimits& limits);

}  // namespace sulcus
