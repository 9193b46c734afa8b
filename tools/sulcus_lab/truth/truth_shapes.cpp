#include "tools/sulcus_lab/truth/truth_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include <Eigen/Geometry>
#include <tbb/parallel_for.h>

#include "engine/core/error.hpp"
#include "engine/core/pose.hpp"
#include "engine/core/units.hpp"
#include "engine/shapes/molar.hpp"
#include "engine/shapes/voxelise_implicit.hpp"
#include "engine/volume/workpiece.hpp"
#include "tools/sulcus_lab/truth/composed_shape.hpp"

namespace sulcus::lab {

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr double kEdgeReach = 2.0, kNearReach = 10.0;  // voxels
// The largest neighbourhood that is measured, and what methods look beyond it.
constexpr int kMarginAtCuts = 18;

VoxelGrid grid_of(int cells, double voxel_m) {
  VoxelGrid grid;
  grid.cells = Eigen::Vector3i::Constant(cells);
  grid.voxel_m = voxel_m;
  return grid;
}

AlignedBox3d box_of(const Vector3d& half) { return {-half, half}; }

/// Off the axes and off the lattice.
Pose tilted() {
  Pose pose;
  pose.orientation = Eigen::AngleAxisd(0.41, Vector3d(0.3, -0.5, 0.8).normalized()) *
                     Eigen::AngleAxisd(0.67, Vector3d(0.9, 0.2, -0.3).normalized());
  pose.position = Vector3d(0.13, -0.29, 0.37);
  return pose;
}

/// Other tilts: what a method does near an edge depends on it.
std::vector<Pose> attitudes() {
  std::vector<Pose> poses(3, tilted());
  poses[1].orientation = Eigen::AngleAxisd(0.2, Vector3d::UnitZ()) *
                         Eigen::AngleAxisd(0.5, Vector3d::UnitY()) *
                         Eigen::AngleAxisd(0.3, Vector3d::UnitX());
  poses[2].orientation = Eigen::AngleAxisd(0.55, Vector3d(1.0, 1.0, 0.2).normalized());
  return poses;
}

std::vector<Cell> surface_cells(const Workpiece& workpiece, int margin) {
  std::vector<Cell> cells;
  const Eigen::Vector3i n = workpiece.grid().cells;
  for (int k = margin; k < n.z() - margin; ++k) {
    for (int j = margin; j < n.y() - margin; ++j) {
      for (int i = margin; i < n.x() - margin; ++i) {
        if (workpiece.is_surface({i, j, k})) cells.push_back({i, j, k});
      }
    }
  }
  return cells;
}

/// Names of the sides' zones, each once, then near and edge; a single side has none.
std::vector<std::string> zones_of(const ComposedShape& shape) {
  std::vector<std::string> zones;
  if (shape.sides().size() < 2) return zones;
  for (const Side& side : shape.sides()) {
    if (std::find(zones.begin(), zones.end(), side.zone) == zones.end()) zones.push_back(side.zone);
  }
  zones.insert(zones.end(), {"near", "edge"});
  return zones;
}

int zone_at(const ComposedShape& shape, const ComposedShape::ClosestPoint& closest, double voxel,
            const std::vector<std::string>& zones) {
  if (zones.empty()) return 0;
  const auto last = static_cast<int>(zones.size()) - 1;
  const std::optional<double> edge = shape.edge_distance(closest, kNearReach * voxel);
  if (edge) return *edge < kEdgeReach * voxel ? last : last - 1;
  const auto zone = std::find(zones.begin(), zones.end(), shape.sides()[closest.side].zone);
  return static_cast<int>(zone - zones.begin());
}

/// Voxelises a shape and finds the truth at its surface voxels at least `margin` from the grid's
/// faces: those of the binary shape, with fractions, too.
TruthShape make_shape(std::string name, const ComposedShape& shape, const VoxelGrid& grid,
                      const Pose& pose, int margin, SurfaceKind surface) {
  TruthShape truth;
  truth.name = std::move(name);
  truth.zones = zones_of(shape);
  truth.model = voxelise_implicit(shape, grid, nullptr, pose);
  const Workpiece workpiece{VoxelModel(truth.model)};
  const std::vector<Cell> cells = surface_cells(workpiece, margin);
  truth.voxels.resize(cells.size());
  tbb::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t v) {
    const Vector3d centre = pose.inverse_point(grid.centre_world(cells[v]));
    const ComposedShape::ClosestPoint closest = shape.closest_point(centre);
    truth.voxels[v] = {cells[v], pose.direction(closest.normal),
                       zone_at(shape, closest, grid.voxel_m, truth.zones)};
  });
  if (surface == SurfaceKind::kFractions) {
    truth.model = voxelise_implicit(shape, grid, nullptr, pose, surface);
  }
  return truth;
}

