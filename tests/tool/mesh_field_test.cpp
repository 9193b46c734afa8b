#include "engine/tool/mesh_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/core/error.hpp"
#include "engine/tool/burr_mesh.hpp"

namespace sulcus::mesh_field_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr BurrShape kShapes[] = {BurrShape::kRound, BurrShape::kPear, BurrShape::kFissure,
                                 BurrShape::kInvertedCone, BurrShape::kFlame};

BurrProfile profile_of(BurrShape shape) {
  BurrSettings settings;
  settings.shape = shape;
  return make_burr_profile(settings);
}

FieldGrid grid_of(const TriangleMesh& mesh, const Vector3i& samples) {
  Eigen::AlignedBox3d bounds;
  for (const Vector3f& p : mesh.positions) bounds.extend(p.cast<double>());
  BurrSettings settings;
  settings.field_samples = samples;
  return plan_field(settings, bounds, bounds.sizes().x(), 35e-6);
}

/// A box, 12 triangles, from `low` to `high`, outward.
void append_box(TriangleMesh& mesh, const Vector3f& low, const Vector3f& high) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.emplace_back(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(),
                                corner & 4 ? high.z() : low.z());
  }
  constexpr std::array<std::array<std::uint32_t, 3>, 12> kFaces{{{0, 2, 1},
                                                                 {1, 2, 3},
                                                                 {4, 5, 6},
                                                                 {5, 7, 6},
                                                                 {0, 1, 4},
                                                                 {1, 5, 4},
                                                                 {2, 6, 3},
                                                                 {3, 6, 7},
                                                                 {0, 4, 2},
                                                                 {2, 4, 6},
                                                                 {1, 3, 5},
                                                                 {3, 7, 5}}};
  for (const auto& f : kFaces) mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
}

