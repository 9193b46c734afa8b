#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "engine/import/meshes/voxelise_mesh.hpp"
#include "engine/shapes/build_shape.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "tests/import/mesh_fixtures.hpp"

// Several surfaces of one tooth, each of a tissue of its own.

namespace sulcus::voxelise_surfaces_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

enum : std::uint8_t { kEnamelLabel, kDentineLabel, kPulpLabel };

VoxelGrid grid_of(int cells, double voxel_m) { return {Eigen::Vector3i::Constant(cells), voxel_m}; }

TriangleMesh moved(TriangleMesh mesh, const Vector3f& stretch, const Vector3f& shift) {
  for (Vector3f& p : mesh.positions) p = p.cwiseProduct(stretch) + shift;
  return mesh;
}

/// Leaves every `one_in`th triangle away, by chance.
TriangleMesh punched(TriangleMesh mesh, std::uint32_t one_in) {
  std::mt19937 random(7);
  std::erase_if(mesh.triangles, [&](const auto&) { return random() % one_in == 0; });
  return mesh;
}

std::size_t open_edges(const TriangleMesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh.triangles) {
    for (int e = 0; e < 3; ++e) edges.emplace(t[e], t[(e + 1) % 3]);
  }
  std::size_t open = 0;
  for (const auto& [a, b] : edges) open += edges.contains({b, a}) ? 0 : 1;
  return open;
}

/// Of a voxel; kNothing where nothing is solid.
constexpr int kNothing = -1;
int label_at(const VoxelModel& model, const Cell& c) {
  return model.solid(c) ? model.tissue(c) : kNothing;
}

template <class Visit>
void for_each_cell(const VoxelGrid& grid, Visit visit) {
  for (std::uint32_t v = 0; v < grid.cell_count(); ++v) visit(grid.cell_of_linear(v));
}

std::array<double, 3> volumes_m3(const VoxelModel& model) {
  std::array<double, 3> volumes{};
  for_each_cell(model.grid, [&](const Cell& c) {
    if (model.solid(c)) volumes[model.tissue(c)] += model.grid.voxel_volume_m3();
  });
  return volumes;
}

/// Volumes within 2 % of the truth, and every label right from `reach` voxels beside a border on.
template <class Truth>
void expect_tissues(const VoxelModel& model, const Truth& truth, int reach) {
  const VoxelGrid& grid = model.grid;
  std::vector<int> labels(grid.cell_count());
  std::array<double, 3> expected{};
  for_each_cell(grid, [&](const Cell& c) {
    const int label = labels[grid.linear(c)] = truth(c);
    if (label != kNothing) expected[label] += grid.voxel_volume_m3();
  });
  const auto away_from_borders = [&](const Cell& c) {
    for (int n = 0, side = 2 * reach + 1; n < side * side * side; ++n) {
      const Cell near =
          c + Cell(n % side, n / side % side, n / side / side) - Cell(1, 1, 1) * reach;
      if (!grid.contains(near) || labels[grid.linear(near)] != labels[grid.linear(c)]) return false;
    }
    return true;
  };
  std::uint64_t wrong = 0, compared = 0;
  for_each_cell(grid, [&](const Cell& c) {
    if (!model.solid(c) && labels[grid.linear(c)] == kNothing) return;
    if (!away_from_borders(c)) return;
    ++compared;
    wrong += label_at(model, c) != labels[grid.linear(c)] ? 1 : 0;
  });
  const std::array<double, 3> found = volumes_m3(model);
  for (int t = 0; t < 3; ++t) EXPECT_NEAR(found[t] / expected[t], 1.0, 0.02) << "tissue " << t;
  EXPECT_EQ(wrong, 0u) << "of " << compared;
  EXPECT_GT(compared, model.solid_count() / 4);
}

// A crown, a core that comes out of it below as a root, and a chamber in the core.
const Vector3d kCore(0.1e-3, 0, -0.9e-3), kChamber(0, 0.1e-3, -0.6e-3);
const Vector3d kCrownRadii(2e-3, 1.8e-3, 1.6e-3), kCoreRadii(1.3e-3, 1.2e-3, 1.9e-3),
    kChamberRadii(0.5e-3, 0.6e-3, 0.9e-3);

