#pragma once

#include <optional>

#include <Eigen/Core>

#include "engine/assessment/placed_figure.hpp"
#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// How a preparation matches its plan, the tooth as it should have become. The plan's walls are its
/// surface where it bares what was inside the tooth.
struct PlanMatch {
  /// The greatest distance from the plan's walls, 0 where there is none: of what was removed
  /// without the plan (over), and of what it removes and still stands (under), by their surfaces.
  PlacedFigure over_mm, under_mm;
  /// Of the cut from the plan's walls, by area: the mean, what 95 % of it does not exceed, and the
  /// share of it within the tolerance, 0 to 1. The cut is the surface where the tooth was cut or
  /// should have been.
  double error_mm = 0.0, error_95_mm = 0.0, within_tolerance = 0.0;
  double dice = 0.0;  // of what was removed and what should have been: 1 where they are the same
};

struct PlanSettings {
  Eigen::Vector3d insertion{0, 0, 1};  // out of the tooth, a unit vector
  double tolerance_mm = 0.3;
  double pitch_mm = 0.02;  // between rays
};

/// Compares closed surfaces of a tooth before and after with that of its plan, in metres, in one
/// space. They may be of different resolution: what differs by less than kSame_mm is taken for the
/// same, but for the distances, which are exact. None where the plan removes nothing.
std::optional<PlanMatch> plan_match(const TriangleMesh& before, const TriangleMesh& after,
                                    const TriangleMesh& plan, const PlanSettings& settings);

}  // namespace sulcus
