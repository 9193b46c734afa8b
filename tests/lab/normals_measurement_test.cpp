#include "tools/sulcus_lab/normals/normals_measurement.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "tests/support/shapes.hpp"
#include "tools/sulcus_lab/truth/error_stats.hpp"

namespace sulcus::lab::normals_measurement_test {
namespace {

using Eigen::Vector3d;

const auto kSilent = [](const std::string&) {};

/// A ball of radius 9, its upper half and its lower half zones of their own.
TruthShape small_ball() {
  TruthShape shape;
  shape.name = "ball";
  const Vector3d centre(15.7, 16.1, 15.9);
  shape.model = test::ball({32, 32, 32}, 1e-4, centre, 9.0);
  shape.zones = {"upper", "lower"};
  for (const Cell& cell : test::surface_cells(Workpiece{VoxelModel(shape.model)})) {
    const Vector3d outward = cell.cast<double>() - centre;
    shape.voxels.push_back({cell, outward.normalized(), outward.z() > 0.0 ? 0 : 1});
  }
  return shape;
}

const NormalsRow& row_of(const std::vector<NormalsRow>& rows, Method method,
                         std::string_view zone) {
  const auto at = std::find_if(rows.begin(), rows.end(), [&](const NormalsRow& row) {
    return row.method == method && row.zone == zone;
  });
  EXPECT_NE(at, rows.end());
  return *at;
}

TEST(ErrorStats, MeanNinetyFifthAndGreatest) {
  std::vector<float> errors;
  for (int n = 100; n >= 1; --n) errors.push_back(static_cast<float>(n));
  const ErrorStats stats = error_stats(errors);
  EXPECT_DOUBLE_EQ(stats.mean, 50.5);
  EXPECT_DOUBLE_EQ(stats.p95, 95.0);
  EXPECT_DOUBLE_EQ(stats.max, 100.0);
  EXPECT_EQ(error_stats({}).max, 0.0);
}

TEST(ErrorStats, TheToolStandsInForWhatIsMissingOrOpposed) {
  const Vector3d up = Vector3d::UnitZ();
  const SurfaceEstimate none, down{{0, 0, -1}, 0.5f, true}, tilted{{0.6f, 0, 0.8f}, 0.5f, true};
  EXPECT_FALSE(with_tool_direction(none, std::nullopt).defined);
  EXPECT_EQ(with_tool_direction(none, up).normal, Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(with_tool_direction(down, up).normal, Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(with_tool_direction(down, std::nullopt).normal, down.normal);
  EXPECT_EQ(with_tool_direction(tilted, up).normal, tilted.normal);
}

TEST(ErrorStats, AnglesInDegreesToTheTruthOrToEitherSign) {
  TruthShape shape;
  const TruthVoxel truth{{0, 0, 0}, Vector3d::UnitX(), 0};
  const SurfaceEstimate estimate{{-0.6f, 0.8f, 0.0f}, 0.0f, true};
  EXPECT_NEAR(*error_deg(estimate, truth, shape), 126.8699, 1e-3);
  shape.either_sign = true;
  EXPECT_NEAR(*error_deg(estimate, truth, shape), 53.1301, 1e-3);
  EXPECT_FALSE(error_deg(SurfaceEstimate{}, truth, shape));
}

TEST(ErrorStats, ALineIsTurnedToTheSideOfTheTruth) {
  const TruthVoxel truth{{0, 0, 0}, Vector3d(0.6, 0.8, 0.0), 0};
  const Eigen::Vector3f inward(-1, 0, 0), outward(0, 1, 0);
  EXPECT_EQ(turned_outward({inward, 0.0f, true}, truth).normal, -inward);
  EXPECT_EQ(turned_outward({outward, 0.0f, true}, truth).normal, outward);
}

TEST(NormalsMeasurement, RowsForEachRunAndZone) {
  const std::array shapes{small_ball()};
  const std::array runs{MethodRun{Method::kLdm, 3}, MethodRun{Method::kLdmPaper, 3},
                        MethodRun{Method::kWeightedSum, 2}};
  const std::vector<NormalsRow> rows = measure_normals(shapes, runs, kSilent);
  EXPECT_EQ(rows.size(), 9u);
  for (const MethodRun& run : runs) {
    const NormalsRow& all = row_of(rows, run.method, "all");
    const NormalsRow& upper = row_of(rows, run.method, "upper");
    const NormalsRow& lower = row_of(rows, run.method, "lower");
    EXPECT_EQ(all.voxels, shapes[0].voxels.size());
    EXPECT_EQ(upper.voxels + lower.voxels, all.voxels);
    const auto sum = [](const NormalsRow& row) {
      return row.mean_deg * static_cast<double>(row.voxels);
    };
    EXPECT_NEAR(sum(all), sum(upper) + sum(lower), 1e-6 * sum(all));
    EXPECT_EQ(all.max_deg, std::max(upper.max_deg, lower.max_deg));
    EXPECT_EQ(all.undefined, 0u);
    EXPECT_GT(all.mean_deg, 0.1);
    EXPECT_LT(all.mean_deg, 8.0);
    EXPECT_GT(all.ns_per_normal, 0.0);
  }
  EXPECT_EQ(row_of(rows, Method::kLdm, "all").ratio_to_ldm, 1.0);
  const NormalsRow& paper = row_of(rows, Method::kLdmPaper, "all");
  EXPECT_DOUBLE_EQ(paper.ratio_to_ldm,
                   paper.ns_per_normal / row_of(rows, Method::kLdm, "all").ns_per_normal);
  EXPECT_TRUE(std::isnan(row_of(rows, Method::kWeightedSum, "all").ratio_to_ldm))
      << "ldm was not run at NS = 2";
}

TEST(NormalsMeasurement, PartsAreOneTableAndTheUndefinedAreCounted) {
  // A lone voxel has no direction of its own.
  TruthShape alone;
  alone.name = "alone";
  alone.zones = {"voxel"};
  alone.model = test::block({16, 16, 16}, 1e-4, {8, 8, 8}, {9, 9, 9});
  alone.voxels = {{{8, 8, 8}, Vector3d::UnitX(), 0}};
  TruthShape touched = alone;
  touched.zones = {"touched"};
  touched.tool_direction = Vector3d::UnitY();
  const std::array parts{alone, touched};
  const std::array runs{MethodRun{Method::kLdmPaper, 2}};
  const std::vector<NormalsRow> rows = measure_normals(parts, runs, kSilent);
  EXPECT_EQ(row_of(rows, Method::kLdmPaper, "all").voxels, 2u);
  EXPECT_EQ(row_of(rows, Method::kLdmPaper, "all").undefined, 1u);
  EXPECT_EQ(row_of(rows, Method::kLdmPaper, "voxel").undefined, 1u);
  EXPECT_EQ(row_of(rows, Method::kLdmPaper, "touched").undefined, 0u);
  EXPECT_NEAR(row_of(rows, Method::kLdmPaper, "touched").mean_deg, 90.0, 1e-3);
}

TEST(NormalMethods, PclFindsTheLineOfTheNormal) {
  if (!is_available(Method::kPca)) GTEST_SKIP() << "built without PCL";
  const std::array shapes{small_ball()};
  const std::array runs{MethodRun{Method::kPca, 3}, MethodRun{Method::kMls, 3}};
  for (const NormalsRow& row : measure_normals(shapes, runs, kSilent)) {
    EXPECT_LT(row.mean_deg, 5.0);
    EXPECT_LE(row.max_deg, 90.0) << "the sign is the truth's";
  }
}

TEST(NormalMethods, NamesAndUsualNeighbourhoods) {
  EXPECT_EQ(method_named("weighted_sum_d2"), Method::kWeightedSumD2);
  EXPECT_THROW(method_named("voronoi"), InputError);
  EXPECT_EQ(usual_neighbourhoods(Method::kLdm), (std::vector<int>{1, 2, 3, 4, 5, 6, 8, 12}));
  EXPECT_EQ(usual_neighbourhoods(Method::kExact), (std::vector<int>{1, 2, 3, 4, 5, 6}));
  for (const MethodInfo& info : all_methods()) EXPECT_EQ(info_of(info.method).name, info.name);
}

TEST(Cost, GrowthIsTheSlopeOfTheLogarithms) {
  std::vector<CostRow> costs;
  for (const int ns : {1, 2, 4, 6}) {
    const double n = 2.0 * ns + 1.0;
    costs.push_back({Method::kLdm, ns, readouts(Method::kLdm, ns), 7.0 * std::pow(n, 1.5)});
    costs.push_back({Method::kExact, ns, readouts(Method::kExact, ns), 1.0});
  }
  EXPECT_NEAR(growth_of(Method::kLdm, costs).time, 1.5, 1e-9);
  EXPECT_NEAR(growth_of(Method::kLdm, costs).readouts, 2.0, 1e-9);
  EXPECT_NEAR(growth_of(Method::kExact, costs).readouts, 3.0, 1e-9);
  EXPECT_TRUE(std::isnan(growth_of(Method::kPca, costs).time));
}

}  // namespace
}  // namespace sulcus::lab::normals_measurement_test