std::vector<TissueSurface> nested_ellipsoids() {
  const TriangleMesh ball = icosphere(5);  // 20,480 triangles
  const auto ellipsoid = [&](const Vector3d& radii, const Vector3d& centre) {
    return moved(ball, radii.cast<float>(), centre.cast<float>());
  };
  return {{ellipsoid(kCrownRadii, {0, 0, 0}), "crown.stl", kEnamelLabel},
          {ellipsoid(kCoreRadii, kCore), "core.stl", kDentineLabel},
          {ellipsoid(kChamberRadii, kChamber), "chamber.stl", kPulpLabel}};
}

/// The centre of the box of the three is at the grid's: from z = -2.8 to 1.6 mm.
int ellipsoid_truth(const VoxelGrid& grid, const Cell& c) {
  const Vector3d p = grid.centre_world(c) + Vector3d(0, 0, -0.6e-3);
  const auto within = [&](const Vector3d& radii, const Vector3d& centre) {
    return (p - centre).cwiseQuotient(radii).norm() < 1.0;
  };
  return within(kChamberRadii, kChamber)  ? kPulpLabel
         : within(kCoreRadii, kCore)      ? kDentineLabel
         : within(kCrownRadii, {0, 0, 0}) ? kEnamelLabel
                                          : kNothing;
}

TEST(VoxeliseSurfaces, NestedEllipsoidsTwoOfThemOpen) {
  std::vector<TissueSurface> surfaces = nested_ellipsoids();
  const VoxelGrid grid = grid_of(104, 5e-5);
  const auto truth = [&](const Cell& c) { return ellipsoid_truth(grid, c); };
  const VoxelModel closed = voxelise_surfaces(surfaces, grid, {});
  EXPECT_FALSE(closed.clipped);
  expect_tissues(closed, truth, 1);
  for (const int open : {0, 1}) {
    surfaces[open].mesh = punched(surfaces[open].mesh, 50);
    EXPECT_GT(open_edges(surfaces[open].mesh), 300u);
  }
  expect_tissues(voxelise_surfaces(surfaces, grid, {}), truth, 2);
}

TEST(VoxeliseSurfaces, ALaterOneWinsAndTheSolidIsTheUnion) {
  std::vector<TissueSurface> surfaces = nested_ellipsoids();
  std::swap(surfaces[1], surfaces[2]);  // the core after the chamber, which lies within it
  const VoxelModel model = voxelise_surfaces(surfaces, grid_of(104, 5e-5), {});
  const std::array<double, 3> volumes = volumes_m3(model);
  EXPECT_EQ(volumes[kPulpLabel], 0.0);
  EXPECT_NEAR(volumes[kDentineLabel] / (4.0 / 3.0 * std::numbers::pi * kCoreRadii.prod()), 1.0,
              0.01);
  // The root, beyond the crown, is solid.
  EXPECT_EQ(label_at(model, Cell(52, 52, 10)), kDentineLabel);
}

TEST(VoxeliseSurfaces, AllAreTurnedAndMovedTogether) {
  WorkpieceSettings settings;
  settings.rotation = {0, 0, std::numbers::pi / 2};
  settings.position_m = {2e-4, 0, -1e-4};
  const VoxelGrid grid = grid_of(104, 5e-5);
  const VoxelModel model = voxelise_surfaces(nested_ellipsoids(), grid, settings);
  expect_tissues(
      model,
      [&](const Cell& c) {
        const Cell p = c - Cell(4, 0, -2);  // 104 cells: i goes to 103 - i
        return ellipsoid_truth(grid, Cell(p.y(), 103 - p.x(), p.z()));
      },
      1);
}

