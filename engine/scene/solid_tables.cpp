#include <algorithm>
#include <cmath>
#include <sstream>

#include "engine/core/file_kind.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/table_readers.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

namespace {

/// The table of each shape; read for every shape, so that a scene may keep several.
void read_shape_tables(SceneTable& table, WorkpieceSettings& w) {
  if (auto t = table.table("molar")) {
    w.molar_caries_radius_m = t->number("caries_radius_mm") * kMillimetre;
    t->finish();
  }
  if (auto t = table.table("sphere")) {
    w.sphere_radius_m = t->number("radius_mm") * kMillimetre;
    t->finish();
  }
  if (auto t = table.table("box")) {
    w.box_size_m = t->vector3("size_mm") * kMillimetre;
    t->finish();
  }
  if (auto t = table.table("plate")) {
    w.plate_thickness_m = t->number("thickness_mm") * kMillimetre;
    w.plate_tilt = t->number("tilt_deg") * kDegree;
    t->finish();
  }
  if (auto t = table.table("torus")) {
    w.torus_major_m = t->number("major_mm") * kMillimetre;
    w.torus_minor_m = t->number("minor_mm") * kMillimetre;
    if (w.torus_minor_m >= w.torus_major_m) {
      t->fail("minor_mm", "a tube as thick as its ring",
              "less than major_mm (3 and 1 unless said)");
    }
    t->finish();
  }
  if (auto t = table.table("groove")) {
    w.groove_angle = t->number("angle_deg") * kDegree;
    w.groove_depth_m = t->number("depth_mm") * kMillimetre;
    t->finish();
  }
}

/// Which part of a volume is taken.
void read_part(SceneTable& table, WorkpieceSettings& w) {
  if (const std::vector<double> box = table.numbers_if("box_mm"); !box.empty()) {
    const Eigen::Vector3d low(box.data()), high(box.data() + 3);
    if ((low.array() >= high.array()).any()) {
      table.fail("box_mm", "a corner that is not below the other",
                 "[x0, y0, z0, x1, y1, z1] with x0 < x1, y0 < y1, z0 < z1");
    }
    w.box_file = Eigen::AlignedBox3d(low * kMillimetre, high * kMillimetre);
  }
  w.labels = table.path("labels");
  w.label = table.whole_if("label");
  if (!w.labels.empty() && !w.label) table.fail("labels", "no label", "label = N beside it");
  if (w.label && w.labels.empty() && w.solid_above) {
    table.fail("label", "solid_above, and no labels",
               "labels = \"FILE\", or a label map without solid_above");
  }
}

/// In what a mesh's numbers are, where the table says it; a volume has its own spacing.
MeshUnit read_unit(SceneTable& table, const std::string& file) {
  const auto unit = MeshUnit(table.choice("unit"));
  if (table.has("unit") && !is_mesh_file(file)) {
    table.fail("unit", file.empty() ? "a unit beside a built-in shape" : "a unit beside a volume",
               "it beside a mesh, .stl, .obj or .ply; a volume has spacing_mm");
  }
  return unit;
}

/// What becomes voxels, of the workpiece or of another body.
WorkpieceSettings read_solid(SceneTable& table) {
  WorkpieceSettings w;
  if (const auto shape = table.choice_if("shape")) w.shape = ShapeKind(*shape);
  w.file = table.path("file");
  if (w.shape.has_value() == !w.file.empty()) {
    table.fail("shape", w.shape ? "both a shape and a file" : "neither a shape nor a file",
               "one of them");
  }
  w.unit = read_unit(table, w.file);
  read_shape_tables(table, w);
  w.solid_above = table.number_if("solid_above");
  if (const std::vector<double> spacing = table.numbers_if("spacing_mm"); !spacing.empty()) {
    w.spacing_m = Eigen::Vector3d(spacing.data()) * kMillimetre;
  }
  read_part(table, w);
  w.surface = SurfaceKind(table.choice("surface"));
  w.voxel_m = table.number("voxel_mm") * kMillimetre;
  const Eigen::Vector3d n = table.vector3("cells");
  for (int a = 0; a < 3; ++a) {
    w.cells[a] = static_cast<int>(n[a]);
    if (n[a] != w.cells[a] || w.cells[a] % kLeafEdge != 0) {
      std::ostringstream found;
      found << n[a];
      table.fail("cells", found.str(), "multiples of 8, at most 1024 each");
    }
  }
  w.position_m = table.vector3("position_mm") * kMillimetre;
  w.rotation = table.vector3("rotation_deg") * kDegree;
  return w;
}

}  // namespace

