#include "tools/sulcus_lab/pareto/net_force.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "engine/core/units.hpp"
#include "tools/sulcus_lab/truth/known_contact.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

/// Beyond the 0.87 voxel that a closest point may lie off its voxel's centre, for coarse fields.
constexpr double kReach = 1.5;  // voxels

const TrueContact* find(const std::vector<TrueContact>& contacts, std::uint32_t voxel) {
  const auto at = std::lower_bound(
      contacts.begin(), contacts.end(), voxel,
      [](const TrueContact& contact, std::uint32_t v) { return contact.voxel < v; });
  return at != contacts.end() && at->voxel == voxel ? &*at : nullptr;
}

double relative(const Vector3d& force, const Vector3d& truth) {
  return (force - truth).norm() / truth.norm();
}

/// The normal penalty of one point of the surface.
struct Penalty {
  double weight = 0.0;  // m
  double depth_m = 0.0;
};
Penalty penalty_at(const Burr& burr, const Pose& world_from_tool, const Vector3d& point,
                   const Vector3d& normal) {
  Eigen::Vector3f gradient;
  const float distance_m = burr.field.sample_with_gradient(
      burr.field.field_from_tool(world_from_tool.inverse_point(point)).cast<float>(), gradient);
  if (distance_m >= 0.0f) return {};
  const Vector3d away = world_from_tool.direction(gradient.cast<double>());
  const double cosine = -normal.dot(away) / away.norm();
  const double depth_m = -static_cast<double>(distance_m);
  return {depth_m * std::clamp(cosine / 0.2, 0.0, 1.0), depth_m};
}

/// Every place where a line along `axis` from `start` to the coordinate `end` meets the surface.
template <class Meet>
void for_each_crossing(const ComposedShape& shape, Vector3d start, int axis, double end,
                       double least_step, const Meet& meet) {
  double value = shape.value(start);
  while (start[axis] < end) {
    Vector3d next = start;
    next[axis] += std::max(std::abs(value) / shape.lipschitz(), least_step);
    const double next_value = shape.value(next);
    if ((value <= 0.0) != (next_value <= 0.0)) {
      double low = start[axis], high = next[axis];
      Vector3d middle = start;
      for (int halving = 0; halving < 20; ++halving) {
        middle[axis] = 0.5 * (low + high);
        ((shape.value(middle) <= 0.0) == (value <= 0.0) ? low : high) = middle[axis];
      }
      meet(middle);
    }
    start = next;
    value = next_value;
  }
}

}  // namespace

const ComposedShape::ClosestPoint& KnownSurface::closest_point(const Cell& voxel) {
  const auto [at, is_new] = known_.try_emplace(workpiece_.grid().linear(voxel));
  if (is_new) at->second = shape_.closest_point(workpiece_.grid().centre_world(voxel));
  return at->second;
}

TrueForce true_force(KnownSurface& surface, const Burr& burr, const Pose& world_from_tool,
                     const HapticsSettings& settings, ContactScratch& scratch) {
  const Workpiece& workpiece = surface.workpiece();
  const double reach_m = kReach * workpiece.grid().voxel_m;
  struct Known {
    Eigen::Vector3f normal;
    float offset_m;
  };
  const auto known = [&](const Cell& cell) {
    const ComposedShape::ClosestPoint& closest = surface.closest_point(cell);
    const Vector3d centre_world = workpiece.grid().centre_world(cell);
    return Known{closest.normal.cast<float>(),
                 static_cast<float>((closest.point - centre_world).dot(closest.normal))};
  };
  const std::vector<TissueSettings> tissues(1);
  const ContactResult result = evaluate_known(workpiece, {burr, world_from_tool, tissues, settings},
                                              reach_m, scratch, known);

  TrueForce truth;
  truth.force_N = result.wrench.force_N;
  for (const Contact contact : scratch.contacts) {
    truth.contacts.push_back(
        {contact.key(), surface.closest_point(contact.cell).normal, contact.normal_force_N});
    truth.deepest_m = std::max(truth.deepest_m, static_cast<double>(contact.depth_m));
    if (contact.normal_force_N > 0.0) {
      truth.box_world.extend(workpiece.grid().centre_world(contact.cell));
    }
  }
  const Vector3d margin = Vector3d::Constant(2.0 * workpiece.grid().voxel_m);
  if (!truth.box_world.isEmpty()) {
    truth.box_world.extend(truth.box_world.min() - margin);
    truth.box_world.extend(truth.box_world.max() + margin);
  }
  std::sort(truth.contacts.begin(), truth.contacts.end(),
            [](const TrueContact& a, const TrueContact& b) { return a.voxel < b.voxel; });
  return truth;
}

NetForceErrors net_force_errors(KnownSurface& surface, const TrueForce& truth,
                                const Contacts& contacts, const Vector3d& force_N) {
  NetForceErrors errors;
  Vector3d turned = Vector3d::Zero();    // true weights, the tick's normals
  Vector3d straight = Vector3d::Zero();  // the tick's weights, true normals
  double angles = 0.0;
  int count = 0;
  for (const Contact& contact : contacts) {
    const Vector3d normal = contact.normal.cast<double>();
    const TrueContact* known = find(truth.contacts, contact.key());
    const Vector3d true_normal = known ? known->normal : surface.closest_point(contact.cell).normal;
    straight += contact.normal_force_N * true_normal;
    if (!known || known->normal_force_N == 0.0) continue;
    turned += known->normal_force_N * normal;
    angles += std::atan2(normal.cross(true_normal).norm(), normal.dot(true_normal));
    ++count;
  }
  errors.directions = relative(turned, truth.force_N);
  errors.own_weights = relative(force_N, straight);
  errors.whole = relative(force_N, truth.force_N);
  errors.mean_angle_deg = count > 0 ? angles / count / kDegree : 0.0;
  return errors;
}

Vector3d continuum_force(const KnownSurface& surface, const Burr& burr, const Pose& world_from_tool,
                         const Eigen::AlignedBox3d& box_world, double stiffness_N_per_m,
                         int lines_per_voxel) {
  const ComposedShape& shape = surface.shape();
  const double voxel_m = surface.workpiece().grid().voxel_m;
  const double spacing = voxel_m / lines_per_voxel;
  Vector3d force = Vector3d::Zero();
  double weights = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    Vector3d start = box_world.min();
    for (start[u] = box_world.min()[u]; start[u] < box_world.max()[u]; start[u] += spacing) {
      for (start[v] = box_world.min()[v]; start[v] < box_world.max()[v]; start[v] += spacing) {
        for_each_crossing(shape, start, axis, box_world.max()[axis], voxel_m / 8.0,
                          [&](const Vector3d& point) {
                            const Vector3d normal = shape.gradient(point).normalized();
                            const Penalty p = penalty_at(burr, world_from_tool, point, normal);
                            const double weight = p.weight * std::abs(normal[axis]);
                            force += weight * p.depth_m * normal;
                            weights += weight;
                          });
      }
    }
  }
  return weights > 0.0 ? Vector3d(stiffness_N_per_m / weights * force) : Vector3d::Zero();
}

}  // namespace sulcus::lab
