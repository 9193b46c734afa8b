#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/core/pose.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact/contact.hpp"
#include "tools/sulcus_lab/truth/composed_shape.hpp"

namespace sulcus::lab {

/// What a contact's voxel has in truth.
struct TrueContact {
  std::uint32_t voxel = 0;                           // voxel_key
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // at the closest point, outward, unit
  double normal_force_N = 0.0;                       // K w d, scaled; 0: takes no part
};

/// A workpiece whose surface is known: the voxels of `shape`, both in the scene's space. Closest
/// points are found when they are first asked for and kept. Not for several threads.
class KnownSurface {
 public:
  /// Both must outlive this.
  KnownSurface(const Workpiece& workpiece, const ComposedShape& shape)
      : workpiece_(workpiece), shape_(shape) {}

  const Workpiece& workpiece() const { return workpiece_; }
  const ComposedShape& shape() const { return shape_; }
  /// The nearest point of the surface to a voxel's centre.
  const ComposedShape::ClosestPoint& closest_point(const Cell& voxel);

 private:
  const Workpiece& workpiece_;
  const ComposedShape& shape_;
  std::unordered_map<std::uint32_t, ComposedShape::ClosestPoint> known_;
};

/// The contact of one pose as it would be with the analytic normals and closest points: the same
/// voxels, and depths, weights and scaling by the engine's own law under `smooth`.
struct TrueForce {
  std::vector<TrueContact> contacts;  // by voxel, rising
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  double deepest_m = 0.0;         // of the closest points, into the burr
  Eigen::AlignedBox3d box_world;  // around the voxels that take part, two of them wider
};
/// `burr` brings the distance field that depths are measured in.
TrueForce true_force(KnownSurface& surface, const Burr& burr, const Pose& world_from_tool,
                     const HapticsSettings& settings, ContactScratch& scratch);

/// How far a tick's net force is from the truth, relative: |F - F_true| / |F_true|.
struct NetForceErrors {
  double directions = 0.0;      // the true depths and weights, with the tick's normals
  double own_weights = 0.0;     // the tick's depths and weights, with the true normals as the truth
  double whole = 0.0;           // the tick's force as it is
  double mean_angle_deg = 0.0;  // between normals, over the contacts that truly take part
};
/// `contacts` and `force_N` are what evaluate_contact left. A voxel that takes part in truth and is
/// not among the contacts is missing from the tick's sum.
NetForceErrors net_force_errors(KnownSurface& surface, const TrueForce& truth,
                                const Contacts& contacts, const Eigen::Vector3d& force_N);

/// The same penalty over the continuous surface: integral of w d n over integral of w, times the
/// stiffness of the first tissue; w = d min(1, c / 0.2) as in contact_force. The surface within
/// `box_world` is met by lines along all three axes, `lines_per_voxel` of them to a voxel each way;
/// a crossing of a line along axis a stands for |n_a| of its square, since the three |n_a|^2 add up
/// to 1 and it cuts out 1 / |n_a| of surface.
Eigen::Vector3d continuum_force(const KnownSurface& surface, const Burr& burr,
                                const Pose& world_from_tool, const Eigen::AlignedBox3d& box_world,
                                double stiffness_N_per_m, int lines_per_voxel);

}  // namespace sulcus::lab
