#include "tools/sulcus_lab/truth/truth_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus::lab::truth_shapes_test {
namespace {

using Eigen::Vector3d;

TruthShape single(std::string_view name) {
  std::vector<TruthShape> shapes = truth_shapes(name);
  EXPECT_EQ(shapes.size(), 1u);
  return std::move(shapes.front());
}

TEST(TruthShapes, TheSphereIsThePapers) {
  const TruthShape sphere = single("sphere");
  // The paper counts 108,760, which no centre gives.
  EXPECT_EQ(sphere.voxels.size(), 108768u);
  EXPECT_TRUE(sphere.zones.empty());
  for (std::size_t v = 0; v < sphere.voxels.size(); v += 97) {
    const TruthVoxel& voxel = sphere.voxels[v];
    const Vector3d outward = voxel.cell.cast<double>() - Vector3d::Constant(127.5);
    EXPECT_LT((voxel.normal - outward.normalized()).norm(), 1e-12);
  }
}

TEST(TruthShapes, TruthIsOfSurfaceVoxelsWithUnitNormalsOutOfTheSolid) {
  for (const char* name : {"torus", "cone", "drilled_ellipsoid", "gyroid", "tetrahedron",
                           "dodecahedron", "hyperboloid", "quartic"}) {
    const TruthShape shape = single(name);
    EXPECT_EQ(shape.name, name);
    ASSERT_GT(shape.voxels.size(), 10000u) << name;
    const Workpiece workpiece{VoxelModel(shape.model)};
    std::size_t blocked = 0, seen = 0;
    for (std::size_t v = 0; v < shape.voxels.size(); v += 31) {
      const TruthVoxel& voxel = shape.voxels[v];
      EXPECT_TRUE(workpiece.is_surface(voxel.cell)) << name;
      EXPECT_NEAR(voxel.normal.norm(), 1.0, 1e-12) << name;
      const Vector3d outside = voxel.cell.cast<double>() + 2.5 * voxel.normal;
      ++seen;
      blocked += workpiece.solid(outside.array().round().cast<int>());
    }
    EXPECT_EQ(blocked, 0u) << name << ", of " << seen;
  }
}

TEST(TruthShapes, TruthPointsAwayFromTheSolidsOwnCentreOfMass) {
  // The second way: in a ball of 6 voxels, away from edges, the solid lies on the other side.
  constexpr int kReach = 6;
  for (const char* name : {"torus", "cone", "drilled_ellipsoid", "gyroid", "tetrahedron",
                           "dodecahedron", "hyperboloid", "quartic"}) {
    const TruthShape shape = single(name);
    double sum_deg = 0.0;
    int count = 0;
    for (std::size_t v = 0; v < shape.voxels.size(); v += 211) {
      const TruthVoxel& voxel = shape.voxels[v];
      if (voxel.zone != 0) continue;
      Cell sum = Cell::Zero();
      for (int n = 0; n < 13 * 13 * 13; ++n) {
        const Cell d(n % 13 - kReach, n / 13 % 13 - kReach, n / 169 - kReach);
        if (d.squaredNorm() <= kReach * kReach && shape.model.solid(voxel.cell + d)) sum += d;
      }
      const Vector3d away = -sum.cast<double>().normalized();
      sum_deg += std::acos(std::clamp(away.dot(voxel.normal), -1.0, 1.0)) * 180.0 / M_PI;
      ++count;
    }
    ASSERT_GT(count, 20) << name;
    EXPECT_LT(sum_deg / count, 5.0) << name;
  }
}

TEST(TruthShapes, RoughBallsAreAsRoughAsTheySay) {
  const std::vector<TruthShape> balls = truth_shapes("rough");
  ASSERT_EQ(balls.size(), 2u);
  for (const auto& [ball, roughness] : {std::pair(&balls[0], 0.4), std::pair(&balls[1], 0.7)}) {
    ASSERT_GT(ball->voxels.size(), 20000u);
    const Vector3d centre = Vector3d(0.13, -0.29, 0.37).array() + 55.5;
    int strays = 0;  // within the shell that noise reaches, on the wrong side
    for (std::uint32_t v = 0; v < ball->model.grid.cell_count(); ++v) {
      const Cell c = ball->model.grid.cell_of_linear(v);
      const double out = (c.cast<double>() - centre).norm() - 48.0;
      if (ball->model.solid(c) == (out <= 0.0)) continue;
      ASSERT_LE(std::abs(out), roughness);
      ++strays;
    }
    // A quarter of the shell's volume: even noise passes a distance d with (1 - d / roughness) / 2.
    const double shell = 4.0 * M_PI * 48.0 * 48.0 * 2.0 * roughness;
    EXPECT_NEAR(strays, 0.25 * shell, 0.03 * shell);
    for (const TruthVoxel& voxel : ball->voxels) {
      const Vector3d out = voxel.cell.cast<double>() - centre;
      ASSERT_NEAR(out.norm(), 48.0, 2.0 + roughness);
      ASSERT_LT((voxel.normal - out.normalized()).norm(), 1e-12);
    }
  }
}

TEST(TruthShapes, FacesOfSolidsMeetAtTheirAngles) {
  struct Solid {
    const char* name;
    std::size_t faces;
    double least_deg;  // between the normals of two faces
  };
  for (const Solid& solid :
       {Solid{"tetrahedron", 4, 180.0 - 70.5288}, Solid{"dodecahedron", 12, 180.0 - 116.5651}}) {
    const TruthShape shape = single(solid.name);
    std::vector<Vector3d> normals;
    double least_deg = 180.0;
    for (const TruthVoxel& voxel : shape.voxels) {
      bool is_new = true;
      for (const Vector3d& normal : normals) {
        if ((normal - voxel.normal).norm() < 1e-9) is_new = false;
      }
      if (!is_new) continue;
      for (const Vector3d& normal : normals) {
        least_deg = std::min(least_deg, std::acos(normal.dot(voxel.normal)) * 180.0 / M_PI);
      }
      normals.push_back(voxel.normal);
    }
    EXPECT_EQ(normals.size(), solid.faces) << solid.name;
    EXPECT_NEAR(least_deg, solid.least_deg, 1e-3) << solid.name;
  }
}

TEST(TruthShapes, ZonesFollowTheDistanceFromTheEdges) {
  const std::vector<TruthShape> cubes = truth_shapes("rotated_cube");
  ASSERT_EQ(cubes.size(), 3u);
  const TruthShape& cube = cubes.front();
  EXPECT_EQ(cube.zones, (std::vector<std::string>{"face", "near", "edge"}));
  std::array<double, 3> count{};
  for (const TruthVoxel& voxel : cube.voxels) ++count.at(voxel.zone);
  // Faces of 110 less 10 at each side; bands of 8 and of 2 around them. A voxel of the surface
  // stands for an area that depends on the tilt, so shares are compared.
  const double all = static_cast<double>(cube.voxels.size());
  EXPECT_NEAR(count[0] / all, 90.0 * 90.0 / (110.0 * 110.0), 0.02);
  EXPECT_NEAR(count[1] / all, (106.0 * 106.0 - 90.0 * 90.0) / (110.0 * 110.0), 0.02);
  EXPECT_NEAR(count[2] / all, (110.0 * 110.0 - 106.0 * 106.0) / (110.0 * 110.0), 0.02);
  // Six directions, each with a sixth of the voxels or so.
  std::vector<Vector3d> directions;
  for (const TruthVoxel& voxel : cube.voxels) {
    if (std::none_of(directions.begin(), directions.end(),
                     [&](const Vector3d& d) { return (d - voxel.normal).norm() < 1e-9; })) {
      directions.push_back(voxel.normal);
    }
  }
  EXPECT_EQ(directions.size(), 6u);
}

TEST(TruthShapes, TheCutToothIsTheToothOutsideTheCut) {
  const TruthShape tooth = single("molar"), cut = single("molar_cut");
  EXPECT_EQ(cut.zones, (std::vector<std::string>{"tooth", "cut", "near", "edge"}));
  EXPECT_LT(cut.model.solid_count(), tooth.model.solid_count());
  std::array<std::size_t, 4> count{};
  for (const TruthVoxel& voxel : cut.voxels) {
    ++count.at(voxel.zone);
    EXPECT_TRUE(tooth.model.solid(voxel.cell));
  }
  for (const std::size_t n : count) EXPECT_GT(n, 500u);
  // The deepest of the cut looks up.
  const auto lowest = std::min_element(cut.voxels.begin(), cut.voxels.end(),
                                       [](const TruthVoxel& a, const TruthVoxel& b) {
                                         const auto height = [](const TruthVoxel& v) {
                                           return v.zone == 1 ? v.cell.z() : kMaxCellsPerAxis;
                                         };
                                         return height(a) < height(b);
                                       });
  EXPECT_GT(lowest->normal.z(), 0.9);
}

TEST(TruthShapes, PlatesHaveAToolAndLookItsWay) {
  const std::vector<TruthShape> plates = truth_shapes("plate");
  std::set<std::string> zones;
  for (const TruthShape& plate : plates) {
    ASSERT_EQ(plate.zones.size(), 1u);
    zones.insert(plate.zones.front());
    ASSERT_TRUE(plate.tool_direction);
    EXPECT_EQ(*plate.tool_direction, Vector3d(0, 0, 1));
    EXPECT_EQ(plate.either_sign, plate.zones.front() == "plate_1");
    for (const TruthVoxel& voxel : plate.voxels) {
      EXPECT_GE(voxel.normal.z(), 0.0);
    }
  }
  EXPECT_EQ(zones, (std::set<std::string>{"plate_1", "plate_1.5", "plate_2", "plate_3"}));
}

TEST(TruthShapes, AnUnknownNameIsRefused) { EXPECT_THROW(truth_shapes("teapot"), InputError); }

}  // namespace
}  // namespace sulcus::lab::truth_shapes_test
