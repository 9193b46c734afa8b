#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/trajectory.hpp"
#include "haptics/device/simulated_device.hpp"
#include "haptics/tick.hpp"
#include "tools/sulcus_lab/laws/law_shapes.hpp"

namespace sulcus::lab {

// A scene that ticks: the round burr, one solid or several, and a device that is where it is put.

/// Axis from tip to shank, along none of the grid's.
inline const Eigen::Vector3d kLawAxis = Eigen::Vector3d(0.15, -0.1, 1.0).normalized();

/// The tool with the middle of its ball there.
Pose pose_at_centre(const Eigen::Vector3d& centre_m, const Eigen::Vector3d& axis = kLawAxis);
/// Poses to and with the last of the corners that the ball's middle goes along, from the first on,
/// in steps of `step_m` at most.
std::vector<Pose> poses_along(std::span<const Eigen::Vector3d> corners_m, double step_m);
/// A circle of the ball's middle, from its uppermost point round to just before it: it goes
/// `depth_m` below where the ball touches the shape, across its edge.
std::vector<Eigen::Vector3d> circle_over(const LawShape& shape, double depth_m, double radius_m,
                                         double step_m, bool back);

struct LawSceneSettings {
  std::string_view scaling = "smooth";
  std::string_view haptics = {};  // more keys of [haptics]
  std::string_view burr = "speed_rpm = 0";
  std::string_view tables = {};  // more tables
  std::string_view tissues = "'enamel'";
  bool coupling = false;
};
/// A scene with a round burr of 1 mm. Tissues have 30 N/mm, under `none` 0.3, behind a coupling ten
/// times as much.
Scene law_scene(const LawSceneSettings& settings);

class LawRig {
 public:
  /// `solids`: the workpiece, then those of the scene's bodies.
  LawRig(const Scene& scene, std::vector<VoxelModel> solids);
  LawRig(const Scene& scene, const VoxelModel& solid)
      : LawRig(scene, std::vector<VoxelModel>{solid}) {}
  LawRig(const LawRig&) = delete;  // the context refers into it
  LawRig& operator=(const LawRig&) = delete;

  TickResult step(Device& device) { return tick(context_, device, state_, scratch_); }
  TickResult step(const Pose& pose);
  /// The last of several.
  TickResult steps(std::span<const Pose> poses);

  const Scene& scene() const { return scene_; }
  const Burr& burr() const { return burr_; }
  const SimulationState& state() const { return state_; }
  /// Of the last tick.
  const TickScratch& scratch() const { return scratch_; }

 private:
  Scene scene_;
  Burr burr_;
  SimulationState state_;
  TickScratch scratch_;
  TickContext context_;
};

/// Gives one pose until it is given another; what is sent goes nowhere.
class PutDevice final : public Device {
 public:
  std::optional<Pose> pose(std::uint64_t) noexcept override { return put; }
  void apply(const Wrench&) noexcept override {}
  std::optional<Pose> put;
};

}  // namespace sulcus::lab
