#include "tools/sulcus_lab/laws/law_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Geometry>

#include "engine/scene/scene_file.hpp"
#include "engine/shapes/basic_shapes.hpp"
#include "engine/shapes/build_shape.hpp"
#include "engine/shapes/voxelise_implicit.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr std::string_view kLawShapeNames[] = {"box",    "tilted_box", "plane", "blob",
                                               "groove", "ridge",      "wall",  "molar"};
constexpr double kLawShape_m = 2.78e-3;

Vector3d unit(double x, double y, double z) { return Vector3d(x, y, z).normalized(); }

/// What `voxelise_implicit` asks of a shape.
class SolidShape : public OnePartShape {
 public:
  explicit SolidShape(const LawSolid& solid) : solid_(solid) {}
  double value(const Vector3d& p) const { return solid_.value(p); }
  Vector3d gradient(const Vector3d& p) const {
    constexpr double kStep_m = 1e-8;
    Vector3d gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d step = kStep_m * Vector3d::Unit(axis);
      gradient[axis] = (value(p + step) - value(p - step)) / (2.0 * kStep_m);
    }
    return gradient;
  }
  double lipschitz() const { return solid_.steepest; }
  Eigen::AlignedBox3d bounds() const { return {}; }  // what the grid cuts off is meant to go

 private:
  const LawSolid& solid_;
};

VoxelModel cube(double voxel_m, SurfaceKind surface, const LawSolid& solid) {
  return law_voxels(Vector3d::Constant(kLawShape_m), voxel_m, surface, solid);
}

/// Unit, across `axis` and as near to it as may be.
Vector3d square_to(const Vector3d& normal, const Vector3d& axis) {
  return (axis - axis.dot(normal) * normal).normalized();
}

/// A solid below two planes through the origin that lean by so much to each side.
LawShape roof(double voxel_m, SurfaceKind surface, const Vector3d& up, const Vector3d& across,
              double slope) {
  const auto value = [=](const Vector3d& p) { return up.dot(p) + slope * std::abs(across.dot(p)); };
  return {.model = cube(voxel_m, surface, {value, 1.0 + slope}), .normal = up, .across = across};
}

LawShape box_edge(double voxel_m, SurfaceKind surface) {
  return {.model =
              cube(voxel_m, surface, {[](const Vector3d& p) { return std::max(p.x(), p.z()); }})};
}

LawShape tilted_box(double voxel_m, SurfaceKind surface) {
  const Vector3d up = unit(0.3, 0.17, 1.0), across = square_to(up, unit(1.0, 0.4, 0.0));
  const auto value = [=](const Vector3d& p) { return std::max(up.dot(p), across.dot(p)); };
  return {.model = cube(voxel_m, surface, {value}), .normal = up, .across = across};
}

LawShape plane(double voxel_m, SurfaceKind surface) {
  const Vector3d up = unit(0.21, 0.34, 1.0);
  return {.model = cube(voxel_m, surface, {[=](const Vector3d& p) { return up.dot(p); }}),
          .normal = up,
          .across = square_to(up, Vector3d::UnitX())};
}

/// A ball with bumps, of which no two are alike.
LawShape blob(double voxel_m, SurfaceKind surface) {
  const auto value = [](const Vector3d& p) {
    const Vector3d d = p - Vector3d(0.03e-3, -0.02e-3, -0.85e-3), u = d.normalized();
    const double bumps = 0.10 * std::sin(4.0 * u.x() + 1.0) * std::cos(3.0 * u.y() - 0.4) +
                         0.07 * std::sin(5.0 * u.y() + 2.0 * u.z());
    return d.norm() - 0.85e-3 * (1.0 + bumps);
  };
  // Steepest near its middle, where u turns fast.
  return {.model = cube(voxel_m, surface, {value, 50.0})};
}

LawShape groove(double voxel_m, SurfaceKind surface) {
  const Vector3d up = unit(0.1, -0.05, 1.0), across = square_to(up, unit(1.0, 0.45, 0.0));
  const double slope = 1.0 / std::tan(30.0 * kDegree);
  const auto value = [=](const Vector3d& p) {
    const Vector3d d = p + 0.9e-3 * up;
    return up.dot(d) - slope * std::abs(across.dot(d));
  };
  return {.model = cube(voxel_m, surface, {value, 1.0 + slope}), .normal = up, .across = across};
}

LawShape wall(double voxel_m, SurfaceKind surface) {
  const Vector3d across = unit(1.0, 0.55, 0.0);
  const auto value = [=](const Vector3d& p) {
    return std::max(p.z(), std::abs(across.dot(p)) - 0.052e-3);
  };
  return {.model = cube(voxel_m, surface, {value}), .across = across};
}

Scene molar_scene(double voxel_m, SurfaceKind surface, const Cell& cells, const Vector3d& moved_m) {
  std::string text = "[workpiece]\nshape = 'molar'\n[trajectory]\npoints_mm = [[0, 0, 100]]\n";
  Scene scene = parse_scene(text, "laws");
  scene.workpiece.voxel_m = voxel_m;
  scene.workpiece.cells = cells;
  scene.workpiece.position_m = moved_m;
  scene.workpiece.surface = surface;
  return scene;
}