ComposedShape box(double edge) {
  std::vector<Side> sides;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Vector3d normal = sign * Vector3d::Unit(axis);
      sides.push_back(half_space(0.5 * edge * normal, normal));
    }
  }
  return {std::move(sides), box_of(Vector3d::Constant(0.5 * edge))};
}

template <ImplicitShape S>
ComposedShape whole(const S& shape) {
  return {{side_of(shape)}, shape.bounds()};
}

/// A frustum about z: `radius` at z = -half_height, narrower upward by `half_angle` (rad).
ComposedShape frustum(double radius, double half_height, double half_angle) {
  const double c = std::cos(half_angle), s = std::sin(half_angle);
  Side lateral;
  lateral.value = [=](const Vector3d& p) {
    return (std::hypot(p.x(), p.y()) - radius) * c + (p.z() + half_height) * s;
  };
  lateral.gradient = [=](const Vector3d& p) {
    const double r = std::hypot(p.x(), p.y());
    return r > 0.0 ? Vector3d(c * p.x() / r, c * p.y() / r, s) : Vector3d(c, 0.0, s);
  };
  const Vector3d top = half_height * Vector3d::UnitZ();
  return {{std::move(lateral), half_space(top, Vector3d::UnitZ()),
           half_space(-top, -Vector3d::UnitZ())},
          box_of(Vector3d(radius, radius, half_height))};
}

ComposedShape drilled_ellipsoid(const Vector3d& semi_axes, const Vector3d& hole_axis,
                                double hole_radius) {
  // |p / a| - 1 is not a distance; scaled by the shortest axis its slope is at most 1.
  const double scale = semi_axes.minCoeff();
  Side ellipsoid;
  ellipsoid.value = [=](const Vector3d& p) {
    return scale * (p.cwiseQuotient(semi_axes).norm() - 1.0);
  };
  ellipsoid.gradient = [=](const Vector3d& p) -> Vector3d {
    const Vector3d q = p.cwiseQuotient(semi_axes);
    const double length = q.norm();
    if (length == 0.0) return Vector3d::UnitZ();
    return scale / length * q.cwiseQuotient(semi_axes);
  };
  const Vector3d end = 2.0 * semi_axes.maxCoeff() * hole_axis.normalized();
  return {{std::move(ellipsoid), outside_capsule(-end, end, hole_radius)}, box_of(semi_axes)};
}

/// Endless: sin x cos y + sin y cos z + sin z cos x <= 0. On it the gradient's length is sqrt 2 to
/// sqrt 3 and the curvature at most sqrt 3 / 2, both of the unscaled function.
ComposedShape gyroid(double least_radius) {
  const double k = 2.0 / (std::numbers::sqrt3 * least_radius);
  Side side;
  side.value = [=](const Vector3d& p) {
    const Eigen::Array3d s = (k * p).array().sin(), c = (k * p).array().cos();
    return (s[0] * c[1] + s[1] * c[2] + s[2] * c[0]) / (k * std::numbers::sqrt3);
  };
  side.gradient = [=](const Vector3d& p) -> Vector3d {
    const Eigen::Array3d s = (k * p).array().sin(), c = (k * p).array().cos();
    return Vector3d(c[0] * c[1] - s[2] * s[0], c[1] * c[2] - s[0] * s[1],
                    c[2] * c[0] - s[1] * s[2]) /
           std::numbers::sqrt3;
  };
  side.lipschitz = 1.01;  // 1, by dense sampling
  return {{std::move(side)}, box_of(Vector3d::Zero())};
}

/// Vertices at (1, 1, 1), (1, -1, -1), (-1, 1, -1) and (-1, -1, 1) times `corner`.
ComposedShape tetrahedron(double corner) {
  std::vector<Side> sides;
  for (const Vector3d& vertex :
       {Vector3d(1, 1, 1), Vector3d(1, -1, -1), Vector3d(-1, 1, -1), Vector3d(-1, -1, 1)}) {
    sides.push_back(half_space(-corner / 3.0 * vertex, -vertex.normalized()));
  }
  return {std::move(sides), box_of(Vector3d::Constant(corner))};
}

