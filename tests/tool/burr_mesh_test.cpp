#include "engine/tool/burr_mesh.hpp"

#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace sulcus::burr_mesh_test {
namespace {

constexpr BurrShape kShapes[] = {BurrShape::kRound, BurrShape::kPear, BurrShape::kFissure,
                                 BurrShape::kInvertedCone, BurrShape::kFlame};

BurrProfile profile_of(BurrShape shape) {
  BurrSettings settings;
  settings.shape = shape;
  return make_burr_profile(settings);
}

double volume(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Eigen::Vector3d a = mesh.positions[i].cast<double>();
    sum += a.dot(mesh.positions[j].cast<double>().cross(mesh.positions[k].cast<double>())) / 6.0;
  }
  return sum;
}

TEST(BurrMesh, IsClosedAndOutwardWithTheProfilesVolume) {
  for (const BurrShape shape : kShapes) {
    const BurrProfile profile = profile_of(shape);
    const TriangleMesh mesh = revolve(profile);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& [i, j, k] : mesh.triangles) {
      ++edges[{i, j}];
      ++edges[{j, k}];
      ++edges[{k, i}];
    }
    for (const auto& [edge, count] : edges) {
      ASSERT_EQ(count, 1);
      ASSERT_TRUE(edges.contains({edge.second, edge.first})) << "an open edge";
    }
    // Chords lie inside: a little less than the profile's volume, never more.
    EXPECT_LT(volume(mesh), profile.volume_m3());
    EXPECT_NEAR(volume(mesh) / profile.volume_m3(), 1.0, 3e-3);
  }
}

TEST(BurrMesh, HugsTheProfile) {
  for (const BurrShape shape : kShapes) {
    const BurrProfile profile = profile_of(shape);
    const TriangleMesh mesh = revolve(profile);
    const auto distance = [&profile](const Eigen::Vector3f& p) {
      return profile.distance(std::hypot(p.x(), p.z()), p.y());
    };
    for (const Eigen::Vector3f& p : mesh.positions) EXPECT_NEAR(distance(p), 0.0, 1e-9);
    for (const auto& [i, j, k] : mesh.triangles) {
      const Eigen::Vector3f middle =
          (mesh.positions[i] + mesh.positions[j] + mesh.positions[k]) / 3.0f;
      EXPECT_LT(std::abs(distance(middle)), 2.0 * 6e-4 * profile.max_radius_m());
    }
  }
}

TEST(BurrMesh, FileAxisZBecomesToolAxisY) {
  TriangleMesh file;
  file.positions = {{10, 20, 5}, {12, 20, 5}, {11, 24, 5}, {11, 21, 15}};
  file.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  ASSERT_GT(volume(file), 0.0);
  const TriangleMesh tool = tool_from_file(file);
  EXPECT_EQ(tool.positions[0], Eigen::Vector3f(-1, 0, 2));
  EXPECT_EQ(tool.positions[2], Eigen::Vector3f(0, 0, -2));
  EXPECT_EQ(tool.positions[3], Eigen::Vector3f(0, 10, 1));
  EXPECT_EQ(tool.triangles, file.triangles);
  EXPECT_NEAR(volume(tool), volume(file), 1e-4) << "handedness is kept";
  EXPECT_TRUE(tool_from_file({}).positions.empty());
}

}  // namespace
}  // namespace sulcus::burr_mesh_test
