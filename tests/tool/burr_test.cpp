#include "engine/tool/burr.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/tool/burr_mesh.hpp"

namespace sulcus::burr_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr BurrShape kShapes[] = {BurrShape::kRound, BurrShape::kPear, BurrShape::kFissure,
                                 BurrShape::kInvertedCone, BurrShape::kFlame};
constexpr double kVoxel = 34.8e-6;

BurrSettings small_settings(BurrShape shape) {
  BurrSettings settings;
  settings.shape = shape;
  settings.field_samples = Vector3i(32, 128, 32);
  return settings;
}

double outside(const Capsule& capsule, const Vector3d& p) {
  const double y = std::clamp(p.y(), capsule.a_tool.y(), capsule.b_tool.y());
  return (p - Vector3d(0, y, 0)).norm() - capsule.radius_m;
}

std::string error_of(BurrSettings settings, const TriangleMesh& mesh) {
  settings.file = "burr.stl";
  try {
    make_burr(settings, kVoxel, mesh, "scene.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Burr, CapsuleHoldsAllOfIt) {
  for (const BurrShape shape : kShapes) {
    const Burr burr = make_burr(small_settings(shape), kVoxel);
    for (const Vector3f& p : burr.mesh_tool.positions) {
      EXPECT_LE(outside(burr.capsule, p.cast<double>()), 0.0);
    }
    const Vector3i n = burr.field.samples();
    for (int k = 0; k < n.z(); ++k) {
      for (int j = 0; j < n.y(); ++j) {
        for (int i = 0; i < n.x(); ++i) {
          if (burr.field.at(i, j, k) > 0.0f) continue;
          const Vector3d p = burr.field.grid().tool_from_field(Vector3d(i, j, k));
          EXPECT_LE(outside(burr.capsule, p), 0.0);
        }
      }
    }
  }
}

TEST(Burr, CapsuleIsTight) {
  const Capsule round = make_burr(small_settings(BurrShape::kRound), kVoxel).capsule;
  EXPECT_LT(round.radius_m, 0.5 * kShankDiameter + 0.1e-3);
  EXPECT_GT(round.a_tool.y(), 0.7e-3) << "the head needs no more";

  TriangleMesh flat;  // wider than long: a sphere
  flat.positions = {{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  const Capsule sphere = axial_capsule(flat);
  EXPECT_EQ(sphere.a_tool, sphere.b_tool);
  EXPECT_DOUBLE_EQ(sphere.radius_m, 1.0);
  for (const Vector3f& p : flat.positions) EXPECT_LE(outside(sphere, p.cast<double>()), 1e-12);
}

TEST(Burr, TakesItsSettings) {
  BurrSettings settings = small_settings(BurrShape::kPear);
  settings.diameter_m = 1.2e-3;
  settings.length_m = 2.1e-3;
  settings.reference_m = 33e-3;
  settings.speed_rad_per_s = 500.0;
  settings.tangential_ratio = 0.2;
  const Burr burr = make_burr(settings, kVoxel);
  EXPECT_DOUBLE_EQ(burr.head_length_m, 2.1e-3);
  EXPECT_EQ(burr.reference_m, 33e-3);
  EXPECT_EQ(burr.speed_rad_per_s, 500.0);
  EXPECT_EQ(burr.tangential_ratio, 0.2);
  EXPECT_EQ(burr.field.samples(), Vector3i(32, 128, 32));
}

TEST(Burr, FieldVanishesOnTheMesh) {
  for (const BurrShape shape : kShapes) {
    const Burr burr = make_burr(small_settings(shape), kVoxel);
    for (const Vector3f& p : burr.mesh_tool.positions) {
      const Vector3f p_field = burr.field.field_from_tool(p.cast<double>()).cast<float>();
      EXPECT_LT(std::abs(burr.field.sample(p_field)), 0.5 * burr.field.spacing_m());
    }
  }
}

TEST(Burr, FromItsOwnMeshIsTheSame) {
  const BurrSettings settings = small_settings(BurrShape::kRound);
  const Burr generated = make_burr(settings, kVoxel);
  TriangleMesh inward = generated.mesh_tool;
  for (auto& t : inward.triangles) std::swap(t[0], t[1]);
  for (const TriangleMesh& mesh : {generated.mesh_tool, inward}) {
    const Burr burr = make_burr(settings, kVoxel, mesh);
    EXPECT_NEAR(burr.field.spacing_m(), generated.field.spacing_m(), 1e-10);
    EXPECT_DOUBLE_EQ(burr.head_length_m, 6.4e-3f) << "all of it cuts";
    const Vector3f centre = burr.field.field_from_tool(Vector3d(0, 0.7e-3, 0)).cast<float>();
    EXPECT_NEAR(burr.field.sample(centre), generated.field.sample(centre),
                0.5 * burr.field.spacing_m());
    // Outward, whichever way the file had it.
    const auto& [i, j, k] = burr.mesh_tool.triangles.front();
    const Vector3f normal = (burr.mesh_tool.positions[j] - burr.mesh_tool.positions[i])
                                .cross(burr.mesh_tool.positions[k] - burr.mesh_tool.positions[i]);
    EXPECT_LT(normal.y(), 0.0f) << "the first triangle is at the tip";
  }
}

TEST(Burr, LengthSaysHowMuchOfAMeshCuts) {
  BurrSettings settings = small_settings(BurrShape::kFile);
  settings.length_m = 1.3e-3;
  const TriangleMesh mesh = make_burr(small_settings(BurrShape::kRound), kVoxel).mesh_tool;
  EXPECT_DOUBLE_EQ(make_burr(settings, kVoxel, mesh).head_length_m, 1.3e-3);
}

TEST(Burr, RefusesMeshesThatAreNoBurr) {
  const BurrSettings settings = small_settings(BurrShape::kFile);
  EXPECT_NE(error_of(settings, {}).find("burr.stl: mesh: found no triangles"), std::string::npos);

  TriangleMesh mesh = make_burr(small_settings(BurrShape::kRound), kVoxel).mesh_tool;
  TriangleMesh large = mesh;
  for (Vector3f& p : large.positions) p *= 1000.0f;  // metres taken for millimetres
  EXPECT_NE(error_of(settings, large).find("burr.stl: mesh: found a burr of 1600 x 1600 x 6400 mm"),
            std::string::npos);

  BurrSettings fine = settings;
  fine.field_spacing_m = 5e-6;
  EXPECT_NE(error_of(fine, mesh).find("scene.toml: burr.field_spacing_mm: found a box of"),
            std::string::npos);

  mesh.triangles.resize(mesh.triangles.size() / 2);
  EXPECT_NE(error_of(settings, mesh).find("expected a closed surface"), std::string::npos);
}

}  // namespace
}  // namespace sulcus::burr_test