WorkpieceSettings read_workpiece(SceneTable& root) {
  auto table = root.table("workpiece");
  if (!table) root.fail("workpiece", "no such table", "[workpiece] with a shape or a file");
  const WorkpieceSettings w = read_solid(*table);
  table->finish();
  return w;
}

std::vector<BodySettings> read_bodies(SceneTable& root,
                                      const std::vector<TissueSettings>& tissues) {
  std::vector<SceneTable> tables = root.tables("body");
  if (tables.size() > kMaxBodies) {
    root.fail("body", std::to_string(tables.size()), "at most " + std::to_string(kMaxBodies));
  }
  std::vector<BodySettings> bodies;
  for (SceneTable& table : tables) {
    BodySettings& b = bodies.emplace_back();
    b.name = table.text("name", "body " + std::to_string(bodies.size()));
    b.solid = read_solid(table);
    b.world_from_grid = {b.solid.position_m, rotation_xyz(b.solid.rotation)};
    b.solid.position_m = b.solid.rotation = Eigen::Vector3d::Zero();
    b.cuttable = table.boolean("cuttable");
    if (b.cuttable && !root.has("cutting")) {
      table.fail("cuttable", "a cuttable body without [cutting]", "both of them");
    }
    if (const std::string name = table.text("tissue", ""); !name.empty()) {
      const auto found = std::ranges::find(tissues, name, &TissueSettings::name);
      if (found == tissues.end()) table.fail("tissue", "'" + name + "'", "a tissue of the scene");
      b.tissue = static_cast<std::size_t>(found - tissues.begin());
    }
    for (std::size_t other = 0; other + 1 < bodies.size(); ++other) {
      if (bodies[other].name == b.name) {
        table.fail("name", "'" + b.name + "' twice", "names that differ");
      }
    }
    table.finish();
  }
  return bodies;
}

GoalSettings read_goal(SceneTable& table) {
  GoalSettings g;
  const auto shape = table.choice_if("shape");
  g.file = table.path("file");
  if (shape.has_value() == !g.file.empty()) {
    table.fail("shape", shape ? "both a shape and a file" : "neither a shape nor a file",
               "box, cylinder, or a file");
  }
  g.unit = read_unit(table, g.file);
  g.position_m = table.vector3("position_mm") * kMillimetre;
  g.rotation = table.vector3("rotation_deg") * kDegree;
  if (!shape) {
    g.shape = GoalShape::kFile;
    g.solid_above = table.number_if("solid_above");
    table.finish();
    return g;
  }
  g.shape = GoalShape(*shape);
  const std::vector<double> size_mm = table.numbers_if("size_mm");
  const auto diameter_mm = table.number_if("diameter_mm");
  const auto depth_mm = table.number_if("depth_mm");
  const bool is_box = g.shape == GoalShape::kBox;
  if (is_box == size_mm.empty() || is_box == diameter_mm.has_value() ||
      is_box == depth_mm.has_value()) {
    table.fail("shape", is_box ? "a box with other sizes" : "a cylinder with other sizes",
               is_box ? "size_mm, and it alone" : "diameter_mm and depth_mm, and them alone");
  }
  if (is_box) g.size_m = Eigen::Vector3d(size_mm.data()) * kMillimetre;
  g.diameter_m = diameter_mm.value_or(0.0) * kMillimetre;
  g.depth_m = depth_mm.value_or(0.0) * kMillimetre;
  g.taper = table.number("taper_deg") * kDegree;
  const double height_m = is_box ? g.size_m.z() : g.depth_m;
  const double width_m = is_box ? std::min(g.size_m.x(), g.size_m.y()) : g.diameter_m;
  if (std::tan(std::abs(g.taper)) * height_m >= width_m) {
    table.fail("taper_deg", "walls that meet inside", "a smaller angle for this size");
  }
  table.finish();
  return g;
}

}  // namespace sulcus
