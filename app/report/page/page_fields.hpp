#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "engine/outcome/voxel_set.hpp"
#include "engine/scene/assessment_table.hpp"
#include "engine/surface/surface_colour.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// What the surface in a box is coloured by, whatever has been cut of it: samples of the voxels on
/// a lattice that the page looks up at each pixel.
struct PageFields {
  /// One byte stands for so much; 128 is 0 of the goal, 0 of the depth.
  static constexpr double kGoalStep_m = 0.01e-3, kDepthStep_m = 0.04e-3;

  Cell first = Cell::Zero();  // the voxel of sample (0, 0, 0)
  int step = 1;               // voxels from sample to sample
  Eigen::Vector3i samples = Eigen::Vector3i::Zero();
  /// Of each sample, x fastest: the colour of the tissue as it was, sRGB, and how far it lies from
  /// the goal's wall, beyond it above 128; 0 without a goal.
  std::vector<std::array<std::uint8_t, 4>> tissue_goal{};
  /// Its turn in the order of what was cut, times the share of what was about it that was cut; that
  /// share; and how deep it lies under the tooth's old surface.
  std::vector<std::array<std::uint8_t, 3>> cut_depth{};
};

struct FieldSettings {
  std::span<const TissueLook> looks;
  std::span<const Edit> edits;       // of all bodies
  std::size_t body = 0;              // whose the model is
  const VoxelSet* target = nullptr;  // what the goal wants removed; null: no goal
  /// Depth: of a cavity along the path of insertion, of a crown to the nearest of the surface.
  AssessedKind kind = AssessedKind::kCavity;
  Eigen::Vector3d insertion{0, 0, 1};
};

/// Over the voxels [box.min(), box.max()], on at most 250,000 samples. `start`: before the edits.
/// Runs on oneTBB.
PageFields page_fields(const VoxelModel& start, const Eigen::AlignedBox3i& box,
                       const FieldSettings& settings);

/// As a screen shows it, 0 to 255, of a linear part [IEC 61966-2-1].
std::uint8_t screen_byte(double linear);

}  // namespace sulcus
