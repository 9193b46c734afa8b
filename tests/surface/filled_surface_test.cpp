// The surface of a solid with fractions, exported and drawn, against shapes in closed form.

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/units.hpp"
#include "engine/shapes/basic_shapes.hpp"
#include "engine/shapes/molar.hpp"
#include "engine/shapes/voxelise_implicit.hpp"
#include "engine/surface/drawn_surface.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/surface_distance.hpp"

namespace sulcus::filled_surface_test {
namespace {

using Eigen::Vector3d;
using test::Distances;

constexpr double kVoxel = 1e-4;
const std::vector<TissueLook> kLooks{{"outer", {0.81f, 0.64f, 0.36f}}, {"inner", {0.5f, 0, 0}}};

Pose aslant() {
  return {Vector3d(3e-5, -2e-5, 1e-5),
          Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vector3d(1.0, 2.0, -1.0).normalized()))};
}

/// A shape at a place, and how far a mesh of it is from it, but where the grid ends.
template <class S>
struct Placed {
  S shape;
  Pose world_from_shape;
  VoxelGrid grid;

  VoxelModel model(SurfaceKind surface) const {
    return voxelise_implicit(shape, grid, nullptr, world_from_shape, surface);
  }
  Vector3d outward(const Vector3d& p_world) const {
    return world_from_shape.orientation * shape.gradient(world_from_shape.inverse_point(p_world));
  }
  /// To the nearest point of the surface, by Newton's steps: `value` need be no distance.
  double distance(const Vector3d& p_world) const {
    const double end = 0.5 * grid.voxel_m * grid.cells.x() - 5.0 * grid.voxel_m;
    if (p_world.cwiseAbs().maxCoeff() > end) return std::numeric_limits<double>::quiet_NaN();
    const Vector3d p = world_from_shape.inverse_point(p_world);
    Vector3d on = p;
    for (int step = 0; step < 3; ++step) {
      const Vector3d gradient = shape.gradient(on);
      on -= shape.value(on) / gradient.squaredNorm() * gradient;
    }
    return std::copysign((p - on).norm(), shape.value(p));
  }
  /// In voxels.
  Distances of(const TriangleMesh& mesh) const {
    Distances d = test::distances(
        mesh, [&](const Vector3d& p) { return distance(p); },
        [&](const Vector3d& p) { return outward(p); });
    for (double* value : {&d.vertices_rms, &d.inside_rms, &d.most}) *value /= grid.voxel_m;
    return d;
  }
};

VoxelGrid cube_of(int cells, double voxel_m = kVoxel) { return {{cells, cells, cells}, voxel_m}; }
Placed<SphereShape> ball(double radius = 50.0, int cells = 128) {
  return {SphereShape(radius * kVoxel), aslant(), cube_of(cells)};
}
Placed<PlateShape> plate(double tilt_deg, double thickness = 40.0) {
  return {PlateShape(thickness * kVoxel, tilt_deg * kDegree), {}, cube_of(96)};
}
Placed<TorusShape> ring() {
  return {TorusShape(40.0 * kVoxel, 15.0 * kVoxel), aslant(), cube_of(128)};
}
Placed<Molar> tooth() { return {Molar(), {}, cube_of(256, 0.0696e-3)}; }

template <class S>
void expect_exported_where_it_is(const Placed<S>& body, double most) {
  const TriangleMesh mesh = closed_surface(body.model(SurfaceKind::kFractions));
  EXPECT_EQ(test::open_edges(mesh), 0u);
  const Distances d = body.of(mesh);
  EXPECT_GT(d.vertices, 2000u);
  EXPECT_LT(d.vertices_rms, 0.01);
  EXPECT_LT(d.inside_rms, 0.015);
  EXPECT_LT(d.most, most);
  EXPECT_EQ(d.turned, 0u);
  // What is won.
  const Distances binary = body.of(closed_surface(body.model(SurfaceKind::kBinary)));
  EXPECT_GT(binary.vertices_rms, 5.0 * d.vertices_rms);
}

TEST(FilledSurface, AnExportedMeshLiesWhereTheSolidEnds) {
  expect_exported_where_it_is(ball(), 0.03);
  expect_exported_where_it_is(ball(12.0, 48), 0.1);
  for (const double tilt_deg : {0.0, 0.5, 1.0, 7.0, 30.0, 45.0}) {
    expect_exported_where_it_is(plate(tilt_deg), 0.01);
  }
  expect_exported_where_it_is(ring(), 0.1);
}

TEST(FilledSurface, TheMolarToo) {
  // In its fissures the walls meet in an edge.
  expect_exported_where_it_is(tooth(), 1.0);
}

template <class S>
void expect_drawn_where_it_is(const Placed<S>& body, const VoxelModel& model, int cell_voxels,
                              double inside_rms, double most) {
  const DrawnSurface surface(model, kLooks, cell_voxels);
  const std::vector<DrawnMesh> bricks = test::all_bricks(surface);
  const TriangleMesh mesh = test::joined(bricks);
  EXPECT_EQ(test::open_edges(mesh), 0u);
  const Distances d = body.of(mesh);
  EXPECT_GT(d.vertices, 1000u);
  EXPECT_LT(d.vertices_rms, 0.03);
  EXPECT_LT(d.inside_rms, inside_rms);
  EXPECT_LT(d.most, most);
  EXPECT_LE(d.turned, mesh.triangles.size() / 10000);
  for (const DrawnMesh& brick : bricks) {
    for (const DrawnVertex& v : brick.vertices) {
      const Vector3d p(v.position_m[0], v.position_m[1], v.position_m[2]);
      if (std::isnan(body.distance(p))) continue;
      ASSERT_GT(Vector3d(v.normal[0], v.normal[1], v.normal[2]).dot(body.outward(p)), 0.0);
    }
  }
}

