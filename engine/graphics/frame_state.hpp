#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/core/pose.hpp"

namespace sulcus {

/// Time of a stage of the tick.
struct StageTime {
  const char* name = "";
  double us = 0.0;
};

/// A line about what a preparation has done so far.
struct OutcomeLine {
  std::string name, value;
};

/// A voxel in contact.
struct ContactMark {
  Eigen::Vector3d centre_world;
  double force_N = 0.0;  // along its normal
};

/// What a frame shows besides the tooth.
struct FrameState {
  std::string title;
  double time_s = 0.0;
  std::uint64_t tick = 0;
  Pose world_from_tool;
  // How pieces cut loose have moved, world now from world where they were, in the order in which
  // they were added to the renderer. Pieces beyond the poses are not drawn.
  std::span<const Pose> pieces;
  bool burr_shown = true;
  // Where the device is that the tool hangs on: drawn palely through all else.
  std::optional<Pose> device;
  double burr_turn_rad = 0.0;                           // of the spindle, about the tool's +y
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();    // world
  Eigen::Vector3d torque_Nm = Eigen::Vector3d::Zero();  // world
  std::uint32_t contacts = 0;
  // To be shown, as squares over the picture, where there are any.
  std::span<const ContactMark> contact_marks;
  double contact_mark_m = 0.0;  // edge of a voxel
  double tick_us = 0.0;
  double removed_mm3 = 0.0;
  std::vector<OutcomeLine> outcome;
  std::vector<StageTime> stages;  // none where they were not measured
  // For the curves, magnitudes, the newest last; any length, also none.
  std::span<const float> force_history_N;
  std::span<const float> torque_history_mNm;
  std::span<const float> tick_history_us;
  // None where the scene has no spindle that sags, or no pulp; not a number before it is cut.
  std::span<const float> spindle_history_krpm;
  std::span<const float> pulp_history_mm;  // of tooth that is left over it
};

}  // namespace sulcus
