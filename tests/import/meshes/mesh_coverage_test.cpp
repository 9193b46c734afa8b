#include "engine/import/meshes/mesh_coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/core/pose.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "engine/import/meshes/voxelise_mesh.hpp"
#include "tests/import/mesh_fixtures.hpp"
#include "tests/support/fills.hpp"

// The fill levels of meshes, through the importers that ask for them.

namespace sulcus::mesh_coverage_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::filled_m3;
using test::share;

VoxelGrid grid_of(int cells, double voxel_m) { return {Eigen::Vector3i::Constant(cells), voxel_m}; }

WorkpieceSettings fractions() {
  WorkpieceSettings settings;
  settings.surface = SurfaceKind::kFractions;
  return settings;
}

WorkpieceSettings oblique() {
  WorkpieceSettings settings = fractions();
  settings.position_m = {0.03e-3, -0.02e-3, 0.017e-3};
  settings.rotation = {0.3, -0.5, 0.7};
  return settings;
}

WorkpieceSettings binary(WorkpieceSettings settings) {
  settings.surface = SurfaceKind::kBinary;
  return settings;
}

/// Leaves every `one_in`th triangle away, by chance.
TriangleMesh punched(TriangleMesh mesh, std::uint32_t one_in) {
  std::mt19937 random(7);
  std::erase_if(mesh.triangles, [&](const auto&) { return random() % one_in == 0; });
  return mesh;
}

TriangleMesh ball(float radius_m) {
  TriangleMesh mesh = icosphere(5);  // 20,480 triangles
  scale(mesh, radius_m);
  return mesh;
}

void add(TriangleMesh& mesh, const TriangleMesh& part, const Vector3f& shift, bool inwards) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vector3f& p : part.positions) mesh.positions.push_back(p + shift);
  for (auto t : part.triangles) {
    if (inwards) std::swap(t[0], t[1]);
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
}

TEST(MeshCoverage, ATiltedBoxHasItsVolume) {
  // Of few large triangles, 24 x 17 x 12 voxels.
  const TriangleMesh mesh = box_mesh({2.4e-3f, 1.7e-3f, 1.2e-3f});
  const VoxelGrid grid = grid_of(40, 1e-4);
  const double exact = 2.4e-3 * 1.7e-3 * 1.2e-3;
  double squares = 0.0;
  constexpr int kPlaces = 8;
  for (int n = 0; n < kPlaces; ++n) {
    WorkpieceSettings settings = oblique();
    settings.rotation.x() += 0.1 * n;
    const VoxelModel filled = voxelise_mesh(mesh, grid, settings);
    const VoxelModel whole = voxelise_mesh(mesh, grid, binary(settings));
    EXPECT_NEAR(filled_m3(filled) / exact, 1.0, 1e-4) << n;
    squares += std::pow(filled_m3(whole) / exact - 1.0, 2);
    EXPECT_FALSE(whole.fills);
    EXPECT_GT(filled.solid_count(), whole.solid_count());
  }
  EXPECT_GT(std::sqrt(squares / kPlaces), 4e-4);
}

TEST(MeshCoverage, ATiltedBoxVoxelByVoxel) {
  const TriangleMesh mesh = box_mesh({2.4e-3f, 1.7e-3f, 1.2e-3f});
  const WorkpieceSettings settings = oblique();
  const VoxelModel model = voxelise_mesh(mesh, grid_of(40, 1e-4), settings);
  const Eigen::Matrix3d box_from_world =
      rotation_xyz(settings.rotation).toRotationMatrix().transpose();
  constexpr int kParts = 12;
  double worst = 0.0, squares = 0.0;
  int partly = 0;
  for_each_cell(Cell::Zero(), model.grid.cells, [&](const Cell& c) {
    // How far a point of the voxel is beyond the box's faces, in the direction that it is most.
    const auto beyond_m = [&](const Vector3d& to) {
      const Vector3d p = box_from_world *
                         (model.grid.world_from_index(c.cast<double>() + to) - settings.position_m);
      return (p.cwiseAbs() - Vector3d(1.2e-3, 0.85e-3, 0.6e-3)).maxCoeff();
    };
    int in = 0;
    if (const double middle_m = beyond_m(Vector3d::Zero()); std::abs(middle_m) > 0.87e-4) {
      in = middle_m < 0.0 ? kParts * kParts * kParts : 0;  // no corner lies farther from the middle
    } else {
      for_each_cell(Cell::Zero(), Cell::Constant(kParts), [&](const Cell& part) {
        const Vector3d to = (part.cast<double>().array() + 0.5) / kParts - 0.5;
        in += beyond_m(to) <= 0.0 ? 1 : 0;
      });
    }
    const double error = share(model, c) - in / double(kParts * kParts * kParts);
    worst = std::max(worst, std::abs(error));
    if (in == 0 || in == kParts * kParts * kParts) return;
    squares += error * error;
    ++partly;
  });
  // What the points of the truth leave over.
  EXPECT_LT(worst, 0.03);
  EXPECT_LT(std::sqrt(squares / partly), 0.006);
  EXPECT_GT(partly, 1500);
}

