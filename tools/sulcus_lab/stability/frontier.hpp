#pragma once

#include <string>
#include <vector>

#include "tools/sulcus_lab/stability/stability_row.hpp"

namespace sulcus::lab {

/// How stiff the tooth can be felt with so many voxels in contact.
struct FrontierPoint {
  ContactMethod method = ContactMethod::kCoupling;
  double contacts = 0.0;
  double felt_hold_N_per_mm = 0.0;  // the least that holds the push; NaN: none does
  double felt_buzz_N_per_mm =
      0.0;  // the largest before it buzzes; NaN: none, HUGE_VAL: it never did
};

/// The largest stable stiffness under some damping.
struct DampingPoint {
  std::string label;  // the line it belongs to; a method's name takes the method's colour
  double damping_N_s_per_m = 0.0;
  double largest_stable_N_per_mm = 0.0;  // 0: none is, HUGE_VAL: all that were tried are
};

/// What a method's tick costs, and how wrong its force is.
struct SpeedErrorPoint {
  ContactMethod method = ContactMethod::kCoupling;
  double tick_us = 0.0;
  double force_error_percent = 0.0;
};

/// For each method and burr: the least contact stiffness that holds a push of 1 N on a flat face,
/// and the largest before the handle shakes by more than a resolution, both as they are felt. The
/// stiffness goes up by steps of 1.5, each bound ends at its first failure. Omni, light hand, one
/// tick of delay. `brief`: one burr.
std::vector<FrontierPoint> measure_frontier(bool brief);

/// The same loop's linear limit against the damping of the wall, hands light, firm and arm, delay 0
/// and 1 [spectral_limit].
std::vector<DampingPoint> measure_damping();

/// What a tick of a method costs and how wrong its force is, by neighbourhood: a burr slid over a
/// face at 20 deg with about 1 N, error the RMS of what differs from the mean along the face's own
/// normal, of that mean.
std::vector<SpeedErrorPoint> measure_speed_error();

}  // namespace sulcus::lab
