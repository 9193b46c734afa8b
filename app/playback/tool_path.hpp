#pragma once

#include <span>
#include <string>

#include <Eigen/Geometry>

#include "engine/recording/tick_record.hpp"

namespace sulcus {

/// Writes where the tip of the burr was, tick by tick, as one line for other programs to draw: .vtk
/// (VTK's legacy text, with time_s, force_N and removed at each point) or .ply (text; vertices with
/// the same, and edges). mm in the space that `space_from_world` leads to.
/// @throws as write_whole_file.
void write_tool_path(const std::string& file, std::span<const TickRecord> rows,
                     const Eigen::Affine3d& space_from_world);

}  // namespace sulcus