/// Twelve faces at `inner_radius` from the origin, across the vertices of an icosahedron.
ComposedShape dodecahedron(double inner_radius) {
  std::vector<Side> sides;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double one : {-1.0, 1.0}) {
      for (const double golden : {-std::numbers::phi, std::numbers::phi}) {
        Vector3d normal;
        normal[axis] = 0.0, normal[(axis + 1) % 3] = one, normal[(axis + 2) % 3] = golden;
        normal.normalize();
        sides.push_back(half_space(inner_radius * normal, normal));
      }
    }
  }
  // A corner is 1.26 inner radii out.
  return {std::move(sides), box_of(Vector3d::Constant(1.26 * inner_radius))};
}

/// x^2 + y^2 <= waist^2 + (flare z)^2 between two planes.
ComposedShape hyperboloid(double waist, double flare, double half_height) {
  const double scale = 1.0 / std::hypot(1.0, flare);  // of what is steepest far out
  const auto radius_at = [=](double z) { return std::hypot(waist, flare * z); };
  Side lateral;
  lateral.value = [=](const Vector3d& p) {
    return scale * (std::hypot(p.x(), p.y()) - radius_at(p.z()));
  };
  lateral.gradient = [=](const Vector3d& p) -> Vector3d {
    const double r = std::hypot(p.x(), p.y());
    const Vector3d out = r > 0.0 ? Vector3d(p.x() / r, p.y() / r, 0.0) : Vector3d::UnitX();
    return scale * (out - flare * flare * p.z() / radius_at(p.z()) * Vector3d::UnitZ());
  };
  const Vector3d top = half_height * Vector3d::UnitZ();
  const double rim = radius_at(half_height);
  return {{std::move(lateral), half_space(top, Vector3d::UnitZ()),
           half_space(-top, -Vector3d::UnitZ())},
          box_of(Vector3d(rim, rim, half_height))};
}

/// x^4 + y^4 + z^4 <= radius^4.
ComposedShape quartic(double radius) {
  const auto norm = [](const Vector3d& p) { return std::pow(p.array().pow(4).sum(), 0.25); };
  Side side;
  side.value = [=](const Vector3d& p) { return norm(p) - radius; };
  side.gradient = [=](const Vector3d& p) -> Vector3d {
    const double length = norm(p);
    if (length == 0.0) return Vector3d::UnitZ();
    return (p / length).array().cube();
  };
  return {{std::move(side)}, box_of(Vector3d::Constant(radius))};
}

ComposedShape cut_molar() {
  const Molar molar;
  const Vector3d pit = molar.central_pit();
  const Vector3d x = Vector3d::UnitX(), z = Vector3d::UnitZ();
  const double mm = kMillimetre;
  return {{side_of(molar, "tooth"),
           outside_capsule(pit - 3.0 * mm * x + 0.2 * mm * z, pit + 3.0 * mm * x + 0.2 * mm * z,
                           0.7 * mm, "cut"),
           outside_capsule(pit - 1.2 * mm * z, pit + 4.0 * mm * z, 1.1 * mm, "cut")},
          molar.bounds()};
}

TruthShape tooth(std::string name, const ComposedShape& shape, SurfaceKind surface) {
  Pose lowered;  // so that the whole of it is in the grid
  lowered.position.z() = 1.75e-3;
  return make_shape(std::move(name), shape, grid_of(312, 0.07e-3), lowered, 4, surface);
}

std::string plate_name(double thickness) {
  std::string name = "plate_" + std::to_string(thickness);
  name.erase(name.find_last_not_of('0') + 1);
  if (name.back() == '.') name.pop_back();
  return name;
}

std::vector<TruthShape> plates(SurfaceKind surface) {
  std::vector<TruthShape> all;
  for (const double thickness : {1.0, 1.5, 2.0, 3.0}) {
    for (int tilt_deg = 0; tilt_deg <= 45; tilt_deg += 9) {
      for (const double azimuth : {0.0, 0.5, 1.1}) {
        Pose pose;
        pose.orientation = Eigen::AngleAxisd(azimuth, Vector3d::UnitZ()) *
                           Eigen::AngleAxisd(tilt_deg * std::numbers::pi / 180, Vector3d::UnitY());
        pose.position = Vector3d(0.1, 0.2, 0.21 + 0.3 * azimuth);
        TruthShape plate = make_shape("plate", whole(PlateShape(thickness, 0.0)), grid_of(96, 1.0),
                                      pose, kMarginAtCuts, surface);
        plate.zones = {plate_name(thickness)};
        plate.tool_direction = Vector3d::UnitZ();
        plate.either_sign = thickness == 1.0;
        // The tool comes from above: what it touches is the upper side.
        std::erase_if(plate.voxels, [](const TruthVoxel& v) { return v.normal.z() < 0.0; });
        all.push_back(std::move(plate));
      }
    }
  }
  return all;
}

