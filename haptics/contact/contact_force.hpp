#pragma once

#include <array>

#include "engine/volume/workpiece.hpp"
#include "haptics/contact/contact.hpp"
#include "haptics/contact/contact_frame.hpp"
#include "haptics/contact/contact_kernels.hpp"

namespace sulcus {

/// How far from the burr a voxel's centre still takes part. Where depth is measured at the fitted
/// surface point, that lies up to half a diagonal (0.87 voxel) further out; behind a coupling both
/// faces of an edge are to be known before the tool goes over it. Under `potential` the points lie
/// up to a voxel out, and not one inside the burr is left out.
double contact_reach_m(const Workpiece& workpiece, Scaling scaling, Outputs outputs) noexcept;

/// Penalty forces [Kim and Park 2019, eq. 1] and, with `twist`, the tangential forces of cutting
/// [eq. 7], summed to force and torque about the burr's reference point.
///
/// Depth d: at the voxel's centre under `none`, `count` and `mcneely`; under `smooth` and
/// `potential` at the surface point that the normal method gives, half a voxel out where it gives
/// none. Normal: where the method gives none, the tool's distance gradient, turned round. Under
/// `smooth` a contact whose normal opposes that (c = -N . grad <= 0: the far side of a thin wall)
/// is dropped, not flipped, and fades in below c = 0.2. Stiffness of contact i, K that of its
/// tissue, n the contacts:
///   none    K
///   count   K / n
///   mcneely K / max(1, n / 10), as [McNeely et al. 1999] for comparison
///   smooth  K w_i / max(sum w, 10), w = (d / voxel) min(1, c / 0.2): grows from zero, so that
///           neither the count nor a voxel that comes or goes makes the force jump, and a lone
///           voxel is not as stiff as a wall.
/// `potential` has an energy instead: potential.hpp.
/// Tangential force: -beta |F_n| v_t / max(|v_t|, v0), v_t = v - (v . N) N the velocity of the
/// burr's surface there, spindle and tool together, along the tooth's. The paper takes v as it is,
/// which is not tangential, and divides by |v|, which vanishes on the axis. v0 = 10 mm/s. Its power
/// beta |F_n| |v_t|^2 / max(|v_t|, v0) is left with the contact for the removal.
/// Under `smooth` and Outputs::kCoupling forces turn with the tool over edges: `edge_gain`.
///
/// In two parts, the first of which takes contacts as they are found: depths and weights, whose sum
/// divides the stiffness, and then forces. Of several bodies the sums are added up in between.
class ContactForce {
 public:
  /// All that is named outlives this.
  ContactForce(const Workpiece& workpiece, const ContactQuery& query) noexcept;

  /// Forgets what it has measured.
  void begin() noexcept;
  /// Measures the contacts that have been added since, in whole groups, and releases them from the
  /// block. What is left over waits for the next call, or for `measured`.
  void measure(ContactScratch& scratch) noexcept;
  /// Measures the rest. What all contacts of the solid add up to; of a potential in m^(p + 2).
  MeasureSums measured(ContactScratch& scratch) noexcept;
  /// Sums the forces of the contacts in the scratch, which have all been measured; `all`: what they
  /// and those of other solids add up to, in the space of this one's grid. The stiffness is without
  /// the part that only all of them together have: `add_weight_derivative`.
  void sum(const MeasureSums& all, ContactScratch& scratch, ContactResult& result) const noexcept;

 private:
  void measure_until(ContactScratch& scratch, std::size_t end) noexcept;
  ForceTerms terms_of(const MeasureSums& all) const noexcept;

  const ContactQuery& query_;
  ContactFrame frame_;
  ForceSettings settings_;
  std::array<float, 256> stiffness_N_per_m_;  // by label
  double sum_of_weight_ = 1.0;                // what a weight adds to the sum that divides
  std::size_t measured_ = 0;
  MeasureLanes lanes_;
};

/// Of all contacts, J; 0 but under `potential`.
double energy_J(Scaling scaling, const MeasureSums& all) noexcept;

/// Adds what weights that grow with depth make of the stiffness of all bodies together, in one
/// space. `result`: what they sum up to.
void add_weight_derivative(Scaling scaling, const MeasureSums& all, ContactResult& result) noexcept;

}  // namespace sulcus
