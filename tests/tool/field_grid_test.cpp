#include "engine/tool/field_grid.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"

namespace sulcus::field_grid_test {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

const AlignedBox3d kBounds(Vector3d(-0.8e-3, 0.0, -0.8e-3), Vector3d(0.8e-3, 6.4e-3, 0.8e-3));
constexpr double kHead = 1.4e-3, kVoxel = 34.8e-6;

void expect_holds(const FieldGrid& grid, const AlignedBox3d& bounds) {
  const Vector3d low = grid.field_from_tool(bounds.min());
  const Vector3d high = grid.field_from_tool(bounds.max());
  EXPECT_GE(low.minCoeff(), kFieldMargin - 1e-6);
  EXPECT_LE((high - grid.samples.cast<double>()).maxCoeff(), -1.0 - kFieldMargin + 1e-6);
  EXPECT_LT((grid.tool_from_field(low) - bounds.min()).norm(), 1e-12);
  EXPECT_LT(((low + high) - (grid.samples.cast<double>() - Vector3d::Ones())).norm(), 1e-6)
      << "the burr lies in the middle";
}

std::string error_of(const BurrSettings& settings, const AlignedBox3d& bounds = kBounds,
                     double head = kHead) {
  try {
    plan_field(settings, bounds, head, kVoxel, "scene.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

void expect_error(const std::string& error, const std::string& place, const std::string& part) {
  EXPECT_EQ(error.find("scene.toml: " + place + ": found "), 0u) << error;
  EXPECT_NE(error.find(part), std::string::npos) << error;
}

TEST(FieldGrid, SamplesAreAsFineAsTheyMayBe) {
  const FieldGrid grid = plan_field({}, kBounds, kHead, kVoxel);
  EXPECT_EQ(grid.samples, Vector3i(128, 512, 128));
  expect_holds(grid, kBounds);
  EXPECT_NEAR(grid.spacing_m, 1.6e-3 / 123, 1e-12);
}

TEST(FieldGrid, SpacingMayBeGiven) {
  BurrSettings settings;
  settings.field_spacing_m = 20e-6;
  FieldGrid grid = plan_field(settings, kBounds, kHead, kVoxel);
  EXPECT_EQ(grid.spacing_m, 20e-6);
  EXPECT_EQ(grid.samples, Vector3i(128, 512, 128));
  expect_holds(grid, kBounds);

  settings.field_samples.reset();
  grid = plan_field(settings, kBounds, kHead, kVoxel);
  EXPECT_EQ(grid.samples, Vector3i(85, 325, 85));
  expect_holds(grid, kBounds);
}

TEST(FieldGrid, AutoFollowsTheVoxelTheHeadAndTheMemory) {
  BurrSettings settings;
  settings.field_samples.reset();
  FieldGrid grid = plan_field(settings, kBounds, kHead, kVoxel);
  // A sphere as wide as the head, between two samples: within 1/512 of a voxel, and no better.
  EXPECT_NEAR(grid.spacing_m * grid.spacing_m / (4.0 * kHead), kVoxel / 512, 1e-12);
  expect_holds(grid, kBounds);

  grid = plan_field(settings, kBounds, 20e-3, kVoxel);
  EXPECT_DOUBLE_EQ(grid.spacing_m, kVoxel) << "a large head";

  grid = plan_field(settings, kBounds, 0.3e-3, 200e-6);
  EXPECT_DOUBLE_EQ(grid.spacing_m, 0.3e-3 / 16) << "a small head";

  const AlignedBox3d large(Vector3d(-2.5e-3, 0.0, -2.5e-3), Vector3d(2.5e-3, 20e-3, 2.5e-3));
  grid = plan_field(settings, large, 5e-3, 5e-6);
  EXPECT_LE(grid.samples.maxCoeff(), 1024);
  EXPECT_LE(grid.samples.cast<double>().prod(), 1 << 25);
  expect_holds(grid, large);
}

TEST(FieldGrid, RefusesImpossibleSampleCounts) {
  for (const Vector3i& samples :
       {Vector3i(7, 512, 128), Vector3i(128, 1025, 128), Vector3i(1024, 1024, 1024),
        Vector3i(-1, 512, 128), Vector3i(0, 0, 0), Vector3i::Constant(1 << 30).eval()}) {
    BurrSettings settings;
    settings.field_samples = samples;
    expect_error(error_of(settings), "burr.field", "expected 8 to 1024 along each axis");
  }
}

TEST(FieldGrid, RefusesABoxThatDoesNotHoldTheBurr) {
  BurrSettings settings;
  settings.field_spacing_m = 10e-6;
  expect_error(error_of(settings), "burr.field_spacing_mm",
               "found a box of 1.27 x 5.11 x 1.27 mm, expected at least 1.64 x 6.44 x 1.64 mm");
  settings.field_spacing_m = 12.9e-6;  // holds the burr but not the margin
  expect_error(error_of(settings), "burr.field_spacing_mm", "to hold the burr");
}

TEST(FieldGrid, RefusesSpacingsThatAreNone) {
  for (const double spacing : {0.0, -1e-5, std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity()}) {
    BurrSettings settings;
    settings.field_spacing_m = spacing;
    expect_error(error_of(settings), "burr.field_spacing_mm", "more than 0 mm");
  }
  BurrSettings settings;
  settings.field_samples.reset();
  settings.field_spacing_m = 1e-9;  // more samples than an int holds in all
  expect_error(error_of(settings), "burr.field_spacing_mm", "at most 1024 along each axis");
}

TEST(FieldGrid, RefusesAFieldTooCoarseForTheHead) {
  BurrSettings settings;
  settings.field_samples = Vector3i(8, 32, 8);
  expect_error(error_of(settings), "burr.field", "samples across the head, expected at least 4");
  settings.field_samples = Vector3i(128, 512, 128);
  settings.field_spacing_m = 0.5e-3;
  expect_error(error_of(settings), "burr.field_spacing_mm", "2.8 samples across the head");
}

}  // namespace
}  // namespace sulcus::field_grid_test
