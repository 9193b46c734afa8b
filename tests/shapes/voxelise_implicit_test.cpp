#include "engine/shapes/voxelise_implicit.hpp"

#include <array>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/shapes/basic_shapes.hpp"
#include "engine/shapes/molar.hpp"

namespace sulcus::voxelise_implicit_test {
namespace {

using Eigen::Vector3d;

constexpr std::array<std::uint8_t, 4> kLabels{3, 1, 2, 0};

Pose oblique() {
  return {Vector3d(0.3e-3, -0.2e-3, 0.1e-3),
          Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vector3d(1.0, 2.0, -1.0).normalized()))};
}

/// Every voxel by itself.
template <class S>
void expect_equals_brute_force(const S& shape, const VoxelGrid& grid, const Pose& pose) {
  const VoxelModel model = voxelise_implicit(shape, grid, &kLabels, pose);
  const Eigen::Matrix3d turn = pose.orientation.conjugate().toRotationMatrix();
  std::uint64_t solid = 0, wrong = 0, wrong_labels = 0;
  Cell c;
  for (c.z() = 0; c.z() < grid.cells.z(); ++c.z()) {
    for (c.y() = 0; c.y() < grid.cells.y(); ++c.y()) {
      for (c.x() = 0; c.x() < grid.cells.x(); ++c.x()) {
        const Vector3d p = turn * (grid.centre_world(c) - pose.position);
        const bool inside = shape.value(p) <= 0.0;
        wrong += model.solid(c) != inside ? 1 : 0;
        if (!inside) continue;
        ++solid;
        const std::uint8_t label =
            kLabels[static_cast<std::size_t>(shape.parts_within(p, 0.0, PartSet::all()).first())];
        wrong_labels += model.tissue(c) != label ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(wrong_labels, 0u);
  EXPECT_GT(solid, 0u);
  EXPECT_EQ(model.solid_count(), solid);
}

TEST(VoxeliseImplicit, EqualsBruteForceForEveryShape) {
  const VoxelGrid grid{{40, 48, 56}, 0.15e-3};
  for (const Pose& pose : {Pose{}, oblique()}) {
    expect_equals_brute_force(SphereShape(2.5e-3), grid, pose);
    expect_equals_brute_force(BoxShape(Vector3d(3e-3, 4e-3, 5e-3)), grid, pose);
    expect_equals_brute_force(PlateShape(0.5e-3, 0.3), grid, pose);
    expect_equals_brute_force(TorusShape(2e-3, 0.7e-3), grid, pose);
    expect_equals_brute_force(GrooveShape(1.0, 1e-3), grid, pose);
  }
}

TEST(VoxeliseImplicit, EqualsBruteForceForTheMolar) {
  const Molar molar(0.9e-3);
  expect_equals_brute_force(molar, {{48, 40, 72}, 0.3e-3}, Pose{});
  expect_equals_brute_force(molar, {{48, 40, 72}, 0.3e-3}, oblique());
  expect_equals_brute_force(molar, {{40, 40, 40}, 0.1e-3}, {Vector3d(0, 0, -5e-3), {1, 0, 0, 0}});
}

TEST(VoxeliseImplicit, CountsThePapersSphere) {
  const VoxelGrid grid{{256, 256, 256}, 34.8e-6};
  const VoxelModel model = voxelise_implicit(SphereShape(102.4 * grid.voxel_m), grid, nullptr);
  EXPECT_FALSE(model.clipped);
  EXPECT_EQ(model.tissues, nullptr);
  int surface = 0;
  Cell c;
  for (c.z() = 0; c.z() < 256; ++c.z()) {
    for (c.y() = 0; c.y() < 256; ++c.y()) {
      for (c.x() = 0; c.x() < 256; ++c.x()) {
        if (!model.solid(c)) continue;
        bool bare = false;
        for (int axis = 0; axis < 3; ++axis) {
          bare = bare || !model.solid(c - Cell::Unit(axis)) || !model.solid(c + Cell::Unit(axis));
        }
        surface += bare ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(surface, 108768);
}

TEST(VoxeliseImplicit, ResultDoesNotDependOnThreads) {
  const Molar molar;
  const VoxelGrid grid{{72, 64, 80}, 0.2e-3};
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return voxelise_implicit(molar, grid, &kLabels);
  };
  const VoxelModel one = with_threads(1), four = with_threads(4);
  EXPECT_TRUE(one.leaves == four.leaves);
  EXPECT_EQ(one.clipped, four.clipped);
  for (std::uint32_t leaf = 0; leaf < grid.leaf_count(); ++leaf) {
    ASSERT_EQ(one.tissues->uniform_label(leaf), four.tissues->uniform_label(leaf));
    const LabelBlock *a = one.tissues->block(leaf), *b = four.tissues->block(leaf);
    ASSERT_EQ(a == nullptr, b == nullptr);
    if (a) {
      ASSERT_EQ(*a, *b);
    }
  }
}

TEST(VoxeliseImplicit, SaysWhatTheGridCutOff) {
  const VoxelGrid grid{{64, 64, 64}, 0.1e-3};  // 6.4 mm
  const auto clipped = [&](const auto& shape, const Pose& pose) {
    return voxelise_implicit(shape, grid, nullptr, pose).clipped;
  };
  EXPECT_FALSE(clipped(SphereShape(3.1e-3), Pose{}));
  EXPECT_TRUE(clipped(SphereShape(3.5e-3), Pose{}));
  EXPECT_TRUE(clipped(SphereShape(2.0e-3), {Vector3d(0, 2e-3, 0), {1, 0, 0, 0}}));
  EXPECT_FALSE(clipped(PlateShape(1e-3, 0.2), Pose{}));  // endless bodies end nowhere
  EXPECT_FALSE(clipped(GrooveShape(1.0, 1e-3), Pose{}));
  EXPECT_TRUE(clipped(Molar(), Pose{}));
  // A ring about the grid: its bounds pass every face, but no voxel is solid.
  const VoxelModel around = voxelise_implicit(TorusShape(9e-3, 1e-3), grid, nullptr);
  EXPECT_FALSE(around.clipped);
  EXPECT_EQ(around.solid_count(), 0u);
}

TEST(VoxeliseImplicit, AVoxelOnTheSurfaceIsSolid) {
  // Voxel centres lie at odd multiples of half a metre, so on the faces of this box exactly.
  const VoxelModel model =
      voxelise_implicit(BoxShape(Vector3d(3.0, 3.0, 3.0)), {{8, 8, 8}, 1.0}, nullptr);
  EXPECT_EQ(model.solid_count(), 64u);
}

TEST(VoxeliseImplicit, RefusesAGridThatNoModelCanHave) {
  const SphereShape sphere(1e-3);
  EXPECT_THROW(voxelise_implicit(sphere, {{20, 16, 16}, 1e-4}, nullptr), InputError);
  EXPECT_THROW(voxelise_implicit(sphere, {{1032, 16, 16}, 1e-4}, nullptr), InputError);
  EXPECT_THROW(voxelise_implicit(sphere, {{16, 0, 16}, 1e-4}, nullptr), InputError);
  EXPECT_THROW(voxelise_implicit(sphere, {{16, 16, 16}, 0.0}, nullptr), InputError);
}

}  // namespace
}  // namespace sulcus::voxelise_implicit_test
