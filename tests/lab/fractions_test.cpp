#include "tools/sulcus_lab/fractions/fractions.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tools/sulcus_lab/fractions/force_grain.hpp"

namespace sulcus::lab::fractions_test {
namespace {

using Eigen::Vector3d;

// The quick half of `sulcus-lab fractions`: where fractions must not lose to binary surfaces.

FractionOptions quickly() {
  FractionOptions options;
  options.quick = true;
  return options;
}

std::string described(const FractionRow& row) {
  return row.quantity + ", " + row.shape + ", " + row.setting;
}

TEST(Fractions, NormalsAreBetter) {
  const std::vector<FractionRow> rows = fractions_of_normals(quickly());
  const auto has = [&](std::string_view shape, std::string_view zone) {
    return std::ranges::any_of(
        rows, [&](const FractionRow& row) { return row.shape == shape && row.setting == zone; });
  };
  for (const char* shape : {"sphere", "torus", "planes"}) EXPECT_TRUE(has(shape, "all")) << shape;
  for (const char* zone : {"face", "near", "edge"}) EXPECT_TRUE(has("rotated_cube", zone)) << zone;
  for (const FractionRow& row : rows) {
    SCOPED_TRACE(described(row));
    EXPECT_GT(row.fractions(), 0.0);
    EXPECT_LT(row.fractions(), row.binary());
    EXPECT_TRUE(row.is_timed());
    EXPECT_TRUE(row.pass()) << row.fractions() << ", wanted " << row.wanted;
  }
}

TEST(Fractions, AForceOverATiltedPlaneIsEvenAndStraight) {
  const std::vector<FractionRow> rows = fractions_of_planes(quickly());
  EXPECT_EQ(rows.size(), 8u);
  for (const FractionRow& row : rows) {
    SCOPED_TRACE(described(row));
    EXPECT_GT(row.binary(), row.wanted);
    EXPECT_TRUE(row.pass()) << row.fractions();
  }
}

TEST(Fractions, ABurrTakesWhatItSweeps) {
  const std::vector<FractionRow> rows = fractions_of_sweeps(quickly());
  EXPECT_FALSE(rows.empty());
  for (const FractionRow& row : rows) {
    SCOPED_TRACE(described(row));
    EXPECT_GT(row.binary(), row.wanted);
    EXPECT_TRUE(row.pass()) << row.fractions();
  }
}

TEST(Fractions, SideCuttingHasLessGrain) {
  const std::vector<FractionRow> rows = fractions_of_grain(quickly());
  const auto row = std::ranges::find_if(rows, [](const FractionRow& r) {
    return r.shape == "side_cut" && r.quantity == "force_grain_pct";
  });
  ASSERT_NE(row, rows.end());
  EXPECT_LT(row->fractions(), row->binary());
  EXPECT_TRUE(row->pass()) << row->fractions();
}

TEST(Fractions, SurfacesLieWhereTheyAre) {
  const std::vector<FractionRow> rows = fractions_of_surfaces(quickly());
  EXPECT_EQ(rows.size(), 10u);  // sphere, torus, planes, the cube's faces, its edges: two of each
  for (const FractionRow& row : rows) {
    SCOPED_TRACE(described(row));
    EXPECT_GT(row.fractions(), 0.0);
    EXPECT_LT(row.fractions(), row.binary());
    EXPECT_TRUE(row.pass()) << row.fractions() << ", wanted " << row.wanted;
  }
}

TEST(FractionRow, PassesByItsSize) {
  FractionRow row;
  row.wanted = 0.5;
  row.value = {3.0, -0.4};
  EXPECT_TRUE(row.pass());
  row.value[1] = -0.6;
  EXPECT_FALSE(row.pass());
  row.value[1] = NAN;
  EXPECT_FALSE(row.pass());
}

/// A straight way, and a force that bends with it, 2 N in the mean about.
struct StraightCut {
  std::vector<Vector3d> positions_m, forces_N;
};
StraightCut straight_cut(int ticks) {
  StraightCut cut;
  for (int t = 0; t < ticks; ++t) {
    const double x = t / 500.0;
    cut.positions_m.emplace_back(4e-6 * t, 0.0, 0.0);
    cut.forces_N.emplace_back(0.3 * x, 0.1 * x * x, 2.0);
  }
  return cut;
}

TEST(ForceGrain, AQuadraticHasNone) {
  const StraightCut cut = straight_cut(500);
  const ForceGrain grain = force_grain(cut.positions_m, cut.forces_N);
  EXPECT_EQ(grain.ticks, 460);
  EXPECT_LT(grain.grain_pct, 1e-10);
}

/// A force that is 10 mN more in every second tick and as much less in the others: of such a row
/// the best quadratic keeps what the weight of the middle and those around it come to.
TEST(ForceGrain, IsTheSizeOfWhatAlternates) {
  StraightCut cut = straight_cut(500);
  for (Vector3d& force : cut.forces_N) force = {0.0, 0.0, 2.0};
  for (std::size_t t = 0; t < 500; ++t) cut.forces_N[t].z() += t % 2 == 0 ? 0.01 : -0.01;
  const ForceGrain grain = force_grain(cut.positions_m, cut.forces_N);
  EXPECT_NEAR(grain.mean_N, 2.0, 1e-3);
  EXPECT_NEAR(grain.largest_step_N, 0.02, 1e-12);
  EXPECT_NEAR(grain.grain_pct, 0.5, 0.03);
}

TEST(ForceGrain, LeavesOutCornersAndAir) {
  StraightCut cut = straight_cut(500);
  for (std::size_t t = 300; t < 500; ++t) {
    cut.positions_m[t] = {4e-6 * 299, 4e-6 * static_cast<double>(t - 299), 0.0};
  }
  // A jump at the corner and one out of the material count nowhere.
  for (std::size_t t = 300; t < 500; ++t) cut.forces_N[t].z() += 1.0;
  cut.forces_N[100] = Vector3d::Zero();
  const ForceGrain grain = force_grain(cut.positions_m, cut.forces_N);
  EXPECT_LT(grain.grain_pct, 1e-10);
  EXPECT_LT(grain.largest_step_N, 0.01);
  // Even are 0 to 79, 121 to 239 and 361 to 499, less 20 at both ends of each.
  EXPECT_EQ(grain.ticks, 40 + 79 + 99);
}

}  // namespace
}  // namespace sulcus::lab::fractions_test