double box_distance(const Vector3d& p, const Vector3d& low, const Vector3d& high) {
  const Vector3d q = (p - 0.5 * (low + high)).cwiseAbs() - 0.5 * (high - low);
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

std::string error_of(const TriangleMesh& mesh, const FieldGrid& grid) {
  try {
    field_from_mesh(mesh, grid, "burr.stl");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(MeshField, IsThatOfTheProfileAndVanishesOnTheVertices) {
  for (const BurrShape shape : kShapes) {
    const BurrProfile profile = profile_of(shape);
    const TriangleMesh mesh = revolve(profile);
    const FieldGrid grid = grid_of(mesh, {24, 96, 24});
    const DistanceField truth = field_from_profile(profile, grid);
    const DistanceField field = field_from_mesh(mesh, grid);
    const double h = grid.spacing_m, sag = 2 * 6e-4 * profile.max_radius_m();
    double near = 0.0, far = 0.0;
    for (int k = 0; k < 24; ++k) {
      for (int j = 0; j < 96; ++j) {
        for (int i = 0; i < 24; ++i) {
          const double difference = std::abs(field.at(i, j, k) - truth.at(i, j, k));
          double& worst = std::abs(truth.at(i, j, k)) < 2.5 * h ? near : far;
          worst = std::max(worst, difference);
        }
      }
    }
    EXPECT_LT(near, sag);
    EXPECT_LT(far, 0.5 * h);
    for (const Vector3f& p : mesh.positions) {
      EXPECT_LT(std::abs(field.sample(field.field_from_tool(p.cast<double>()).cast<float>())),
                0.5 * h);
    }
  }
}

TEST(MeshField, OfABoxIsExactFarFromItToo) {
  TriangleMesh mesh;
  append_box(mesh, {-0.5e-3f, 0.0f, -0.4e-3f}, {0.5e-3f, 1.7e-3f, 0.4e-3f});
  FieldGrid grid = grid_of(mesh, {40, 48, 36});
  grid.spacing_m *= 2.0;  // much empty space around
  grid.origin_tool *= 2.0;
  const DistanceField field = field_from_mesh(mesh, grid);
  for (int k = 0; k < 36; ++k) {
    for (int j = 0; j < 48; ++j) {
      for (int i = 0; i < 40; ++i) {
        const Vector3d p = grid.tool_from_field(Vector3d(i, j, k));
        ASSERT_NEAR(
            field.at(i, j, k),
            box_distance(p, mesh.positions[0].cast<double>(), mesh.positions[7].cast<double>()),
            0.02 * grid.spacing_m);
      }
    }
  }
}

TEST(MeshField, OverlappingPartsAreOneSolid) {
  TriangleMesh mesh;
  append_box(mesh, {-0.5e-3f, 0.0f, -0.5e-3f}, {0.5e-3f, 1.2e-3f, 0.5e-3f});
  append_box(mesh, {-0.3e-3f, 0.8e-3f, -0.3e-3f}, {0.3e-3f, 2.0e-3f, 0.3e-3f});
  const DistanceField field = field_from_mesh(mesh, grid_of(mesh, {32, 64, 32}));
  for (const double y : {0.2e-3, 0.9e-3, 1.1e-3, 1.9e-3}) {
    EXPECT_LT(field.sample(field.field_from_tool(Vector3d(0.1e-3, y, 0.1e-3)).cast<float>()), 0.0f)
        << y;
  }
  EXPECT_GT(field.sample(field.field_from_tool(Vector3d(0.4e-3, 1.6e-3, 0)).cast<float>()), 0.0f);
}

TEST(MeshField, MixedOrientationIsSortedOutByParity) {
  TriangleMesh mesh = revolve(profile_of(BurrShape::kRound));
  const FieldGrid grid = grid_of(mesh, {24, 96, 24});
  const DistanceField truth = field_from_mesh(mesh, grid);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
    std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  }
  const DistanceField field = field_from_mesh(mesh, grid);
  int different = 0;
  for (std::size_t s = 0; s < field.values().size(); ++s) {
    different += field.values()[s] != truth.values()[s];
  }
  EXPECT_EQ(different, 0);
}

TEST(MeshField, OneMissingTriangleDoesNoHarm) {
  TriangleMesh mesh = revolve(profile_of(BurrShape::kRound));
  const FieldGrid grid = grid_of(mesh, {24, 96, 24});
  const DistanceField truth = field_from_mesh(mesh, grid);
  mesh.triangles.erase(mesh.triangles.begin() + 3000);
  const DistanceField field = field_from_mesh(mesh, grid);
  for (std::size_t s = 0; s < field.values().size(); ++s) {
    ASSERT_NEAR(field.values()[s], truth.values()[s], 2.0 * grid.spacing_m);
  }
}

TEST(MeshField, DoesNotDependOnThreads) {
  const TriangleMesh mesh = revolve(profile_of(BurrShape::kFlame));
  const FieldGrid grid = grid_of(mesh, {24, 96, 24});
  const DistanceField two = field_from_mesh(mesh, grid);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const DistanceField one = field_from_mesh(mesh, grid);
  EXPECT_TRUE(std::equal(one.values().begin(), one.values().end(), two.values().begin()));
}

TEST(MeshField, RefusesWhatIsNoSolid) {
  TriangleMesh box;
  append_box(box, {-0.5e-3f, 0.0f, -0.5e-3f}, {0.5e-3f, 2e-3f, 0.5e-3f});
  const FieldGrid grid = grid_of(box, {32, 64, 32});

  EXPECT_EQ(error_of({}, grid),
            "burr.stl: mesh: found no triangles, expected a closed mesh of a burr");

  TriangleMesh bad = box;
  bad.positions[5].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error_of(bad, grid),
            "burr.stl: vertex 5: found a position that is not finite, expected finite positions");

  bad = box;
  bad.triangles[3][1] = 8;
  EXPECT_EQ(error_of(bad, grid), "burr.stl: triangle 3: found vertex 8, expected less than 8");

  bad = box;
  bad.triangles.resize(6);
  EXPECT_NE(error_of(bad, grid).find("burr.stl: mesh: found holes along "), std::string::npos);

  bad = box;  // no lid: a burr cut off open at the shank
  std::erase_if(bad.triangles, [&bad](const auto& t) {
    return bad.positions[t[0]].y() > 1e-3f && bad.positions[t[1]].y() > 1e-3f &&
           bad.positions[t[2]].y() > 1e-3f;
  });
  ASSERT_EQ(bad.triangles.size(), 10u);
  EXPECT_EQ(error_of(bad, grid),
            "burr.stl: mesh: found holes along 100 % of the rays in y, expected a closed surface");

  bad = box;  // triangles without area
  for (auto& t : bad.triangles) t[2] = t[1];
  EXPECT_NE(error_of(bad, grid).find("expected a closed surface"), std::string::npos);
}

}  // namespace
}  // namespace sulcus::mesh_field_test
