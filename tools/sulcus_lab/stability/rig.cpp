#include "tools/sulcus_lab/stability/rig.hpp"

#include <algorithm>
#include <cmath>

#include "engine/import/build_workpiece.hpp"
#include "engine/import/load_burr.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/trajectory.hpp"

namespace sulcus::lab {

namespace {

Eigen::Vector3d vector(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

}  // namespace

double stiffness_of(ContactMethod method) {
  switch (method) {
    case ContactMethod::kCoupling:
      return 300e3;
    case ContactMethod::kSmooth:
    case ContactMethod::kCount:
      return 2e3;
    case ContactMethod::kNone:
      return 0.1e3;
    case ContactMethod::kMcNeely:
      return 0.2e3;
    case ContactMethod::kSinglePoint:
      return 0.7e3;
  }
  return 0.0;
}

Scene method_scene(ContactMethod method, const std::string& text,
                   std::optional<double> stiffness_N_per_m) {
  std::string whole = text + "\n[trajectory]\npoints_mm = [[0, 0, 100]]\n";
  switch (method) {
    case ContactMethod::kCoupling:
      whole += "[haptics]\nscaling = 'smooth'\n";
      if (text.find("[coupling]") == std::string::npos) whole += "[coupling]\n";
      break;
    case ContactMethod::kSmooth:
    case ContactMethod::kSinglePoint:
      whole += "[haptics]\nscaling = 'smooth'\n";
      break;
    case ContactMethod::kCount:
      whole += "[haptics]\nnormals = 'ldm_paper'\nscaling = 'count'\n";
      break;
    case ContactMethod::kNone:
      whole += "[haptics]\nnormals = 'ldm_paper'\nscaling = 'none'\n";
      break;
    case ContactMethod::kMcNeely:
      whole += "[haptics]\nnormals = 'ldm_paper'\nscaling = 'mcneely'\n";
      break;
  }
  Scene scene = parse_scene(whole, "stability");
  for (TissueSettings& tissue : scene.tissues) {
    tissue.stiffness_N_per_m = stiffness_N_per_m.value_or(stiffness_of(method));
  }
  return scene;
}

std::vector<Pose> path_along(const std::vector<Eigen::Vector3d>& corners_m, double speed_m_per_s,
                             double rate_hz, const Eigen::Vector3d& axis) {
  std::vector<Pose> poses{{corners_m.front(), orientation_along(axis)}};
  const double step_m = speed_m_per_s / rate_hz;
  for (std::size_t c = 1; c < corners_m.size(); ++c) {
    const Eigen::Vector3d& from = corners_m[c - 1];
    const Eigen::Vector3d way = corners_m[c] - from;
    const int steps = std::max(1, static_cast<int>(std::ceil(way.norm() / step_m - 1e-9)));
    for (int s = 1; s <= steps; ++s) {
      poses.push_back({from + way * (static_cast<double>(s) / steps), poses.front().orientation});
    }
  }
  return poses;
}

Rig::Rig(ContactMethod method, const Scene& scene, std::optional<VoxelModel> solid)
    : simulation_(std::make_unique<Simulation>(scene,
                                               solid ? std::move(*solid) : build_workpiece(scene),
                                               std::vector<VoxelModel>{}, load_burr(scene))),
      force_limit_N_(scene.device ? scene.device->force_limit_N : HUGE_VAL) {
  if (method == ContactMethod::kSinglePoint) {
    point_.emplace(simulation_->workpiece(), scene.tissues.front().stiffness_N_per_m);
  }
}

bool Rig::is_inside(const Pose& tool) const {
  const Workpiece& workpiece = simulation_->workpiece();
  const Eigen::Vector3d middle = tool.point({0.0, 0.5 * head_m(), 0.0});
  const Eigen::Vector3d index = workpiece.grid().index_from_world(middle);
  return workpiece.solid((index.array() + 0.5).floor().cast<int>().matrix());
}

Felt Rig::step(Device& device, std::span<const std::uint32_t> vanish) {
  Felt felt;
  if (!point_) {
    const TickRecord record = simulation_->step(device, vanish);
    const PortRecord& port = simulation_->port();
    felt.force_N = vector(port.asked_force_N);
    felt.torque_Nm = vector(port.asked_torque_Nm);
    felt.contact_force_N = vector(record.contact_force_N);
    felt.device = pose_of(record.device_position_m, record.device_orientation);
    felt.tool = pose_of(record.tool_position_m, record.tool_orientation);
    felt.contacts = record.contacts;
    felt.removed = record.removed;
    felt.faults = record.faults;
    felt.evaluations = port.evaluations;
    return felt;
  }
  felt.device = felt.tool = device.pose(tick_++).value_or(Pose{});
  felt.tool.position = point_->move(felt.device.position);
  felt.force_N = felt.contact_force_N = point_->force_N();
  felt.contacts = felt.force_N.isZero(0.0) ? 0 : 1;
  felt.evaluations = 1;
  Wrench sent{felt.force_N, Eigen::Vector3d::Zero()};
  const double size_N = sent.force_N.norm();
  if (size_N > force_limit_N_) sent.force_N *= force_limit_N_ / size_N;
  device.apply(sent);
  return felt;
}

}  // namespace sulcus::lab