TEST(FilledSurface, PicturesShowItWhereItIs) {
  const auto expect = [](const auto& body, double inside_rms, std::array<double, 2> most) {
    const VoxelModel model = body.model(SurfaceKind::kFractions);
    for (const int cell_voxels : {1, 2}) {
      SCOPED_TRACE(cell_voxels);
      expect_drawn_where_it_is(body, model, cell_voxels, inside_rms,
                               most[static_cast<std::size_t>(cell_voxels - 1)]);
    }
  };
  expect(ball(), 0.03, {0.05, 0.05});
  expect(plate(0.5), 0.01, {0.02, 0.02});
  expect(plate(30.0), 0.01, {0.02, 0.02});
  expect(ring(), 0.03, {0.2, 0.2});
  expect(tooth(), 0.03, {1.2, 2.0});
}

TEST(FilledSurface, DrawnNormalsShowNoTerraces) {
  for (const double tilt_deg : {0.5, 1.0, 3.0}) {
    const Placed<PlateShape> body = plate(tilt_deg);
    const DrawnSurface surface(body.model(SurfaceKind::kFractions), kLooks, 1);
    double most_deg = 0.0;
    for (const DrawnMesh& brick : test::all_bricks(surface)) {
      for (const DrawnVertex& v : brick.vertices) {
        const Vector3d p(v.position_m[0], v.position_m[1], v.position_m[2]);
        if (p.cwiseAbs().maxCoeff() > 30.0 * kVoxel) continue;  // where the grid ends
        const Vector3d normal(v.normal[0], v.normal[1], v.normal[2]);
        most_deg = std::max(most_deg, test::angle_deg(normal, body.outward(p)));
      }
    }
    EXPECT_LT(most_deg, 0.3) << tilt_deg;
  }
}

TEST(FilledSurface, WallsOfAVoxelOrTwoKeepTheirThickness) {
  for (const double thickness : {1.2, 1.7, 2.6, 3.4}) {
    for (const double tilt_deg : {0.0, 2.0, 20.0}) {
      SCOPED_TRACE(std::to_string(thickness) + " at " + std::to_string(tilt_deg));
      const Placed<PlateShape> body = plate(tilt_deg, thickness);
      const TriangleMesh mesh = closed_surface(body.model(SurfaceKind::kFractions));
      EXPECT_EQ(test::open_edges(mesh), 0u);
      const Distances d = body.of(mesh);
      EXPECT_GT(d.vertices, 5000u);
      EXPECT_LT(d.vertices_rms, 0.15);
      EXPECT_LT(d.most, 0.6);
    }
  }
}

TEST(FilledSurface, AnyLevelsGiveAClosedMesh) {
  for (const double share : {0.3, 0.7}) {
    std::mt19937 random(5);
    std::bernoulli_distribution solid(share);
    VoxelModel model =
        test::make_model({24, 16, 72}, kVoxel, [&](const Cell&) { return solid(random); });
    model.fills.emplace(model.grid.leaf_count(), std::vector<LeafLevels>{});
    model.fills->reserve(model.grid.leaf_count());
    for (const Cell& c : test::solid_cells(model)) {
      model.set_level(c, static_cast<FillLevel>(1 + random() % 255));
    }
    const TriangleMesh mesh = closed_surface(model);
    EXPECT_GT(mesh.triangles.size(), 1000u);
    EXPECT_EQ(test::open_edges(mesh), 0u);
    const Vector3d half = 0.5 * kVoxel * model.grid.cells.cast<double>();
    for (const Eigen::Vector3f& p : mesh.positions) {
      EXPECT_TRUE((p.cast<double>().cwiseAbs().array() < half.array() + kVoxel).all());
    }
    EXPECT_EQ(test::open_edges(test::joined(test::all_bricks(DrawnSurface(model, kLooks, 1)))), 0u);
  }
}

TEST(FilledSurface, TissuesFillWhatIsWithinItTogether) {
  const Placed<SphereShape> body = ball(26.3, 64);
  VoxelModel model = body.model(SurfaceKind::kFractions);
  const auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LabelBlock labels{};
    for (int place = 0; place < 512; ++place) {
      const Cell c = model.grid.leaf_origin(leaf) + cell_in_leaf(place);
      labels[static_cast<std::size_t>(place)] = c.x() + c.y() < 70 ? 1 : 0;
    }
    tissues->set_block(leaf, labels, model.leaves[leaf]);
  }
  model.tissues = tissues;
  const std::vector<TriangleMesh> meshes = tissue_surfaces(model, 2);
  double sum = 0.0, outside = 0.0;
  for (const TriangleMesh& mesh : meshes) {
    EXPECT_EQ(test::open_edges(mesh), 0u);
    EXPECT_GT(mesh.triangles.size(), 1000u);
    for (const auto& t : mesh.triangles) {
      const Vector3d a = mesh.positions[t[0]].cast<double>();
      const Vector3d b = mesh.positions[t[1]].cast<double>();
      const Vector3d c = mesh.positions[t[2]].cast<double>();
      sum += a.dot(b.cross(c)) / 6.0;
    }
    for (const Eigen::Vector3f& p : mesh.positions) {
      outside = std::max(outside, body.distance(p.cast<double>()));
    }
  }
  EXPECT_LT(outside, 0.05 * kVoxel);
  const double whole = 4.0 / 3.0 * std::numbers::pi * std::pow(26.3 * kVoxel, 3);
  EXPECT_NEAR(sum / whole, 1.0, 0.001);
}

}  // namespace
}  // namespace sulcus::filled_surface_test
