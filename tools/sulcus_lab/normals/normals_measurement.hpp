#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/sulcus_lab/normals/normal_methods.hpp"
#include "tools/sulcus_lab/truth/truth_shapes.hpp"

namespace sulcus::lab {

/// One method at one neighbourhood.
struct MethodRun {
  Method method;
  int neighbourhood;
};

/// What came out of a run on one zone of a shape: a row of normals.csv.
struct NormalsRow {
  Method method = Method::kLdm;
  int neighbourhood = 0;
  std::string zone;        // "all" for the whole shape
  std::size_t voxels = 0;  // that the errors are of
  double mean_deg = 0.0, p95_deg = 0.0, max_deg = 0.0;
  std::size_t undefined = 0;                // of `voxels`; they have no error
  std::optional<double> max_with_tool_deg;  // of the methods that are told the tool's direction
  double ns_per_normal = 0.0;               // NaN where no voxel of the zone was timed
  double ratio_to_ldm = 0.0;  // of the times, at the same neighbourhood; NaN without ldm
};

/// Errors and times of each run on a shape, which may be in several parts that are told apart by
/// their zones: a row per run and zone, after one for the whole.
///
/// Errors are of all voxels, or of an even stride over them for slow methods (MethodInfo). PCL's
/// normals are turned to the side of the truth, in its favour.
///
/// With the tool: that stands where the shape says, else it meets the surface squarely, along the
/// true normal; what it vetoes may then be worst by 90 degrees, not by 180.
///
/// Times are of this thread's processor time, best of three passes; in each pass every run has its
/// turn, so that a change in the machine's pace meets all alike. Slow methods are timed on
/// stretches of neighbouring voxels spread evenly, so that caches serve them as they do the others.
/// Making PCL's search tree is not counted, in its favour.
///
/// `progress` is told what is being done.
std::vector<NormalsRow> measure_normals(std::span<const TruthShape> parts,
                                        std::span<const MethodRun> runs,
                                        const std::function<void(const std::string&)>& progress);

/// Cost of one normal on a shape.
struct CostRow {
  Method method;
  int neighbourhood;
  double readouts, ns_per_normal;
};
std::vector<CostRow> costs_of(std::span<const NormalsRow> rows_of_a_shape);

/// Exponents p of c n^p, n = 2 NS + 1, that fit a method's times and readouts best (least squares
/// of the logarithms); NaN with fewer than two neighbourhoods
/// [Kim and Park 2019, VI-C: n^2 against n^3].
struct CostGrowth {
  double time, readouts;
};
CostGrowth growth_of(Method method, const std::vector<CostRow>& costs);

}  // namespace sulcus::lab
