#include "tools/sulcus_lab/stability/cases/case_solids.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "engine/core/units.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;
using Eigen::Vector3i;

VoxelModel wall_solid(int voxels) {
  const int up = (voxels + 7) / 8 * 8;
  return solid_where(Vector3i(48, 48, 2 * up),
                     [=](const Vector3d& p) { return p.z() < 0.0 && p.z() > -voxels; });
}

VoxelModel half_space_solid(const Vector3d& normal) {
  // Centres on the plane are all inside, however the product is rounded: half of them would else
  // make a step in it.
  constexpr double kOn = 1e-9;
  return solid_where(Vector3i(64, 64, 64), [&](const Vector3d& p) { return normal.dot(p) <= kOn; });
}

VoxelModel roof_solid(double phase) {
  return solid_where(Vector3i(80, 48, 64),
                     [=](const Vector3d& p) { return p.z() <= -std::abs(p.x() - phase); });
}

VoxelModel block_edge_solid() {
  return solid_where(Vector3i(80, 48, 80),
                     [](const Vector3d& p) { return p.x() < 0.0 && p.z() < 0.0; });
}

VoxelModel column_solid(int voxels) {
  return solid_where(Vector3i(16, 16, 64), [=](const Vector3d& p) {
    return p.x() == 0.5 && p.y() == 0.5 && p.z() < 0.0 && p.z() > -voxels;
  });
}

VoxelModel pins_solid(int spacing) {
  const auto on = [=](double v) { return std::remainder(v - 0.5, spacing) == 0.0; };
  return solid_where(Vector3i(80, 80, 16),
                     [=](const Vector3d& p) { return p.z() == -0.5 && on(p.x()) && on(p.y()); });
}

VoxelModel groove_solid(double angle, double phase) {
  const double sine = std::sin(0.5 * angle), slope = 1.0 / std::tan(0.5 * angle);
  const double bottom = kCaseRadius_m / kCaseVoxel_m * (1.0 - 1.0 / sine);
  // Down to its edge, but no deeper than any device goes.
  const int half = std::clamp(static_cast<int>(std::ceil(1.0 - 0.125 * bottom)), 4, 12) * 8;
  return solid_where(Vector3i(64, 48, 2 * half), [=](const Vector3d& p) {
    return p.z() - bottom <= slope * std::abs(p.x() - phase);
  });
}

double slot_middle_m(int voxels) { return voxels % 2 == 0 ? 0.0 : 0.5 * kCaseVoxel_m; }

VoxelModel slot_solid(int voxels) {
  const double middle = slot_middle_m(voxels) / kCaseVoxel_m;
  return solid_where(Vector3i(64, 48, 80), [=](const Vector3d& p) {
    return p.z() < 0.0 && std::abs(p.x() - middle) > 0.5 * voxels;
  });
}

std::string case_text(const std::string& more) {
  return "[workpiece]\nshape = 'box'\n[burr]\nshape = 'round'\ndiameter_mm = 1\nfield = 'auto'\n"
         "speed_rpm = 0\n" +
         more;
}

std::vector<Pose> case_path(const std::vector<Vector3d>& corners_mm, double speed_mm_per_s,
                            int rest_ticks) {
  std::vector<Vector3d> corners_m;
  corners_m.reserve(corners_mm.size());
  for (const Vector3d& corner : corners_mm) corners_m.push_back(corner * kMillimetre);
  std::vector<Pose> path = path_along(corners_m, speed_mm_per_s * kMillimetre);
  path.insert(path.end(), static_cast<std::size_t>(rest_ticks), Pose(path.back()));
  return path;
}

void go_on(std::vector<Pose>& path, const Vector3d& to_mm, double speed_mm_per_s, int rest_ticks) {
  const std::vector<Pose> more =
      case_path({path.back().position / kMillimetre, to_mm}, speed_mm_per_s, rest_ticks);
  path.insert(path.end(), more.begin() + 1, more.end());
}

std::vector<Felt> run_path(ContactMethod method, const Scene& scene, const VoxelModel& solid,
                           const std::vector<Pose>& path) {
  Rig rig(method, scene, solid);
  PathDevice device(path);
  std::vector<Felt> ticks;
  ticks.reserve(path.size());
  for (std::size_t t = 0; t < path.size(); ++t) ticks.push_back(rig.step(device));
  return ticks;
}

bool is_held_outside(ContactMethod method) {
  return method == ContactMethod::kCoupling || method == ContactMethod::kSinglePoint;
}

double largest_fall_N(std::span<const Felt> ticks) {
  double highest = 0.0, fall = 0.0;
  for (const Felt& felt : ticks) {
    highest = std::max(highest, felt.force_N.z());
    fall = std::max(fall, highest - felt.force_N.z());
  }
  return fall;
}

double largest_step_N(std::span<const Felt> ticks) {
  double step = 0.0;
  for (std::size_t t = 1; t < ticks.size(); ++t) {
    step = std::max(step, (ticks[t].force_N - ticks[t - 1].force_N).norm());
  }
  return step;
}

double angle_between_deg(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

}  // namespace sulcus::lab
