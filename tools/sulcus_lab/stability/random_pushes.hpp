#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/volume/workpiece.hpp"
#include "tools/sulcus_lab/stability/stability_row.hpp"

namespace sulcus::lab {

/// What one scripted push at a random place did, before any limit of a device.
struct RandomPush {
  std::uint64_t seed = 0;
  bool cutting = false;
  std::string burr;  // "round 0.5"
  double speed_mm_per_s = 0.0;
  double force_N = 0.0;  // largest
  double step_N = 0.0;   // largest change in a tick, but for the first five in contact
  bool crossed = false;  // the middle of the head was in solid that stands
  bool finite = true;
  bool touched = false;
};

/// One push, all of it from its seed: a place on the tooth, a burr, its direction and axis (each
/// within 50 degrees of the surface's normal), and a speed of 1 to 100 mm/s; the device goes on to
/// where the springs are stretched to their limit, and along the surface a little, then back. Odd
/// seeds cut. `tooth`: the whole solid; the push is run in a part of it about the place.
RandomPush run_random_push(const Workpiece& tooth, std::uint64_t seed);

/// Many of them, on all cores; `seeds` in order.
std::vector<RandomPush> run_random_pushes(const Workpiece& tooth,
                                          std::span<const std::uint64_t> seeds);

/// The largest change of the force in a tick that passes.
inline constexpr double kLargestStep_N = 0.3;
/// Whether one misses any limit of the rows below.
bool fails(const RandomPush& push, double force_limit_N);

/// Rows of the case `random_pushes`, of a tooth by name: the worst of all its pushes.
CaseResult random_push_rows(const std::string& tooth, std::span<const RandomPush> pushes,
                            double force_limit_N);

}  // namespace sulcus::lab