TEST(MeshCoverage, FacesAlongTheGridAreExact) {
  // Faces, edges and diagonals run along the lattice: 20.6 x 15 x 9.3 voxels.
  const VoxelModel model =
      voxelise_mesh(box_mesh({20.6e-4f, 15.0e-4f, 9.3e-4f}), grid_of(32, 1e-4), fractions());
  const auto covered = [](int i, double size) {
    return std::clamp(0.5 * size - std::abs(i - 15.5) + 0.5, 0.0, 1.0);
  };
  for_each_cell(Cell::Zero(), model.grid.cells, [&](const Cell& c) {
    const double exact = covered(c.x(), 20.6) * covered(c.y(), 15.0) * covered(c.z(), 9.3);
    ASSERT_NEAR(model.level(c), 255.0 * exact, 0.51) << c.transpose();
  });
}

TEST(MeshCoverage, NeitherTurnNorThreadsMatter) {
  const TriangleMesh mesh = ball(2e-3f);
  for (const TriangleMesh& one : {mesh, punched(mesh, 50)}) {
    TriangleMesh flipped = one;
    for (auto& t : flipped.triangles) std::swap(t[0], t[1]);
    const auto with_threads = [&](std::size_t threads, const TriangleMesh& given) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      return voxelise_mesh(given, grid_of(64, 8e-5), fractions());
    };
    const VoxelModel model = with_threads(1, one);
    test::expect_same_levels(model, with_threads(4, one));
    test::expect_same_levels(model, with_threads(4, flipped));
  }
}

TEST(MeshCoverage, HolesAreClosedAcross) {
  const TriangleMesh mesh = ball(2e-3f);
  const VoxelGrid grid = grid_of(96, 5e-5);
  const VoxelModel closed = voxelise_mesh(mesh, grid, fractions());
  EXPECT_NEAR(filled_m3(closed) / enclosed_volume(mesh), 1.0, 2e-5);
  // Each a triangle of about three voxels.
  const VoxelModel open = voxelise_mesh(punched(mesh, 50), grid, fractions());
  EXPECT_NEAR(filled_m3(open) / enclosed_volume(mesh), 1.0, 1e-3);
  double squares = 0.0, worst = 0.0;
  int partly = 0;
  for_each_cell(Cell::Zero(), grid.cells, [&](const Cell& c) {
    const double one = share(closed, c), other = share(open, c);
    worst = std::max(worst, std::abs(one - other));
    if (one == std::round(one) && other == std::round(other)) return;
    squares += (one - other) * (one - other);
    ++partly;
  });
  EXPECT_LT(std::sqrt(squares / partly), 0.03);
  EXPECT_LT(worst, 0.7);
}

TEST(MeshCoverage, AHoleWiderThanVoxelsIsNoStep) {
  // The top of a ball is missing: all that is known there is winding.
  TriangleMesh mesh = ball(2e-3f);
  std::erase_if(mesh.triangles, [&](const auto& t) {
    return std::ranges::all_of(t, [&](auto v) { return mesh.positions[v].z() > 1.7e-3f; });
  });
  const VoxelGrid grid = grid_of(96, 5e-5);
  const VoxelModel filled = voxelise_mesh(mesh, grid, fractions());
  const VoxelModel whole = voxelise_mesh(mesh, grid, binary(fractions()));
  int partly = 0;
  for_each_cell({40, 40, 70}, {56, 56, 96}, [&](const Cell& c) {
    const FillLevel level = filled.level(c);
    partly += level % kFullLevel != 0 ? 1 : 0;
    // No voxel between them and the surface of binary is of the other kind.
    if (level == kFullLevel) {
      EXPECT_TRUE(whole.solid(c)) << c.transpose();
    }
    if (level == 0) {
      EXPECT_FALSE(whole.solid(c)) << c.transpose();
    }
  });
  EXPECT_GT(partly, 16 * 16 / 2);
}

TEST(MeshCoverage, PartsMayOverlapAndBeHollow) {
  TriangleMesh mesh = box_mesh({20.5e-4f, 20.5e-4f, 20.5e-4f});
  add(mesh, box_mesh({8.5e-4f, 8.5e-4f, 8.5e-4f}), {-3.1e-4f, 0.2e-4f, 0.3e-4f}, true);
  // Sticks out to x = 15.15 of 20.5 / 2 = 10.25.
  add(mesh, box_mesh({9.9e-4f, 6.3e-4f, 6.3e-4f}), {10.2e-4f, 0.1e-4f, 0.4e-4f}, false);
  const VoxelModel model = voxelise_mesh(mesh, grid_of(48, 1e-4), oblique());
  const double exact = 20.5 * 20.5 * 20.5 - 8.5 * 8.5 * 8.5 + (15.15 - 10.25) * 6.3 * 6.3;
  // The voxels where the third comes out of the first have the sum of both.
  EXPECT_NEAR(test::filled_voxels_of(model) / exact, 1.0, 4e-4);
}

