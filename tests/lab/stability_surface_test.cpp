#include <algorithm>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tools/sulcus_lab/stability/cases/cases.hpp"

namespace sulcus::lab::stability_surface_test {
namespace {

constexpr ContactMethod kOurs[] = {ContactMethod::kCoupling};

/// Limits that the default method does not meet, by the case and how the quantity begins. When one
/// of them is met its line goes.
struct KnownMiss {
  std::string_view case_name, quantity;
};
constexpr KnownMiss kKnownMisses[] = {
    // Without a coupling nothing turns the force steadily from one face to the other: 2.7 and 2.6.
    {"edge_normals", "turn_deg_per_tick: ridge round it 0.1 mm deep tool put there"},
    {"edge_normals", "turn_deg_per_tick: ridge level 0.1 mm deep tool put there"},
};

bool is_known_miss(const StabilityRow& row) {
  return std::ranges::any_of(kKnownMisses, [&](const KnownMiss& miss) {
    return row.case_name == miss.case_name && row.quantity == miss.quantity;
  });
}

void expect_passes(std::string_view name) {
  const CaseResult result = run_case(name, {kOurs, true});
  EXPECT_FALSE(result.rows.empty());
  for (const StabilityRow& row : result.rows) {
    EXPECT_NE(row.pass(), is_known_miss(row))
        << row.case_name << ", " << row.quantity << ": " << row.value
        << (row.at_least ? ", at least " : ", at most ") << row.limit.value_or(0.0);
  }
  for (const ForceTrace& trace : result.traces) {
    EXPECT_EQ(trace.force_N.size(), trace.depth_mm.size());
    EXPECT_GT(std::ranges::max(trace.force_N), 0.0f) << trace.case_name << ", " << trace.label;
  }
}

TEST(StabilityWalls, ThinWall) { expect_passes("thin_wall"); }
TEST(StabilityWalls, ThinWallStiffness) { expect_passes("thin_wall_stiffness"); }
TEST(StabilityWalls, Tunnelling) { expect_passes("tunnelling"); }
TEST(StabilityWalls, Sticking) { expect_passes("sticking"); }
TEST(StabilityWalls, DeepInside) { expect_passes("deep_inside"); }
TEST(StabilitySurface, EdgeNormals) { expect_passes("edge_normals"); }
TEST(StabilitySurface, TiltedPlanes) { expect_passes("tilted_planes"); }
TEST(StabilitySurface, OpposingFaces) { expect_passes("opposing_faces"); }
TEST(StabilitySurface, VanishingVoxels) { expect_passes("vanishing_voxels"); }
TEST(StabilitySurface, CountSteps) { expect_passes("count_steps"); }
TEST(StabilitySurface, Spur) { expect_passes("spur"); }
TEST(StabilitySurface, Wedge) { expect_passes("wedge"); }

/// The limits tell methods apart: the plain penalty goes through a wall that the coupling holds.
TEST(StabilityWalls, ThePlainPenaltyGoesThrough) {
  constexpr ContactMethod kPlain[] = {ContactMethod::kNone};
  const CaseResult result = run_case("tunnelling", {kPlain, true});
  for (const StabilityRow& row : result.rows) EXPECT_FALSE(row.pass()) << row.quantity;
}

}  // namespace
}  // namespace sulcus::lab::stability_surface_test
