#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/scene/scene.hpp"

namespace sulcus {

// What `sulcus inspect` prints, one room for each kind of file. All throw InputError for a file
// that is not what its name says. `picture_png`, where it is not empty, is a picture to be drawn;
// where gnuplot cannot draw it, std::runtime_error.

/// Header, ticks, edits, what is missing.
void inspect_recording(const std::string& file);
/// What it names: workpiece, burr, haptics, device, way, goal. InputError where a file that it
/// names is not there; but for its trajectory they are not opened, save for a picture, which is of
/// its burr.
void inspect_scene(const std::string& file, const std::vector<std::string>& overrides,
                   const std::string& picture_png);
/// Size and place, in the file and in a scene; shells, edges that close nothing, the volume within,
/// as the triangles sum it up and as it would be voxelised; the command that cuts it, or where it
/// is as large as no tooth the unit that it may be in. Pictured from three sides, with axes.
void inspect_mesh(const std::string& file, MeshUnit unit, const std::string& picture_png);
/// A mesh as the burr of a scene that says no more of it; pictured as a scene's burr is.
void inspect_burr(const std::string& file_mesh, MeshUnit unit, const std::string& picture_png);
/// Size, place, grey values with the thresholds they suggest, and the command that cuts it; of a
/// mask or a label map each value with its box and its middle. Pictured: three sections and the
/// histogram. `spacing_m`: in place of the file's, which may say none; then there are no lengths.
void inspect_volume(const std::string& file, const std::optional<Eigen::Vector3d>& spacing_m,
                    const std::string& picture_png);

}  // namespace sulcus
