#pragma once

#include <span>

#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact/contact.hpp"
#include "haptics/contact/contact_frame.hpp"
#include "haptics/contact/contact_kernels.hpp"

namespace sulcus {

/// How far from the burr a voxel's centre still takes part. Where depth is measured at the fitted
/// surface point, that lies up to half a diagonal (0.87 voxel) further out; behind a coupling both
/// faces of an edge are to be known before the tool goes over it.
double contact_reach_m(const Workpiece& workpiece, Scaling scaling, Outputs outputs) noexcept;

/// Penalty forces [Kim and Park 2019, eq. 1] and, with `twist`, the tangential forces of cutting
/// [eq. 7], summed to force and torque about the burr's reference point.
///
/// Depth d: at the voxel's centre under `none`, `count` and `mcneely`; under `smooth` at the
/// surface point that the normal method gives, half a voxel out where it gives none. Normal: where
/// the method gives none, the tool's distance gradient, turned round. Under `smooth` a contact
/// whose normal opposes that (c = -N . grad <= 0: the far side of a thin wall) is dropped, not
/// flipped, and fades in below c = 0.2. Stiffness of contact i, K that of its tissue, n the
/// contacts:
///   none    K
///   count   K / n
///   mcneely K / max(1, n / 10), as [McNeely et al. 1999] for comparison
///   smooth  K w_i / max(sum w, 10), w = (d / voxel) min(1, c / 0.2): grows from zero, so that
///           neither the count nor a voxel that comes or goes makes the force jump, and a lone
///           voxel is not as stiff as a wall.
/// Tangential force: -beta |F_n| v_t / max(|v_t|, v0), v_t = v - (v . N) N the velocity of the
/// burr's surface there, spindle and tool together, along the tooth's. The paper takes v as it is,
/// which is not tangential, and divides by |v|, which vanishes on the axis. v0 = 10 mm/s. Its power
/// beta |F_n| |v_t|^2 / max(|v_t|, v0) is left with the contact for the removal.
/// Under `smooth` and Outputs::kCoupling forces turn with the tool over edges: `edge_gain`.
///
/// In two parts, the first of which takes contacts as they are found: depths and weights, whose sum
/// divides the stiffness, and then forces.
class ContactForce {
 public:
  /// All that is named outlives this.
  ContactForce(const Workpiece& workpiece, const Burr& burr, const Pose& world_from_tool,
               Scaling scaling, Outputs outputs) noexcept;

  /// Forgets what it has measured.
  void begin() noexcept;
  /// Measures the contacts that have been added since, in whole groups, and releases them from the
  /// block. What is left over waits for the next call, or for `sum`.
  void measure(ContactScratch& scratch) noexcept;
  /// Measures the rest, and sums.
  void sum(std::span<const TissueSettings> tissues, const Twist* twist, ContactScratch& scratch,
           ContactResult& result) noexcept;

 private:
  void measure_until(ContactScratch& scratch, std::size_t end) noexcept;

  const Burr& burr_;
  const Pose& world_from_tool_;
  ContactFrame frame_;
  ForceSettings settings_;
  Scaling scaling_;
  Outputs outputs_;
  std::size_t measured_ = 0;
  MeasureLanes lanes_;
};

}  // namespace sulcus
