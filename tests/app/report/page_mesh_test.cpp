#include "app/report/page/page_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "engine/surface/surface_mesh.hpp"

namespace sulcus::page_mesh_test {
namespace {

/// A block of 3 mm, of voxels of 0.05 mm, with a ball of 1 mm cut out of its top at a slant.
VoxelModel cut_block() {
  VoxelModel model;
  model.grid = {{72, 72, 72}, 5e-5};
  model.leaves.resize(model.grid.leaf_count());
  for_each_cell(Cell::Constant(6), Cell::Constant(66), [&](const Cell& c) {
    const Eigen::Vector3d p = c.cast<double>();
    const bool ball = (p - Eigen::Vector3d(40, 33, 60)).norm() < 20.0;
    if (!ball && p.x() + 0.3 * p.z() < 78.0) model.set(c, true);
  });
  return model;
}

double to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double along = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - along * (b - a)).norm();
}

/// By the plane where the point lies over the triangle, else by its edges: of every triangle.
double brute_distance(const Eigen::Vector3d& p, const TriangleMesh& mesh) {
  double least = 1e9;
  for (const auto& t : mesh.triangles) {
    std::array<Eigen::Vector3d, 3> q;
    for (std::size_t k = 0; k < 3; ++k) q[k] = mesh.positions[t[k]].cast<double>();
    const Eigen::Vector3d normal = (q[1] - q[0]).cross(q[2] - q[0]).normalized();
    bool over = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d& next = q[(k + 1) % 3];
      over = over && (next - q[k]).cross(p - q[k]).dot(normal) >= 0.0;
      least = std::min(least, to_segment(p, q[k], next));
    }
    if (over) least = std::min(least, std::abs((p - q[0]).dot(normal)));
  }
  return least;
}

double brute_greatest(const TriangleMesh& from, const TriangleMesh& to) {
  double greatest = 0.0;
  for (const Eigen::Vector3f& p : from.positions) {
    greatest = std::max(greatest, brute_distance(p.cast<double>(), to));
  }
  return greatest;
}

TEST(PageMesh, NothingIsFartherOffThanAPageMayShowIt) {
  const TriangleMesh mesh = closed_surface(cut_block());
  const MeshPart few = simplified(mesh);
  EXPECT_LT(10 * few.mesh.triangles.size(), mesh.triangles.size());
  const double greatest_m = brute_greatest(mesh, few.mesh);
  EXPECT_LE(greatest_m, 0.05e-3);
  EXPECT_GT(greatest_m, 0.01e-3) << "more triangles than there need be";
  ASSERT_EQ(few.vertex_of.size(), few.mesh.positions.size());
  for (std::size_t v = 0; v < few.vertex_of.size(); ++v) {
    EXPECT_EQ(few.mesh.positions[v], mesh.positions[few.vertex_of[v]]);
  }
}

TEST(PageMesh, TheGreatestDistanceIsThatOfBruteForce) {
  const TriangleMesh mesh = closed_surface(cut_block());
  const MeshPart few = simplified(mesh);
  EXPECT_NEAR(greatest_distance(mesh, few.mesh, 1e-3), brute_greatest(mesh, few.mesh), 1e-12);
  TriangleMesh moved = mesh;
  for (Eigen::Vector3f& p : moved.positions) p.z() += 0.2e-3f;
  EXPECT_TRUE(std::isinf(greatest_distance(moved, mesh, 0.1e-3)));
}

TEST(PageMesh, CrumbsStay) {
  VoxelModel model = cut_block();
  model.set(Cell(2, 2, 2), true);
  const TriangleMesh mesh = closed_surface(model);
  EXPECT_LE(brute_greatest(mesh, simplified(mesh).mesh), 0.05e-3);
}

using Place = std::array<float, 3>;

/// Edges that one triangle alone has.
std::set<std::pair<Place, Place>> border_of(const TriangleMesh& mesh) {
  std::map<std::pair<Place, Place>, int> balance;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3f &p = mesh.positions[t[k]], &q = mesh.positions[t[(k + 1) % 3]];
      const Place a{p.x(), p.y(), p.z()}, b{q.x(), q.y(), q.z()};
      a < b ? ++balance[{a, b}] : --balance[{b, a}];
    }
  }
  std::set<std::pair<Place, Place>> border;
  for (const auto& [edge, count] : balance) {
    if (count != 0) border.insert(edge);
  }
  return border;
}

TEST(PageMesh, PartsThatFittedTogetherStillDo) {
  const TriangleMesh mesh = closed_surface(cut_block());
  std::array<std::vector<std::size_t>, 2> halves;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    halves[mesh.positions[mesh.triangles[t][0]].z() > 0.7e-3f ? 1 : 0].push_back(t);
  }
  std::array<std::set<std::pair<Place, Place>>, 2> borders;
  for (std::size_t half = 0; half < 2; ++half) {
    const MeshPart part = part_of(mesh, halves[half]);
    borders[half] = border_of(simplified(part.mesh).mesh);
    EXPECT_EQ(borders[half], border_of(part.mesh));
    EXPECT_GT(borders[half].size(), 100u);
  }
  EXPECT_EQ(borders[0], borders[1]);
}

}  // namespace
}  // namespace sulcus::page_mesh_test
