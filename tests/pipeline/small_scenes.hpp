#pragma once

#include <string>

namespace sulcus::test {

/// A 2 mm block of 64^3 voxels and a small burr.
inline std::string block_and_burr() {
  return R"(
[workpiece]
shape = "box"
voxel_mm = 0.05
cells = [64, 64, 64]
[workpiece.box]
size_mm = [2, 2, 2]
[burr]
diameter_mm = 0.8
speed_rpm = 100000
field = [48, 192, 48]
)";
}

/// Probing it, done in a fraction of a second.
inline std::string probe_scene() {
  return "title = \"small\"" + block_and_burr() + R"(
[trajectory]
points_mm = [[-0.6, 0, 1.2], [-0.6, 0, 0.92], [0.6, 0, 0.92], [0.6, 0, 1.2]]
speed_mm_per_s = 4
)";
}

/// The same, cutting and recording.
inline std::string cut_scene() {
  return probe_scene() + R"(
[cutting]
[record]
)";
}

/// Drawn as well.
inline std::string render_scene() {
  return cut_scene() + R"(
[render]
size = [320, 240]
fps = 4
)";
}

/// A block, its size in mm, and a flat fissure burr of 1 mm that is sunk into it as into butter.
inline std::string block_and_fissure_burr(const std::string& size_mm, const std::string& voxel_mm,
                                          const std::string& cells) {
  return R"(
[workpiece]
shape = "box"
voxel_mm = )" +
         voxel_mm + "\ncells = " + cells + "\n[workpiece.box]\nsize_mm = " + size_mm + R"(
[burr]
shape = "fissure"
diameter_mm = 1.0
length_mm = 3
speed_rpm = 300000
field = [48, 192, 48]
)";
}

/// A post that is cut through, so that its upper end falls on its stump.
inline std::string post_scene() {
  return R"(
[workpiece]
shape = "box"
voxel_mm = 0.05
cells = [64, 64, 64]
[workpiece.box]
size_mm = [0.5, 0.5, 2.4]
[burr]
diameter_mm = 0.8
speed_rpm = 150000
field = [48, 192, 48]
[trajectory]
points_mm = [[-0.8, -0.4, 0.3]]
axis = [0, 1, 0]
hold_s = 2.5
load_N = 0.5
load_direction = [1, 0, 0]
[haptics]
normals = "ldm_fast"
[cutting]
[loose_pieces]
[record]
)";
}

}  // namespace sulcus::test
