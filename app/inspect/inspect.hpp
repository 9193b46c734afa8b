#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace sulcus {

// What `sulcus inspect` prints, one room for each kind of file. All throw InputError for a file
// that is not what its name says. `picture_png`, where it is not empty, is a picture to be drawn;
// where gnuplot cannot draw it, std::runtime_error.

/// Header, ticks, edits, what is missing.
void inspect_recording(const std::string& file);
/// What it names; the files that it names are not opened, but for a picture, which is of its burr.
void inspect_scene(const std::string& file, const std::vector<std::string>& overrides,
                   const std::string& picture_png);
/// Size, shells, edges that close nothing, and the volume within: as the triangles sum it up, and
/// as it would be voxelised.
void inspect_mesh(const std::string& file);
/// A mesh as the burr of a scene that says no more of it; pictured as a scene's burr is.
void inspect_burr(const std::string& file_mesh, const std::string& picture_png);
/// Size, place, grey values with the thresholds they suggest, and the command that cuts it; of a
/// mask or a label map each value with its box and its middle. Pictured: three sections and the
/// histogram. `spacing_m`: in place of the file's, which may say none; then there are no lengths.
void inspect_volume(const std::string& file, const std::optional<Eigen::Vector3d>& spacing_m,
                    const std::string& picture_png);

}  // namespace sulcus
