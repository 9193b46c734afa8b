#pragma once

#include <vector>

#include "tools/sulcus_lab/stability/stability_charts.hpp"

namespace sulcus::lab {

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
