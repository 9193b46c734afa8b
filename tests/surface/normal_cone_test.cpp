#include "engine/surface/normal_cone.hpp"

#include <array>
#include <random>

#include <gtest/gtest.h>

namespace sulcus::normal_cone_test {
namespace {

/// Triangles near one another, whose normals are within about `spread` of +z.
DrawnMesh scales(std::mt19937& random, float spread) {
  std::uniform_real_distribution<float> place(-1.0f, 1.0f);
  DrawnMesh mesh;
  for (int t = 0; t < 20; ++t) {
    const Eigen::Vector3f at(place(random), place(random), place(random));
    const float dx = spread * place(random), dy = spread * place(random);
    for (const std::array<float, 2>& c : {std::array{0.0f, 0.0f}, {0.1f, 0.0f}, {0.0f, 0.1f}}) {
      DrawnVertex v{};
      v.position_m = {at.x() + c[0], at.y() + c[1], at.z() + dx * c[0] + dy * c[1]};
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
      mesh.vertices.push_back(v);
    }
  }
  return mesh;
}

Eigen::Vector3f position(const DrawnMesh& mesh, std::size_t index) {
  const auto& p = mesh.vertices[mesh.indices[index]].position_m;
  return {p[0], p[1], p[2]};
}

TEST(NormalCone, WhatFacesAwayHasNoTriangleThatShows) {
  std::mt19937 random(7);
  std::normal_distribution<float> direction;
  std::uniform_real_distribution<float> distance(1.0f, 30.0f);
  int away = 0, all_hidden = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const DrawnMesh mesh = scales(random, trial % 4 == 0 ? 2.0f : 0.4f);
    Eigen::AlignedBox3f box;
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) box.extend(position(mesh, i));
    const Eigen::Vector3f eye =
        Eigen::Vector3f(direction(random), direction(random), direction(random)).normalized() *
        distance(random);
    bool shows = false;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const Eigen::Vector3f a = position(mesh, i);
      const Eigen::Vector3f n = (position(mesh, i + 1) - a).cross(position(mesh, i + 2) - a);
      shows = shows || n.dot(eye - a) > 0.0f;
    }
    const bool hidden = faces_away(normal_cone(mesh), box, eye);
    EXPECT_FALSE(hidden && shows) << "trial " << trial;
    away += hidden ? 1 : 0;
    all_hidden += shows ? 0 : 1;
  }
  // It is of use: most of what shows nothing is known to.
  EXPECT_GT(all_hidden, 800);
  EXPECT_GT(away, all_hidden / 2);
}

TEST(NormalCone, FromWithinItsBoxNothingIsSaid) {
  std::mt19937 random(7);
  const NormalCone cone = normal_cone(scales(random, 0.1f));
  const Eigen::AlignedBox3f box(Eigen::Vector3f(-1, -1, -1), Eigen::Vector3f(1, 1, 1));
  EXPECT_FALSE(faces_away(cone, box, {0.0f, 0.0f, -0.9f}));
  EXPECT_TRUE(faces_away(cone, box, {0.0f, 0.0f, -9.0f}));
  EXPECT_FALSE(faces_away(cone, box, {0.0f, 0.0f, 9.0f}));
}

TEST(NormalCone, AMeshWithoutTrianglesOrThatTurnsRoundSaysNothing) {
  EXPECT_LE(normal_cone({}).cosine, 0.0f);
  DrawnMesh both;
  std::mt19937 random(7);
  both = scales(random, 0.1f);
  const std::size_t count = both.indices.size();
  for (std::size_t i = 0; i < 3 * (count / 6); i += 3)
    std::swap(both.indices[i], both.indices[i + 1]);
  EXPECT_LE(normal_cone(both).cosine, 0.0f);
}

}  // namespace
}  // namespace sulcus::normal_cone_test
