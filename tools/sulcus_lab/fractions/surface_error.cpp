#include "tools/sulcus_lab/fractions/surface_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include <Eigen/Geometry>

#include "engine/core/pose.hpp"
#include "engine/core/units.hpp"
#include "engine/shapes/basic_shapes.hpp"
#include "engine/shapes/molar.hpp"
#include "engine/shapes/voxelise_implicit.hpp"
#include "engine/surface/drawn_surface.hpp"
#include "engine/surface/surface_mesh.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr double kVoxel_m = 1e-4;
constexpr double kFromGridsEnd = 10.0;  // voxels: more than a drawn surface is blurred by
constexpr double kEdgeReach = 2.0;      // voxels, as the measurement of normals has it

/// Off the axes and off the lattice.
Pose askew(double turn, const Vector3d& about) {
  return {kVoxel_m * Vector3d(0.31, -0.27, 0.13),
          Eigen::Quaterniond(Eigen::AngleAxisd(turn, about.normalized()))};
}

/// A shape whose value is its distance, in zones that its own space tells (all of it: zone 0).
template <class S, class Zone>
KnownBody body_of(std::string name, const S& shape, const Pose& pose, int cells, Zone zone,
                  double voxel_m = kVoxel_m) {
  const VoxelGrid grid{Eigen::Vector3i::Constant(cells), voxel_m};
  const double end_m = (0.5 * cells - kFromGridsEnd) * voxel_m;
  KnownBody body;
  body.name = std::move(name);
  body.zones = {""};
  body.voxel_m = voxel_m;
  body.model = [=](SurfaceKind surface) {
    return voxelise_implicit(shape, grid, nullptr, pose, surface);
  };
  body.distance = [=](const Vector3d& p_world) -> KnownDistance {
    if (p_world.cwiseAbs().maxCoeff() > end_m) {
      return {std::numeric_limits<double>::quiet_NaN(), 0};
    }
    const Vector3d p = pose.inverse_point(p_world);
    return {shape.value(p), zone(p)};
  };
  return body;
}

int one_zone(const Vector3d&) { return 0; }

/// Half spaces at seeded random attitudes: plates so thick that their lower face is outside.
void add_planes(std::vector<KnownBody>& bodies) {
  constexpr int kPlanes = 20, kCells = 64;
  constexpr double kThick = 4.0 * kCells * kVoxel_m;
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (int n = 0; n < kPlanes; ++n) {
    Pose pose;
    const Vector3d up = Vector3d(normal(random), normal(random), normal(random)).normalized();
    pose.orientation = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), up);
    pose.position = (0.37 * kVoxel_m - 0.5 * kThick) * up;
    bodies.push_back(body_of("planes", PlateShape(kThick, 0.0), pose, kCells, one_zone));
  }
}

KnownBody rotated_cube() {
  constexpr double kEdge_m = 110.0 * kVoxel_m;
  // The nearest face is that with the least depth; how deep below the next one is how far from an
  // edge.
  const auto zone = [](const Vector3d& p) {
    Eigen::Array3d depth = 0.5 * kEdge_m - p.array().abs();
    std::ranges::sort(depth);
    return depth[1] < kEdgeReach * kVoxel_m ? 1 : 0;
  };
  KnownBody cube = body_of("rotated_cube", BoxShape(Vector3d::Constant(kEdge_m)),
                           askew(0.71, Vector3d(0.9, 0.2, -0.5)), 216, zone);
  cube.zones = {"faces", "edges"};
  return cube;
}

/// Its value is no distance: the nearest point is found by Newton's steps.
KnownBody molar() {
  constexpr double kToothVoxel_m = 0.07e-3;
  Pose lowered;  // so that the whole of it is in the grid
  lowered.position.z() = 1.75e-3;
  const Molar tooth;
  KnownBody body = body_of("molar", tooth, lowered, 312, one_zone, kToothVoxel_m);
  body.distance = [=](const Vector3d& p_world) -> KnownDistance {
    const Vector3d p = lowered.inverse_point(p_world);
    Vector3d on = p;
    for (int step = 0; step < 4; ++step) {
      const Vector3d gradient = tooth.gradient(on);
      on -= tooth.value(on) / gradient.squaredNorm() * gradient;
    }
    return {std::copysign((p - on).norm(), tooth.value(p)), 0};
  };
  return body;
}

}  // namespace

std::vector<KnownBody> known_bodies(bool quick) {
  std::vector<KnownBody> bodies;
  bodies.push_back(body_of("sphere", SphereShape(50.0 * kVoxel_m), askew(0.0, Vector3d::UnitX()),
                           128, one_zone));
  bodies.push_back(body_of("torus", TorusShape(48.0 * kVoxel_m, 12.0 * kVoxel_m),
                           askew(0.62, Vector3d(0.3, -0.5, 0.8)), 160, one_zone));
  add_planes(bodies);
  bodies.push_back(rotated_cube());
  if (!quick) bodies.push_back(molar());
  return bodies;
}

std::vector<SurfaceSum> surface_sums(const TriangleMesh& mesh, const KnownBody& body) {
  constexpr std::array<std::array<double, 3>, 3> kInside{
      {{0.6, 0.2, 0.2}, {0.2, 0.6, 0.2}, {0.2, 0.2, 0.6}}};
  std::vector<SurfaceSum> sums(body.zones.size());
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vector3d a = mesh.positions[i].cast<double>(), b = mesh.positions[j].cast<double>(),
                   c = mesh.positions[k].cast<double>();
    const double third_m2 = (b - a).cross(c - a).norm() / 6.0;
    for (const auto& [u, v, w] : kInside) {
      const KnownDistance at = body.distance(u * a + v * b + w * c);
      if (!std::isfinite(at.off_m)) continue;
      SurfaceSum& sum = sums[static_cast<std::size_t>(at.zone)];
      const double off = at.off_m / body.voxel_m;
      sum.squares_m2 += third_m2 * off * off;
      sum.area_m2 += third_m2;
    }
  }
  return sums;
}

TriangleMesh exported_mesh(const VoxelModel& model) { return closed_surface(model); }

TriangleMesh drawn_mesh(VoxelModel model) {
  const DrawnSurface surface(std::move(model), {TissueLook{"all", {1.0f, 1.0f, 1.0f}}});
  TriangleMesh mesh;
  DrawnSurface::Scratch scratch;
  DrawnMesh brick;
  for (int b = 0; b < surface.brick_count(); ++b) {
    surface.mesh(b, scratch, brick);
    const auto before = static_cast<std::uint32_t>(mesh.positions.size());
    for (const DrawnVertex& vertex : brick.vertices) {
      mesh.positions.emplace_back(vertex.position_m[0], vertex.position_m[1], vertex.position_m[2]);
    }
    for (std::size_t i = 0; i + 2 < brick.indices.size(); i += 3) {
      mesh.triangles.push_back({before + brick.indices[i], before + brick.indices[i + 1],
                                before + brick.indices[i + 2]});
    }
  }
  return mesh;
}

}  // namespace sulcus::lab
