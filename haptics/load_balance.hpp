#pragma once

#include <algorithm>
#include <cmath>

#include "haptics/contact/contact.hpp"

namespace sulcus {

/// Reaction to a load at one offset.
struct Resistance {
  double force_N = 0.0;            // of the contact, against the load
  double stiffness_N_per_m = 0.0;  // how it grows along that direction; 0: not known
};

struct LoadSearch {
  double load_N = 0.0;
  double longest_step_m = 0.0;  // half a voxel: nothing is crossed without being felt
  double longest_way_m = 0.0;   // forward in one tick; backward there is no such limit
  double tolerance = 0.01;      // of the load
};

/// Moves along the load's direction until the contact holds it, from `offset_m` on: by the
/// contact's stiffness at first, then by secants, within what the forces found so far leave open.
/// Ends within the tolerance, at the end of the way, or after 12 evaluations; the next tick goes
/// on. Returns the offset of the last call of `evaluate(offset_m, Outputs) -> Resistance`,
/// so that what that call left is the contact there.
template <class Evaluate>
double balance_load(const LoadSearch& search, double offset_m, const Evaluate& evaluate) noexcept {
  constexpr int kEvaluations = 12;
  const double furthest_m = offset_m + search.longest_way_m;
  // Offsets at which the contact was known to hold less, and at least the load.
  double less_m = -HUGE_VAL, enough_m = HUGE_VAL;
  double at_m = offset_m;
  Resistance found = evaluate(at_m, Outputs::kForceAndStiffness);
  for (int i = 1; i < kEvaluations; ++i) {
    const double wanting_N = search.load_N - found.force_N;
    if (std::abs(wanting_N) <= search.tolerance * search.load_N) break;
    (wanting_N > 0.0 ? less_m : enough_m) = at_m;
    double step_m = found.stiffness_N_per_m > 0.0 ? wanting_N / found.stiffness_N_per_m
                                                  : std::copysign(search.longest_step_m, wanting_N);
    step_m = std::clamp(step_m, -search.longest_step_m, search.longest_step_m);
    double to_m = std::min(at_m + step_m, furthest_m);
    if (to_m == at_m) break;  // at the end of the way
    if (to_m <= less_m || to_m >= enough_m) to_m = 0.5 * (less_m + enough_m);
    const Resistance next = evaluate(to_m, Outputs::kForce);
    const double secant_N_per_m = (next.force_N - found.force_N) / (to_m - at_m);
    found = {next.force_N, std::max(0.0, secant_N_per_m)};
    at_m = to_m;
  }
  return at_m;
}

}  // namespace sulcus