TEST(VoxeliseSurfaces, OneThatEnclosesNoVoxelIsNamed) {
  std::vector<TissueSurface> surfaces = nested_ellipsoids();
  surfaces[2].mesh = moved(icosphere(1), Vector3f::Constant(1e-6f), Vector3f::Constant(1.3e-5f));
  try {
    (void)voxelise_surfaces(surfaces, grid_of(104, 5e-5), {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "chamber.stl: found a mesh 0.002 mm long with no voxel of the grid inside, expected a "
        "closed one, in mm, that reaches into the grid; it is 0.002 mm long, as no tooth is, in "
        "whatever unit");
  }
}

TEST(VoxeliseSurfaces, OneThatReachesBeyondTheGridClips) {
  std::vector<TissueSurface> surfaces = nested_ellipsoids();
  EXPECT_TRUE(voxelise_surfaces(surfaces, grid_of(80, 5e-5), {}).clipped);
  surfaces.resize(1);
  const VoxelModel crown = voxelise_surfaces(surfaces, grid_of(80, 5e-5), {});
  EXPECT_FALSE(crown.clipped);
  EXPECT_EQ(crown.tissues, nullptr) << "one has no labels";
}

TEST(VoxeliseSurfaces, TheTissuesOfTheBuiltInMolar) {
  Scene scene;
  scene.workpiece.shape = ShapeKind::kMolar;
  scene.workpiece.voxel_m = 0.1e-3;
  scene.workpiece.cells = {128, 112, 224};
  for (const char* name : {"enamel", "dentine", "pulp"}) {
    TissueSettings tissue;
    tissue.name = name;
    scene.tissues.push_back(tissue);
  }
  const VoxelModel molar = build_shape(scene);
  std::vector<TissueSurface> surfaces = {
      {closed_surface(molar), "tooth.stl", kEnamelLabel},
      {closed_surface(molar, {.tissue = kDentineLabel}), "dentine.stl", kDentineLabel},
      {closed_surface(molar, {.tissue = kPulpLabel}), "pulp.stl", kPulpLabel}};
  Eigen::AlignedBox3f box;
  for (const Vector3f& p : surfaces[0].mesh.positions) box.extend(p);
  for (const int open : {0, 1}) {
    surfaces[open].mesh = punched(surfaces[open].mesh, 100);
    EXPECT_GT(open_edges(surfaces[open].mesh), 300u);
  }
  WorkpieceSettings settings;
  settings.position_m = box.center().cast<double>();  // where the molar was
  expect_tissues(
      voxelise_surfaces(surfaces, molar.grid, settings),
      [&](const Cell& c) { return label_at(molar, c); }, 2);
}

TEST(VoxeliseSurfaces, ARealMolarWithSmallerOnesInside) {
  const std::string path = SULCUS_SOURCE_DIR "/../shared/data/open_full_jaw/mandible_tooth_19.stl";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const TriangleMesh tooth = read_mesh(path);
  const auto box_of = [](const TriangleMesh& mesh) {
    Eigen::AlignedBox3f box;
    for (const Vector3f& p : mesh.positions) box.extend(p);
    return box;
  };
  const Vector3f centre = box_of(tooth).center();
  // Moved by enough to come out of the tooth between the roots: the union is more than the tooth.
  const auto smaller = [&](float by, const Vector3f& shift) {
    return moved(tooth, Vector3f::Constant(by), centre * (1.0f - by) + shift);
  };
  std::vector<TissueSurface> surfaces = {
      {tooth, path, kEnamelLabel},
      {smaller(0.75f, {0.3e-3f, 0, 0}), "dentine.stl", kDentineLabel},
      {smaller(0.4f, {0, 0.4e-3f, 0.2e-3f}), "pulp.stl", kPulpLabel}};
  const VoxelGrid grid = grid_of(160, 1.5e-4);
  // The truth: each closed one alone, put where it belongs.
  std::vector<VoxelModel> alone;
  Eigen::AlignedBox3f all;
  for (const TissueSurface& s : surfaces) all.extend(box_of(s.mesh));
  for (const TissueSurface& s : surfaces) {
    WorkpieceSettings settings;
    settings.position_m = (box_of(s.mesh).center() - all.center()).cast<double>();
    alone.push_back(voxelise_mesh(s.mesh, grid, settings));
  }
  for (const int open : {1, 2}) surfaces[open].mesh = punched(surfaces[open].mesh, 50);
  EXPECT_GT(open_edges(surfaces[1].mesh), 300u);
  const auto truth = [&](const Cell& c) {
    for (const std::uint8_t t : {kPulpLabel, kDentineLabel, kEnamelLabel}) {
      if (alone[t].solid(c)) return int{t};
    }
    return kNothing;
  };
  expect_tissues(voxelise_surfaces(surfaces, grid, {}), truth, 2);
}

}  // namespace
}  // namespace sulcus::voxelise_surfaces_test