/// The molar's highest cusp, at the origin.
LawShape molar_cusp(double voxel_m, SurfaceKind surface) {
  const Vector3d down(0.0, 0.0, -8.0e-3);
  const VoxelModel crown =
      build_shape(molar_scene(0.1e-3, SurfaceKind::kBinary, {128, 128, 16}, down));
  Cell highest(0, 0, -1);
  for_each_cell(Cell::Zero(), crown.grid.cells, [&](const Cell& c) {
    if (c.z() > highest.z() && crown.solid(c)) highest = c;
  });
  const int cells = 8 * static_cast<int>(std::ceil(kLawShape_m / (8.0 * voxel_m)));
  const Vector3d cusp = crown.grid.centre_world(highest) - down;
  return {.model = build_shape(molar_scene(voxel_m, surface, Cell::Constant(cells), -cusp)),
          .across = unit(1.0, 0.3, 0.0)};
}

}  // namespace

std::span<const std::string_view> law_shape_names() { return kLawShapeNames; }

VoxelModel law_voxels(const Vector3d& size_m, double voxel_m, SurfaceKind surface,
                      const LawSolid& solid) {
  VoxelGrid grid;
  grid.cells = 8 * (size_m.array() / (8.0 * voxel_m) - 1e-6).ceil().cast<int>().matrix();
  grid.voxel_m = voxel_m;
  return voxelise_implicit(SolidShape(solid), grid, nullptr, {}, surface);
}

void put_voxels(const VoxelModel& from, const std::function<Cell(const Cell&)>& to,
                VoxelModel& model) {
  model.leaves.resize(model.grid.leaf_count());
  if (from.fills && !model.fills) {
    model.fills.emplace(model.grid.leaf_count(), std::vector<LeafLevels>{});
    model.fills->reserve(model.grid.leaf_count());
  }
  for_each_cell(Cell::Zero(), from.grid.cells, [&](const Cell& c) {
    if (from.solid(c)) model.set_level(to(c), from.level(c));
  });
}

double filled_voxels(const VoxelModel& model) {
  double filled = 0.0;
  for_each_cell(Cell::Zero(), model.grid.cells, [&](const Cell& c) { filled += model.level(c); });
  return filled / kFullLevel;
}

double filled_voxels(const VoxelModel& model, std::uint8_t tissue) {
  double filled = 0.0;
  for_each_cell(Cell::Zero(), model.grid.cells, [&](const Cell& c) {
    if (model.tissue(c) == tissue) filled += model.level(c);
  });
  return filled / kFullLevel;
}

LawShape law_shape(std::string_view name, SurfaceKind surface, double voxel_m) {
  if (name == "box") return box_edge(voxel_m, surface);
  if (name == "tilted_box") return tilted_box(voxel_m, surface);
  if (name == "plane") return plane(voxel_m, surface);
  if (name == "blob") return blob(voxel_m, surface);
  if (name == "groove") return groove(voxel_m, surface);
  if (name == "ridge") {
    const Vector3d up = unit(-0.12, 0.2, 1.0);
    return roof(voxel_m, surface, up, square_to(up, unit(1.0, -0.35, 0.0)),
                std::tan(60.0 * kDegree));
  }
  if (name == "wall") return wall(voxel_m, surface);
  return molar_cusp(voxel_m, surface);
}

VoxelModel law_groove(double angle, double depth_m, const Vector3d& bisector,
                      const Vector3d& across, SurfaceKind surface) {
  const Vector3d bottom = -(kLawRadius_m - depth_m) / std::sin(0.5 * angle) * bisector;
  const double slope = 1.0 / std::tan(0.5 * angle);
  const auto value = [=](const Vector3d& p) {
    const Vector3d d = p - bottom;
    return bisector.dot(d) - slope * std::abs(across.dot(d));
  };
  return law_voxels(Vector3d::Constant(3.4e-3), kLawVoxel_m, surface, {value, 1.0 + slope});
}

Vector3d touching_centre(const LawShape& shape, const Vector3d& offset_m) {
  const VoxelGrid& grid = shape.model.grid;
  const Vector3d from = shape.point_m + offset_m;
  double height_m = -1.0;
  for_each_cell(Cell::Zero(), grid.cells, [&](const Cell& c) {
    const Vector3d way = grid.centre_world(c) - from;
    const double up_m = shape.normal.dot(way);
    const double aside_m2 = way.squaredNorm() - up_m * up_m;
    const double room_m2 = kLawRadius_m * kLawRadius_m - aside_m2;
    if (room_m2 <= 0.0 || up_m + std::sqrt(room_m2) <= height_m || !shape.model.solid(c)) return;
    const double filled = static_cast<double>(shape.model.level(c)) / kFullLevel;
    height_m = std::max(height_m, up_m + std::sqrt(room_m2) + (filled - 1.0) * grid.voxel_m);
  });
  // The surface is half a voxel out of the outermost centres of full voxels.
  return from + (height_m + 0.5 * grid.voxel_m) * shape.normal;
}

}  // namespace sulcus::lab