TEST(MeshCoverage, WhatTheGridCutsIsFullUpToItsFaces) {
  const VoxelModel model =
      voxelise_mesh(box_mesh({60e-4f, 10.4e-4f, 60e-4f}), grid_of(32, 1e-4), fractions());
  EXPECT_TRUE(model.clipped);
  EXPECT_NEAR(test::filled_voxels_of(model), 32 * 32 * 10.4, 32 * 32 * 2 * 0.5 / 255.0 + 1e-3);
  EXPECT_EQ(model.level({0, 15, 0}), kFullLevel);
  EXPECT_EQ(model.level({31, 15, 31}), kFullLevel);
}

TEST(MeshCoverage, APlateThinnerThanAVoxelIsThere) {
  WorkpieceSettings settings = fractions();
  settings.position_m.z() = 0.5e-4;
  const VoxelModel model =
      voxelise_mesh(box_mesh({16e-4f, 16e-4f, 0.2e-4f}), grid_of(32, 1e-4), settings);
  EXPECT_EQ(model.solid_count(), 16u * 16u);
  EXPECT_NEAR(model.level({15, 15, 16}), 0.2 * 255, 0.51);
}

TEST(MeshCoverage, ARealMolarHasItsVolume) {
  const std::string path = SULCUS_SOURCE_DIR "/../shared/data/open_full_jaw/mandible_tooth_19.stl";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const TriangleMesh mesh = read_mesh(path);
  const VoxelGrid grid = grid_of(120, 2e-4);
  const double exact = enclosed_volume(mesh);
  EXPECT_NEAR(filled_m3(voxelise_mesh(mesh, grid, fractions())) / exact, 1.0, 2e-5);
  EXPECT_GT(std::abs(filled_m3(voxelise_mesh(mesh, grid, {})) / exact - 1.0), 4e-5);
}

// ---- Several of one tooth.

TEST(MeshCoverageOfSurfaces, NestedOnesAreTheOuterOne) {
  const TriangleMesh outer = ball(2e-3f);
  const VoxelGrid grid = grid_of(96, 5e-5);
  // The second is the first again: nothing is counted twice.
  const VoxelModel twice = voxelise_surfaces(
      std::vector<TissueSurface>{{outer, "a", 0}, {outer, "b", 1}}, grid, fractions());
  const VoxelModel once = voxelise_mesh(outer, grid, fractions());
  test::expect_same_levels(once, twice);
  for_each_cell(Cell::Zero(), grid.cells, [&](const Cell& c) {
    if (once.solid(c)) {
      ASSERT_EQ(twice.tissue(c), 1) << c.transpose();
    }
  });
  const std::vector<TissueSurface> nested{{outer, "a", 0}, {ball(1.5e-3f), "b", 1}};
  const VoxelModel model = voxelise_surfaces(nested, grid, fractions());
  test::expect_same_levels(once, model);
  // A voxel is of what its centre is in.
  const VoxelModel labels = voxelise_surfaces(nested, grid, binary(fractions()));
  for_each_cell(Cell::Zero(), grid.cells, [&](const Cell& c) {
    if (model.solid(c)) {
      ASSERT_EQ(model.tissue(c), labels.solid(c) ? labels.tissue(c) : 0) << c.transpose();
    }
  });
}

TEST(MeshCoverageOfSurfaces, OnesThatMeetLeaveNoGap) {
  // They meet within a layer of voxels, a third to two thirds, all aslant.
  TriangleMesh below, above;
  const TriangleMesh half = box_mesh({16e-4f, 16e-4f, 8e-4f});
  add(below, half, {0, 0, -4.2e-4f}, false);
  add(above, half, {0, 0, 3.8e-4f}, false);
  TriangleMesh both;
  add(both, box_mesh({16e-4f, 16e-4f, 16e-4f}), {0, 0, -0.2e-4f}, false);
  const VoxelGrid grid = grid_of(48, 1e-4);
  const VoxelModel model = voxelise_surfaces(
      std::vector<TissueSurface>{{below, "below", 0}, {above, "above", 1}}, grid, oblique());
  const VoxelModel whole = voxelise_mesh(both, grid, oblique());
  int wrong = 0, compared = 0;
  for_each_cell(Cell::Zero(), grid.cells, [&](const Cell& c) {
    if (whole.level(c) != kFullLevel) return;
    ++compared;
    wrong += model.level(c) < kFullLevel - 1 ? 1 : 0;
  });
  EXPECT_EQ(wrong, 0) << "of " << compared;
  EXPECT_NEAR(test::filled_voxels_of(model) / (16.0 * 16.0 * 16.0), 1.0, 1e-3);
}

TEST(MeshCoverageOfSurfaces, DoNotDependOnThreads) {
  const std::vector<TissueSurface> surfaces{{ball(2e-3f), "a", 0},
                                            {punched(ball(1.9e-3f), 50), "b", 1}};
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return voxelise_surfaces(surfaces, grid_of(64, 8e-5), oblique());
  };
  const VoxelModel one = with_threads(1), four = with_threads(4);
  test::expect_same_levels(one, four);
  for_each_cell(Cell::Zero(), one.grid.cells,
                [&](const Cell& c) { ASSERT_EQ(one.tissue(c), four.tissue(c)); });
}

}  // namespace
}  // namespace sulcus::mesh_coverage_test
