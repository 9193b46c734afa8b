#pragma once

#include "engine/scene/scene.hpp"

namespace sulcus {

/// Constants of the saturating law, all of them fitted to published bands; the fit is shown by
/// `sulcus-lab reality --fit`.
struct SaturatingConstants {
  double grain_area_m2 = 6.25e-11;  // A, of a medium grit
  double diamond_m_per_s = 10.7;    // v0 of diamonds
  double carbide_m_per_s = 10.5;    // v0 of carbide
  double wear_length_m = 39e-3;     // L, of a medium grit
};

/// The share of the tangential work that removes tissue under CuttingLaw::kSaturating; the rest is
/// heat. Of a burr whose rim goes at v under a net normal force F, in a tissue of specific cutting
/// energy u:
///
///   share = sharpness / ((1 + F / (u A g)) (1 + (v / v0)^2))
///   sharpness = 1 / (1 + worn / (L g))
///
/// so that the rate of removal, share beta F v / u, rises with the load to a limit that no tissue
/// changes, sharpness beta A g v / (1 + (v / v0)^2): what the grains can take at a time. With the
/// speed it rises up to v0 and falls beyond. g is the square of the grains' size over a medium
/// grit's: a grain's cross-section. Carbide, which has no grains, has the load of a medium grit (no
/// figure of it was found) and does not wear. F and v are the burr's, not a contact's, so that
/// neither the voxel size nor the rate of ticks changes the share. Immutable; any thread may ask.
class SaturatingLaw {
 public:
  explicit SaturatingLaw(const BurrSettings& burr, const SaturatingConstants& constants = {});

  /// 0 to 1. `load_N`, `rim_m_per_s`: 0 or more.
  double share(double specific_energy_J_per_m3, double load_N, double rim_m_per_s) const noexcept {
    const double speed = rim_m_per_s / best_m_per_s_;
    return sharpness_ /
           ((1.0 + load_N / (specific_energy_J_per_m3 * area_m2_)) * (1.0 + speed * speed));
  }

 private:
  double area_m2_;       // A g
  double best_m_per_s_;  // v0
  double sharpness_;
};

}  // namespace sulcus
