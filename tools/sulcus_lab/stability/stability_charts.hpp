#pragma once

#include <span>
#include <string>

#include "tools/sulcus_lab/stability/stability_row.hpp"

namespace sulcus::lab {

// The pictures of the stability measurements. Each returns false where gnuplot did not draw it, or
// where there is nothing to draw.

/// Force over time of one case's runs, and below it the depth where that was measured. Up to five
/// in one frame; of more a frame for each label, or for each method where there is one label only.
/// Colour tells the method where there are several, dashes the label. A trace that is far larger
/// than most leaves the frame, and its largest force stands beside its name.
bool draw_force_traces(std::span<const ForceTrace> traces_of_one_case, const std::string& file_png);

/// How stiff the tooth can be felt with so many voxels in contact.
struct FrontierPoint {
  ContactMethod method = ContactMethod::kCoupling;
  double contacts = 0.0;
  double felt_hold_N_per_mm = 0.0;  // the least that holds the push; NaN: none does
  double felt_buzz_N_per_mm =
      0.0;  // the largest before it buzzes; NaN: none, HUGE_VAL: it never did
};
/// Contacts against felt stiffness, a frame for each method with the others' behind it in grey:
/// solid the least that holds, dashed the largest before buzz, filled between them where the first
/// lies below the second, which is where the method can be used.
bool draw_frontier(std::span<const FrontierPoint> points, const std::string& file_png);

/// The largest stable stiffness under some damping.
struct DampingPoint {
  std::string label;  // the line it belongs to; a method's name takes the method's colour
  double damping_N_s_per_m = 0.0;
  double largest_stable_N_per_mm = 0.0;  // 0: none is, HUGE_VAL: all that were tried are
};
/// A line for each label over the damping; what is 0 or has no end lies on the frame's edge.
bool draw_damping(std::span<const DampingPoint> points, const std::string& file_png);

/// What a method's tick costs, and how wrong its force is.
struct SpeedErrorPoint {
  ContactMethod method = ContactMethod::kCoupling;
  double tick_us = 0.0;
  double force_error_percent = 0.0;
};
/// Error against the time of a tick, a mark for each point, those of a method joined. An error of 0
/// lies on the frame's edge.
bool draw_speed_error(std::span<const SpeedErrorPoint> points, const std::string& file_png);

}  // namespace sulcus::lab
