#pragma once

#include "haptics/contact/evaluate_contact.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

// One evaluation of the contact, and what the tests of its forces are about.

namespace sulcus::test {

inline constexpr double kVoxel = 50e-6;
inline constexpr double kFloat = 3e-7;      // what single precision leaves of a sum, relative
inline constexpr double kStiffness = 30e3;  // N/m, of one_tissue()

/// The lower half of a cube of 3.2 mm: its face, the outer faces of its voxels, at z = 0.
inline const Workpiece& flat_block() {
  static const Workpiece workpiece(block({64, 64, 64}, kVoxel, {0, 0, 0}, {64, 64, 32}));
  return workpiece;
}
inline const Burr& round_burr() {
  static const Burr burr = make_burr(small_burr(), kVoxel);
  return burr;
}
inline const double kRadius = 0.5 * small_burr().diameter_m;
inline HapticsSettings with(Scaling scaling) {
  HapticsSettings settings;
  settings.scaling = scaling;
  return settings;
}

/// Signed distance and direction away from the burr at a point of the world.
struct Probe {
  double distance_m;
  Eigen::Vector3d away;
};
inline Probe probe(const Burr& burr, const Pose& pose, const Eigen::Vector3d& p_world) {
  Eigen::Vector3f gradient;
  const Eigen::Vector3d p_field = burr.field.field_from_tool(pose.inverse_point(p_world));
  const double distance_m = burr.field.sample_with_gradient(p_field.cast<float>(), gradient);
  return {distance_m, pose.direction(gradient.cast<double>()).normalized()};
}

/// Contacts of a pose with their normals, and what contact_force makes of them.
struct Evaluation {
  Evaluation(const Workpiece& workpiece, const Burr& burr, const Pose& pose, Scaling scaling,
             const Twist* twist = nullptr, Outputs outputs = Outputs::kForceAndStiffness)
      : scratch(with(scaling)) {
    result = evaluate_contact(workpiece, {burr, pose, one_tissue(), with(scaling), twist, outputs},
                              scratch);
  }
  ContactScratch scratch;
  ContactResult result;
};

}  // namespace sulcus::test
