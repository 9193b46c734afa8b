#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/session/simulation.hpp"
#include "tools/sulcus_lab/stability/point_proxy.hpp"
#include "tools/sulcus_lab/stability/stability_row.hpp"

namespace sulcus::lab {

// One tool, one solid, one method, tick by tick: what every case is made of.
//
//   device (a path, or a simulated one) --pose--> Simulation, or PointProxy --what is felt--> case
//
// The single point stands where a round burr's lowest point is: at the tool's tip.

/// What a tick gave, before any limit of the device.
struct Felt {
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();          // for the hand
  Eigen::Vector3d torque_Nm = Eigen::Vector3d::Zero();        // about the burr's reference point
  Eigen::Vector3d contact_force_N = Eigen::Vector3d::Zero();  // on the tool
  Pose device, tool;
  std::uint32_t contacts = 0;
  std::uint32_t removed = 0;
  std::uint64_t faults = 0;
  std::uint64_t evaluations = 0;
};

/// Contact stiffness that a method has in these measurements, N/m. Behind the coupling that of
/// scenes; without it about what a device's loop leaves: held lightly it is stable, friction and
/// quanta left out, up to 4.2 N/mm, and up to 1.4 N/mm with a tick of delay (the harness's spectral
/// limits). A plain penalty comes to 2 N/mm with twenty contacts.
double stiffness_of(ContactMethod method);

/// A scene of TOML with a method's haptics: normals by `ldm` under coupling and smooth, by
/// `ldm_paper` under the others, its scaling, and [coupling] where it has one. `text` has at least
/// [workpiece]; [burr], [device], [cutting] where wanted. Stiffness of all tissues by
/// stiffness_of, unless `stiffness_N_per_m` says otherwise.
Scene method_scene(ContactMethod method, const std::string& text,
                   std::optional<double> stiffness_N_per_m = {});

/// A tool's tip where a path is to be at a tick; the shank is up.
class PathDevice final : public Device {
 public:
  explicit PathDevice(std::vector<Pose> poses) : poses_(std::move(poses)) {}
  std::optional<Pose> pose(std::uint64_t tick) noexcept override {
    return poses_[std::min<std::size_t>(tick, poses_.size() - 1)];
  }
  void apply(const Wrench&) noexcept override {}
  std::size_t ticks() const { return poses_.size(); }

 private:
  std::vector<Pose> poses_;
};

/// Poses along corners of the tip, at a speed, one a tick.
std::vector<Pose> path_along(const std::vector<Eigen::Vector3d>& corners_m, double speed_m_per_s,
                             double rate_hz = 1000.0,
                             const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ());

class Rig {
 public:
  /// `solid`: instead of what the scene's workpiece says.
  Rig(ContactMethod method, const Scene& scene, std::optional<VoxelModel> solid = {});

  /// `vanish`: voxels (VoxelGrid::linear) that go at the start of the tick; the scene then needs
  /// [cutting] and [loose_pieces], and the method is not the single point.
  Felt step(Device& device, std::span<const std::uint32_t> vanish = {});
  const Simulation& simulation() const { return *simulation_; }
  double head_m() const { return simulation_->burr().head_length_m; }
  /// Whether the middle of the burr's head lies in what is left of the solid: the tool has gone
  /// through its surface.
  bool is_inside(const Pose& tool) const;

 private:
  std::unique_ptr<Simulation> simulation_;
  std::optional<PointProxy> point_;
  std::uint64_t tick_ = 0;
  double force_limit_N_;
};

}  // namespace sulcus::lab
