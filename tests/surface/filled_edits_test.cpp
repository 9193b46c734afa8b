// The drawn surface of a solid with fractions while it is cut.

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "engine/shapes/basic_shapes.hpp"
#include "engine/shapes/voxelise_implicit.hpp"
#include "engine/surface/drawn_surface.hpp"
#include "engine/surface/piece_mesh.hpp"
#include "engine/surface/section_face.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/surface_distance.hpp"

namespace sulcus::filled_edits_test {
namespace {

using Eigen::Vector3d;

constexpr double kVoxel = 1e-4;
const std::vector<TissueLook> kLooks{{"outer", {0.81f, 0.64f, 0.36f}}};

/// All that is below a plane that leans by seven degrees, but for what a ball that went along y has
/// taken of it.
struct Cavity : public OnePartShape {
  bool cut;
  Vector3d normal = Vector3d(0.1219, 0.0, 0.9925).normalized();
  double radius = 12.3 * kVoxel;
  explicit Cavity(bool is_cut) : cut(is_cut) {}

  Vector3d from_ball(const Vector3d& p) const {
    const Vector3d middle(1e-4, std::clamp(p.y(), -1.4e-3, 1.4e-3), 0.4e-3);
    return p - middle;
  }
  double plane(const Vector3d& p) const { return normal.dot(p) - 0.83 * kVoxel; }
  double ball(const Vector3d& p) const { return radius - from_ball(p).norm(); }
  double value(const Vector3d& p) const { return cut ? std::max(plane(p), ball(p)) : plane(p); }
  Vector3d gradient(const Vector3d& p) const {
    return !cut || plane(p) > ball(p) ? normal : Vector3d(-from_ball(p).normalized());
  }
  Eigen::AlignedBox3d bounds() const { return {Vector3d::Zero(), Vector3d::Zero()}; }
};

VoxelModel body(bool cut) {
  return voxelise_implicit(Cavity(cut), {{72, 72, 64}, kVoxel}, nullptr, {},
                           SurfaceKind::kFractions);
}

/// Those of the voxels in which two models differ, as the second has them.
std::vector<VoxelLevel> changes(const VoxelModel& from, const VoxelModel& to) {
  std::vector<VoxelLevel> levels;
  for (std::uint32_t v = 0; v < from.grid.cell_count(); ++v) {
    const Cell c = from.grid.cell_of_linear(v);
    if (from.level(c) != to.level(c)) levels.push_back({v, to.level(c)});
  }
  return levels;
}

void expect_same_shape(const std::vector<DrawnMesh>& a, const std::vector<DrawnMesh>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t brick = 0; brick < a.size(); ++brick) {
    EXPECT_EQ(a[brick].indices, b[brick].indices) << brick;
    ASSERT_EQ(a[brick].vertices.size(), b[brick].vertices.size()) << brick;
    for (std::size_t v = 0; v < a[brick].vertices.size(); ++v) {
      EXPECT_EQ(a[brick].vertices[v].position_m, b[brick].vertices[v].position_m);
      EXPECT_EQ(a[brick].vertices[v].normal, b[brick].vertices[v].normal);
    }
  }
}

void mesh_again(DrawnSurface& surface, std::vector<DrawnMesh>& bricks) {
  DrawnSurface::Scratch scratch;
  for (const int b : surface.take_changed()) {
    surface.mesh(b, scratch, bricks[static_cast<std::size_t>(b)]);
  }
}

TEST(FilledEdits, ACavityIsWhereItWasCut) {
  const Cavity shape(true);
  DrawnSurface surface(body(false), kLooks, 1);
  std::vector<DrawnMesh> bricks = test::all_bricks(surface);
  surface.take_changed();
  surface.set_levels(changes(surface.model(), body(true)));
  mesh_again(surface, bricks);

  const auto to_rim = [&](const Vector3d& p) {
    return std::max(std::abs(shape.plane(p)), std::abs(shape.ball(p)));
  };
  const auto measure = [&](const TriangleMesh& mesh, double least_to_rim) {
    return test::distances(
        mesh,
        [&](const Vector3d& p) {
          const bool ends =
              p.cwiseAbs().head<2>().maxCoeff() > 31.0 * kVoxel || p.z() < -27.0 * kVoxel;
          if (ends || to_rim(p) < least_to_rim) return std::numeric_limits<double>::quiet_NaN();
          return shape.value(p);
        },
        [&](const Vector3d& p) { return shape.gradient(p); });
  };
  for (const TriangleMesh& mesh : {test::joined(bricks), closed_surface(surface.model())}) {
    EXPECT_EQ(test::open_edges(mesh), 0u);
    const test::Distances faces = measure(mesh, 2.5 * kVoxel);
    EXPECT_GT(faces.vertices, 3000u);
    EXPECT_LT(faces.vertices_rms, 0.02 * kVoxel);
    EXPECT_LT(faces.inside_rms, 0.03 * kVoxel);
    EXPECT_LT(faces.most, 0.2 * kVoxel);
    const test::Distances all = measure(mesh, 0.0);
    EXPECT_LT(all.inside_rms, 0.15 * kVoxel);
    EXPECT_LT(all.most, 1.0 * kVoxel);
  }
}

TEST(FilledEdits, MeshingAgainIsLocalAndTheSameAsAnew) {
  const VoxelModel start = body(false), end = body(true);
  for (const int cell_voxels : {1, 2}) {
    DrawnSurface edited(start, kLooks, cell_voxels);
    std::vector<DrawnMesh> bricks = test::all_bricks(edited);
    EXPECT_EQ(edited.take_changed().size(), bricks.size());
    // A level alone, of one voxel in a corner.
    std::uint32_t lone = 0;
    for (const Cell& c : test::solid_cells(start)) {
      if (c.x() == 4 && c.y() == 4 && start.level(c) < kFullLevel) lone = start.grid.linear(c);
    }
    ASSERT_NE(lone, 0u);
    const std::vector<DrawnMesh> before = bricks;
    edited.set_levels(std::vector<VoxelLevel>{{lone, 1}});
    const std::vector<int> changed = edited.take_changed();
    EXPECT_LT(changed.size(), bricks.size());
    DrawnSurface::Scratch scratch;
    for (const int b : changed) edited.mesh(b, scratch, bricks[static_cast<std::size_t>(b)]);
    bool other = false;
    for (std::size_t b = 0; b < bricks.size(); ++b) {
      other = other || bricks[b].vertices != before[b].vertices;
    }
    EXPECT_TRUE(other);
    EXPECT_EQ(edited.take_changed_leaves(),
              std::vector<std::uint32_t>{start.grid.leaf_of(start.grid.cell_of_linear(lone))});
    expect_same_shape(bricks, test::all_bricks(DrawnSurface(edited.model(), kLooks, cell_voxels)));

    // Then the cavity, in parts, each of other depth.
    std::vector<VoxelLevel> levels = changes(edited.model(), end);
    for (int part = 0; part < 3; ++part) {
      std::vector<VoxelLevel> some;
      for (std::size_t i = static_cast<std::size_t>(part); i < levels.size(); i += 3) {
        some.push_back(levels[i]);
      }
      edited.set_levels(some);
      mesh_again(edited, bricks);
    }
    expect_same_shape(bricks, test::all_bricks(DrawnSurface(end, kLooks, cell_voxels)));
  }
}

TEST(FilledEdits, GoingBackGivesWhatWasThere) {
  const VoxelModel start = body(false), end = body(true);
  DrawnSurface surface(start, kLooks, 1);
  std::vector<DrawnMesh> bricks = test::all_bricks(surface);
  const std::vector<DrawnMesh> first = bricks;
  surface.take_changed();
  surface.set_levels(changes(start, end), 1.0);
  mesh_again(surface, bricks);
  surface.set_levels(changes(end, start));
  mesh_again(surface, bricks);
  for (std::size_t b = 0; b < bricks.size(); ++b) EXPECT_EQ(bricks[b].vertices, first[b].vertices);

  // What is removed as a whole comes back as full as it was.
  std::vector<std::uint32_t> layer;
  for (const Cell& c : test::solid_cells(start)) {
    if (start.level(c) < kFullLevel) layer.push_back(start.grid.linear(c));
  }
  surface.remove(layer);
  mesh_again(surface, bricks);
  EXPECT_NE(bricks[4].vertices, first[4].vertices);
  surface.restore(layer);
  mesh_again(surface, bricks);
  for (std::size_t b = 0; b < bricks.size(); ++b) EXPECT_EQ(bricks[b].vertices, first[b].vertices);
  const std::uint32_t empty[] = {start.grid.linear({36, 36, 63})};
  surface.set_levels(std::vector<VoxelLevel>{{empty[0], 200}});
  surface.remove(empty);
  EXPECT_TRUE(surface.take_changed().empty());
}

TEST(FilledEdits, TheSoundFaceOfAPieceStaysWhereItWas) {
  DrawnSurface solid(body(false), kLooks, 1);
  std::vector<std::uint32_t> voxels;
  for (const Cell& c : test::solid_cells(solid.model())) {
    const bool inside = (c.head<2>().array() >= 20).all() && (c.head<2>().array() < 50).all();
    if (inside && c.z() >= 16) voxels.push_back(solid.model().grid.linear(c));
  }
  const DrawnMesh piece = piece_mesh(solid, voxels);
  solid.remove(voxels);
  EXPECT_EQ(piece.vertices, piece_mesh(solid, voxels).vertices);
  const Cavity shape(false);
  std::size_t top = 0;
  for (const DrawnVertex& v : piece.vertices) {
    const Vector3d p(v.position_m[0], v.position_m[1], v.position_m[2]);
    if (p.z() < -10.0 * kVoxel || p.head<2>().cwiseAbs().maxCoeff() > 11.0 * kVoxel) continue;
    ++top;
    EXPECT_LT(std::abs(shape.plane(p)), 0.01 * kVoxel);
  }
  EXPECT_GT(top, 300u);
}

TEST(FilledEdits, ASectionEndsWhereTheSolidEnds) {
  const DrawnSurface solid(body(true), kLooks, 1);
  const SectionFace face = section_face(solid, {}, {1, 0.05 * kVoxel});
  ASSERT_EQ(face.width, 64);  // along z, across x
  double filled = 0.0;
  for (const auto& pixel : face.pixels) filled += pixel[3] / 255.0;
  // Beneath the plane, from the grid's lower face on, less the segment that the circle has of it.
  const Cavity shape(true);
  double area = 0.0;
  constexpr int kFine = 20;
  for (int i = 0; i < 72 * kFine; ++i) {
    for (int k = 0; k < 64 * kFine; ++k) {
      const Vector3d p((i + 0.5) / kFine - 36.0, 0.0, (k + 0.5) / kFine - 32.0);
      area += shape.value(p * kVoxel) < 0.0 ? 1.0 / (kFine * kFine) : 0.0;
    }
  }
  EXPECT_NEAR(filled, area, 2.0);
}

}  // namespace
}  // namespace sulcus::filled_edits_test
