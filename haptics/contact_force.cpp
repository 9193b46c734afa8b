#include "haptics/contact_force.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/lane_sums.hpp"

namespace sulcus {

namespace {

constexpr float kFadeBelow = 0.2f;     // cosine between the normal and the tool's
constexpr double kFullWeights = 10.0;  // W0: sum of weights from which the stiffness is K
constexpr double kSlowEdge = 10e-3;    // v0, m/s

/// Depth, normal and weight of one contact; weight 0 drops it.
void measure(Contact& contact, const DistanceField& field, const Pose& world_from_tool,
             const VoxelGrid& grid, const Eigen::Vector3d& reference_world, Scaling scaling) {
  const Eigen::Vector3d centre_world = grid.centre_world(contact.cell);
  const bool at_surface = scaling == Scaling::kSmooth;
  const bool has_normal = contact.normal != Eigen::Vector3f::Zero();
  const auto half_voxel_m = static_cast<float>(0.5 * grid.voxel_m);

  Eigen::Vector3d point_world = centre_world;
  if (at_surface && has_normal) {
    point_world += (contact.normal * contact.offset_m).cast<double>();
  }
  contact.depth_m = -contact.distance_m;
  float cosine = 1.0f;
  if (at_surface || !has_normal) {
    Eigen::Vector3f gradient_tool;
    const float distance_m = field.sample_with_gradient(
        field.field_from_tool(world_from_tool.inverse_point(point_world)).cast<float>(),
        gradient_tool);
    const Eigen::Vector3f away_from_tool =
        world_from_tool.direction(gradient_tool.cast<double>()).cast<float>();
    const float length = std::sqrt(away_from_tool.squaredNorm());
    if (has_normal) {
      contact.depth_m = -distance_m;
      cosine = length > 0 ? -contact.normal.dot(away_from_tool) / length : 1.0f;
    } else if (length > 0) {
      contact.normal = -away_from_tool / length;
      if (at_surface) {
        point_world += (contact.normal * half_voxel_m).cast<double>();
        contact.depth_m = -distance_m + half_voxel_m;
      }
    } else {
      contact.depth_m = 0.0f;  // neither the tooth nor the tool knows a direction here
    }
  }
  contact.arm_m = point_world - reference_world;
  if (contact.depth_m <= 0.0f || (at_surface && cosine <= 0.0f)) {
    contact.weight = 0.0f;
  } else if (at_surface) {
    contact.weight =
        contact.depth_m / static_cast<float>(grid.voxel_m) * std::min(1.0f, cosine / kFadeBelow);
  } else {
    contact.weight = 1.0f;
  }
}

}  // namespace

void contact_force(const Workpiece& workpiece, std::span<const TissueSettings> tissues,
                   const Burr& burr, const Pose& world_from_tool, const Twist* twist,
                   Scaling scaling, ContactScratch& scratch, ContactResult& result) noexcept {
  const VoxelGrid& grid = workpiece.grid();
  const Eigen::Vector3d axis_world = world_from_tool.direction(Eigen::Vector3d::UnitY());
  const Eigen::Vector3d to_reference = burr.reference_m * axis_world;
  const Eigen::Vector3d reference_world = world_from_tool.position + to_reference;

  LaneSums<1> weights;
  for (Contact& contact : scratch.contacts) {
    measure(contact, burr.field, world_from_tool, grid, reference_world, scaling);
    weights.next();
    weights.add(0, contact.weight);
    result.contacts += contact.weight > 0.0f;
  }
  double divisor = 1.0;
  if (scaling == Scaling::kCount) divisor = std::max<double>(1.0, result.contacts);
  if (scaling == Scaling::kSmooth) divisor = std::max(kFullWeights, weights.total()[0]);

  // Sums: force (3), torque (3), and the upper triangle of the stiffness (21).
  LaneSums<27> sums;
  for (Contact& contact : scratch.contacts) {
    sums.next();
    contact.normal_force_N = contact.power_W = 0.0;
    if (contact.weight <= 0.0f) continue;
    const std::uint8_t tissue = workpiece.tissue(contact.cell);
    const double stiffness = tissues[tissue].stiffness_N_per_m * contact.weight / divisor;
    contact.normal_force_N = stiffness * contact.depth_m;

    const Eigen::Vector3d normal = contact.normal.cast<double>();
    Eigen::Vector3d force = contact.normal_force_N * normal;  // eq. 1
    if (twist) {
      const Eigen::Vector3d arm_tip = contact.arm_m + to_reference;
      const Eigen::Vector3d turning = twist->angular_rad_per_s + burr.speed_rad_per_s * axis_world;
      const Eigen::Vector3d velocity = twist->linear_m_per_s + turning.cross(arm_tip);
      const Eigen::Vector3d sliding = velocity - velocity.dot(normal) * normal;
      const double speed = std::sqrt(sliding.squaredNorm());
      const double along =
          burr.tangential_ratio * contact.normal_force_N / std::max(speed, kSlowEdge);
      force -= along * sliding;  // eq. 7
      contact.power_W = along * speed * speed;
    }
    const Eigen::Vector3d torque = contact.arm_m.cross(force);
    Eigen::Matrix<double, 6, 1> row;  // of the contact's Jacobian
    row << normal, contact.arm_m.cross(normal);
    for (int a = 0; a < 3; ++a) {
      sums.add(a, force[a]);
      sums.add(3 + a, torque[a]);
    }
    std::size_t entry = 6;
    for (int a = 0; a < 6; ++a) {
      for (int b = a; b < 6; ++b) sums.add(entry++, stiffness * row[a] * row[b]);
    }
  }
  const auto total = sums.total();
  result.wrench.force_N = Eigen::Vector3d(total[0], total[1], total[2]);
  result.wrench.torque_Nm = Eigen::Vector3d(total[3], total[4], total[5]);
  std::size_t entry = 6;
  for (int a = 0; a < 6; ++a) {
    for (int b = a; b < 6; ++b) result.stiffness(a, b) = result.stiffness(b, a) = total[entry++];
  }
}

}  // namespace sulcus