/// Half spaces at seeded random attitudes.
std::vector<TruthShape> planes(SurfaceKind surface) {
  std::mt19937 random(7);
  std::vector<TruthShape> all;
  for (int n = 0; n < 200; ++n) {
    // Of a cube what lies in the ball, so that all directions are as likely.
    Vector3d normal;
    do {
      for (double& c : normal) c = 2.0 * (static_cast<double>(random()) / 4294967296.0) - 1.0;
    } while (normal.squaredNorm() > 1.0 || normal.squaredNorm() < 0.01);
    normal.normalize();
    const ComposedShape solid({half_space(Vector3d::Constant(0.3), normal)},
                              box_of(Vector3d::Constant(60)));
    all.push_back(make_shape("planes", solid, grid_of(64, 1.0), {}, kMarginAtCuts, surface));
  }
  return all;
}

/// Balls in which a voxel is solid where its centre, moved in or out at random, is inside.
std::vector<TruthShape> rough_balls() {
  constexpr double kRadius = 48.0;
  std::mt19937 random(9);
  std::vector<TruthShape> all;
  for (const char* roughness : {"0.4", "0.7"}) {
    TruthShape ball = make_shape("rough", whole(SphereShape(kRadius)), grid_of(112, 1.0), tilted(),
                                 4, SurfaceKind::kBinary);
    const Vector3d centre = tilted().position.array() + 0.5 * (112 - 1);
    for (std::uint32_t v = 0; v < ball.model.grid.cell_count(); ++v) {
      const Cell c = ball.model.grid.cell_of_linear(v);
      const double out = (c.cast<double>() - centre).norm() - kRadius;
      if (std::abs(out) > 1.0) continue;
      const double even = 2.0 * (static_cast<double>(random()) / 4294967296.0) - 1.0;
      ball.model.set(c, out + std::stod(roughness) * even <= 0.0);
    }
    ball.zones = {std::string("by_") + roughness};
    ball.voxels.clear();
    for (const Cell& c : surface_cells(Workpiece{VoxelModel(ball.model)}, 4)) {
      ball.voxels.push_back({c, (c.cast<double>() - centre).normalized()});
    }
    all.push_back(std::move(ball));
  }
  return all;
}

std::string listed_names() {
  std::string list;
  for (const std::string_view name : kShapeNames)
    list.append(list.empty() ? "" : ", ").append(name);
  return list;
}

}  // namespace

std::vector<TruthShape> truth_shapes(std::string_view name, SurfaceKind surface) {
  if (name == "plate") return plates(surface);
  if (name == "planes") return planes(surface);
  if (name == "rough") return rough_balls();
  const auto one = [&](const ComposedShape& shape, int cells, const Pose& pose, int margin) {
    std::vector<TruthShape> shapes;
    shapes.push_back(
        make_shape(std::string(name), shape, grid_of(cells, 1.0), pose, margin, surface));
    return shapes;
  };
  // An index of 127.5 is the middle of 256 cells, the shape's origin.
  if (name == "sphere") return one(whole(SphereShape(102.4)), 256, {}, 4);
  if (name == "cube") return one(box(224), 256, {}, 4);
  if (name == "torus") return one(whole(TorusShape(48, 12)), 160, tilted(), 4);
  if (name == "cone") return one(frustum(48, 40, 20 * std::numbers::pi / 180), 144, tilted(), 4);
  if (name == "drilled_ellipsoid") {
    return one(drilled_ellipsoid({60, 42, 32}, {0.3, 0.2, 0.9}, 9), 144, tilted(), 4);
  }
  if (name == "gyroid") return one(gyroid(12), 144, tilted(), kMarginAtCuts);
  if (name == "tetrahedron") return one(tetrahedron(45), 176, tilted(), 4);
  if (name == "dodecahedron") return one(dodecahedron(48), 136, tilted(), 4);
  if (name == "hyperboloid") return one(hyperboloid(26, 0.7, 44), 144, tilted(), 4);
  if (name == "quartic") return one(quartic(50), 152, tilted(), 4);
  std::vector<TruthShape> shapes;
  if (name == "rotated_cube") {
    for (const Pose& pose : attitudes()) {
      shapes.push_back(make_shape("rotated_cube", box(110), grid_of(216, 1.0), pose, 4, surface));
    }
  }
  if (name == "molar") shapes.push_back(tooth("molar", whole(Molar()), surface));
  if (name == "molar_cut") shapes.push_back(tooth("molar_cut", cut_molar(), surface));
  if (shapes.empty()) throw InputError("", "shape", "'" + std::string(name) + "'", listed_names());
  return shapes;
}

}  // namespace sulcus::lab
