#include "engine/scene/scene_file.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/core/error.hpp"
#include "engine/core/input_limits.hpp"
#include "engine/core/mesh_extension.hpp"
#include "engine/core/units.hpp"
#include "engine/normals/normal_choice.hpp"
#include "engine/scene/burr_number.hpp"
#include "engine/scene/device_tables.hpp"
#include "engine/scene/scene_overrides.hpp"
#include "engine/scene/scene_table.hpp"
#include "engine/scene/tissue_table.hpp"
#include "engine/scene/toml_depth.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

namespace {

Eigen::Vector3d vector3(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

// --- [workpiece] --------------------------------------------------------------------------------

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
    const Eigen::Vector3d low(box[0], box[1], box[2]), high(box[3], box[4], box[5]);
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

/// What becomes voxels, of the workpiece or of another body.
WorkpieceSettings read_solid(SceneTable& table) {
  WorkpieceSettings w;
  if (const auto shape = table.choice_if("shape")) w.shape = ShapeKind(*shape);
  w.file = table.path("file");
  if (w.shape.has_value() == !w.file.empty()) {
    table.fail("shape", w.shape ? "both a shape and a file" : "neither a shape nor a file",
               "one of them");
  }
  read_shape_tables(table, w);
  w.solid_above = table.number_if("solid_above");
  if (const std::vector<double> spacing = table.numbers_if("spacing_mm"); !spacing.empty()) {
    w.spacing_m = vector3(spacing) * kMillimetre;
  }
  read_part(table, w);
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

WorkpieceSettings read_workpiece(SceneTable& root) {
  auto table = root.table("workpiece");
  if (!table) root.fail("workpiece", "no such table", "[workpiece] with a shape or a file");
  const WorkpieceSettings w = read_solid(*table);
  table->finish();
  return w;
}

// --- [[tissue]] ---------------------------------------------------------------------------------

/// Behind a coupling a contact may be far stiffer than a device could render: grooves then hold.
constexpr double kStifferBehindCoupling = 10.0;

/// `other`: what one that is not known starts from.
TissueSettings read_tissue(SceneTable& table, const std::vector<TissueSettings>& known,
                           const TissueSettings& other) {
  TissueSettings t = other;
  t.name = table.text("name", "");
  if (t.name.empty()) table.fail("name", "none", "a name such as \"enamel\"");
  for (const TissueSettings& k : known) {
    if (k.name == t.name) t = k;  // a known name brings its constants
  }
  t.above = table.number_if("above");
  t.label = table.whole_if("label");
  t.file = table.path("file");
  t.stiffness_N_per_m =
      table.number("stiffness_N_per_mm", t.stiffness_N_per_m / kNewtonPerMillimetre) *
      kNewtonPerMillimetre;
  t.specific_energy_J_per_m3 =
      table.number("specific_energy_J_per_mm3", t.specific_energy_J_per_m3 / kJoulePerMm3) *
      kJoulePerMm3;
  const std::vector<double> colour = table.numbers_if("colour");
  for (std::size_t c = 0; c < colour.size(); ++c) t.colour[c] = static_cast<float>(colour[c]);
  table.finish();
  return t;
}

/// The tissues of assets/tissues.toml.
std::vector<TissueSettings> known_tissues() {
  const toml::table parsed =
      toml::parse(tissue_table_toml(), std::string_view("assets/tissues.toml"));
  SceneTable root(TomlTable(parsed, "assets/tissues.toml", ""), "");
  std::vector<TissueSettings> all;
  for (SceneTable& table : root.tables("tissue")) all.push_back(read_tissue(table, {}, {}));
  return all;
}

/// A tissue's own mesh stands beside the first one's, which is the workpiece's.
void check_tissue_file(const SceneTable& table, const TissueSettings& t, bool first,
                       const WorkpieceSettings& w) {
  if (t.file.empty()) return;
  if (t.above) table.fail("file", "both above and a file", "one of them");
  if (w.shape) table.fail("file", "a file beside a workpiece that is a shape", "a mesh of both");
  if (!is_mesh_file(w.file)) {
    table.fail("file", "a file beside a workpiece that is a volume", "above, or a mesh of both");
  }
  if (!is_mesh_file(t.file)) {
    table.fail("file", "no mesh ('" + std::filesystem::path(t.file).filename().string() + "')",
               ".stl, .obj or .ply");
  }
  if (first) {
    table.fail("file", "a file of the first tissue", "none: workpiece.file is its surface");
  }
}

std::vector<TissueSettings> read_tissues(SceneTable& root, const WorkpieceSettings& workpiece) {
  std::vector<TissueSettings> known = known_tissues();
  TissueSettings other;
  if (root.has("coupling")) {
    for (TissueSettings& t : known) t.stiffness_N_per_m *= kStifferBehindCoupling;
    other.stiffness_N_per_m *= kStifferBehindCoupling;
  }
  std::vector<TissueSettings> tissues;
  if (const std::vector<std::string> names = root.strings("tissue"); !names.empty()) {
    for (const std::string& name : names) {
      const auto found = std::find_if(known.begin(), known.end(),
                                      [&](const TissueSettings& t) { return t.name == name; });
      if (found == known.end()) {
        root.fail("tissue", "'" + name + "'", "enamel, dentine, pulp or caries, or a [[tissue]]");
      }
      tissues.push_back(*found);
    }
  } else {
    for (SceneTable& table : root.tables("tissue")) {
      tissues.push_back(read_tissue(table, known, other));
      check_tissue_file(table, tissues.back(), tissues.size() == 1, workpiece);
    }
  }
  if (tissues.empty()) tissues.push_back(known.front());  // one tissue, no labels
  if (tissues.size() > 255) root.fail("tissue", std::to_string(tissues.size()), "at most 255");
  for (std::size_t i = 0; i < tissues.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (tissues[i].name == tissues[j].name) {
        root.fail("tissue", "'" + tissues[i].name + "' twice", "names that differ");
      }
      if (tissues[i].label && tissues[i].label == tissues[j].label) {
        root.fail("tissue", "label " + std::to_string(*tissues[i].label) + " twice",
                  "labels that differ");
      }
    }
  }
  const bool labels = std::ranges::any_of(tissues, [](const auto& t) { return !!t.label; });
  const bool greys = std::ranges::any_of(tissues, [](const auto& t) { return !!t.above; });
  if (labels && greys) root.fail("tissue", "above and label in one scene", "one of them");
  return tissues;
}

// --- [[body]] -----------------------------------------------------------------------------------

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

// --- [burr], [trajectory], [haptics] ------------------------------------------------------------

/// What the number says, where the table names one; what else is said of the shape must agree.
void apply_burr_number(SceneTable& table, BurrSettings& b) {
  const std::string text = table.text("iso", "");
  if (!table.has("iso")) return;
  BurrNumberFault fault;
  const std::optional<BurrNumber> number = read_burr_number(text, fault);
  if (!number) table.fail("iso", fault.found, fault.expected);
  const auto refuse = [&](std::string_view key) {
    table.fail(key, "another one than burr.iso's, \"" + text + "\"", "one of the two");
  };
  const auto differ = [](double a, double b_m) { return std::abs(a - b_m) > 1e-9; };
  if (table.has("file")) refuse("file");
  if (table.has("shape") && b.shape != number->shape) refuse("shape");
  if (table.has("diameter_mm") && differ(b.diameter_m, number->diameter_m)) refuse("diameter_mm");
  if (b.length_m && number->length_m && differ(*b.length_m, *number->length_m)) {
    refuse("length_mm");
  }
  b.shape = number->shape;
  b.diameter_m = number->diameter_m;
  if (number->length_m) b.length_m = number->length_m;
}

BurrSettings read_burr(SceneTable& root) {
  BurrSettings b;
  auto table = root.table("burr");
  if (!table) return b;
  b.file = table->path("file");
  const auto shape = table->choice_if("shape");
  if (shape && !b.file.empty()) table->fail("shape", "both a shape and a file", "one of them");
  if (!b.file.empty()) b.shape = BurrShape::kFile;
  if (shape) b.shape = BurrShape(*shape);
  b.diameter_m = table->number("diameter_mm") * kMillimetre;
  if (const auto length = table->number_if("length_mm")) {
    b.length_m = *length * kMillimetre;
  }
  apply_burr_number(*table, b);
  b.speed_rad_per_s = table->number("speed_rpm") * kRevolutionPerMinute;
  b.tangential_ratio = table->number("tangential_ratio");
  if (table->is_text("field")) {
    table->expect_word("field", "auto");
    b.field_samples.reset();
  } else {
    const Eigen::Vector3d n = table->vector3("field");
    b.field_samples = n.cast<int>();
    if (b.field_samples->cast<double>() != n) {
      table->fail("field", "fractions", "3 whole numbers, or \"auto\"");
    }
  }
  if (const auto spacing = table->number_if("field_spacing_mm")) {
    b.field_spacing_m = *spacing * kMillimetre;
  }
  b.reference_m = table->number("reference_mm") * kMillimetre;
  table->finish();
  return b;
}

TrajectorySettings read_trajectory(SceneTable& root) {
  TrajectorySettings t;
  auto table = root.table("trajectory");
  if (!table) root.fail("trajectory", "no such table", "[trajectory] with points_mm or a file");
  for (const auto& p : table->rows("points_mm")) {
    t.points_m.push_back(vector3(p) * kMillimetre);
  }
  t.file = table->path("file");
  t.recording = table->path("recording");
  std::string sources;
  const std::pair<bool, const char*> named[] = {{!t.points_m.empty(), "points"},
                                                {!t.file.empty(), "a file"},
                                                {!t.recording.empty(), "a recording"}};
  int count = 0;
  for (const auto& [is_there, name] : named) {
    if (is_there) sources += (count++ == 0 ? "both " : " and ") + std::string(name);
  }
  if (count != 1) {
    table->fail("points_mm", count == 0 ? "neither points nor a file" : sources, "one of them");
  }
  t.axis = table->direction("axis");
  t.speed_m_per_s = table->number("speed_mm_per_s") * kMillimetre;
  t.hold_s = table->number("hold_s");
  t.load_N = table->number_if("load_N");
  if (const auto direction = table->direction_if("load_direction")) {
    if (!t.load_N) table->fail("load_direction", "a direction without load_N", "both of them");
    t.load_direction = *direction;
  }
  table->finish();
  return t;
}

/// The cheapest normals that meet haptics.normal_error_deg, where a scene names it.
void read_normal_error(SceneTable& table, HapticsSettings& h) {
  h.normal_error_deg = table.number_if("normal_error_deg");
  if (!h.normal_error_deg) return;
  for (const std::string_view key : {"normals", "neighbourhood", "trace"}) {
    if (table.has(key)) {
      table.fail(key, std::string(key) + " beside normal_error_deg", "one of them");
    }
  }
  const std::optional<NormalChoice> choice = choose_normals(*h.normal_error_deg);
  if (!choice) {
    const NormalChoice best = most_accurate_normals();
    std::ostringstream found, expected;
    found << *h.normal_error_deg;
    expected << best.error_deg << " or more, which normals = \""
             << kNormalMethodNames[static_cast<std::size_t>(best.normals)]
             << "\" with neighbourhood = " << best.neighbourhood << " meets, the best that can be";
    table.fail("normal_error_deg", found.str(), expected.str());
  }
  static_cast<NormalSettings&>(h) = *choice;
}

/// Where a scene names none: see NormalSettings::neighbourhood.
int usual_neighbourhood(NormalMethod normals, bool coupled) {
  const bool ours = normals == NormalMethod::kLdm || normals == NormalMethod::kLdmFast;
  return coupled && ours ? 10 : NormalSettings{}.neighbourhood;
}

HapticsSettings read_haptics(SceneTable& root) {
  HapticsSettings h;
  auto table = root.table("haptics");
  if (!table) {
    h.neighbourhood = usual_neighbourhood(h.normals, root.has("coupling"));
    return h;
  }
  h.rate_hz = table->number("rate_hz");
  h.normals = NormalMethod(table->choice("normals"));
  h.neighbourhood =
      table->whole("neighbourhood", usual_neighbourhood(h.normals, root.has("coupling")));
  h.trace = table->whole("trace", h.normals == NormalMethod::kLdmPaper ? 5 : 12);
  read_normal_error(*table, h);
  h.scaling = Scaling(table->choice("scaling"));
  h.keep_normals = table->boolean("keep_normals");
  h.refine_per_tick = table->whole("refine_per_tick");
  h.max_contacts = table->whole("max_contacts");
  table->finish();
  return h;
}

// --- [goal] -------------------------------------------------------------------------------------

GoalSettings read_goal(SceneTable& table) {
  GoalSettings g;
  const auto shape = table.choice_if("shape");
  g.file = table.path("file");
  if (shape.has_value() == !g.file.empty()) {
    table.fail("shape", shape ? "both a shape and a file" : "neither a shape nor a file",
               "box, cylinder, or a file");
  }
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
  if (is_box) g.size_m = vector3(size_mm) * kMillimetre;
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

// --- [device], [coupling] -----------------------------------------------------------------------

void read_device_tables(SceneTable& root, Scene& scene) {
  if (auto table = root.table("device")) {
    scene.device = read_device(*table, scene.haptics.rate_hz);
    if (scene.device->played_back && scene.trajectory.recording.empty()) {
      table->fail("model", "\"played_back\", and no recording in [trajectory]", "both of them");
    }
  }
  if (auto table = root.table("coupling")) scene.coupling = read_coupling(*table, scene.device);
  for (const auto& [key, has] : {std::pair{"device", scene.device.has_value()},
                                 std::pair{"coupling", scene.coupling.has_value()}}) {
    if (has && scene.trajectory.load_N) {
      root.fail(key, std::string("[") + key + "] beside trajectory.load_N", "one of them");
    }
  }
}

// --- The optional tables ------------------------------------------------------------------------

void read_optional_tables(SceneTable& root, Scene& scene) {
  if (auto table = root.table("cutting")) {
    CuttingSettings& c = scene.cutting.emplace();
    c.max_cut_voxels = table->whole("max_cut_voxels");
    table->finish();
  }
  if (auto table = root.table("spindle")) {
    if (!scene.cutting) root.fail("spindle", "[spindle] without [cutting]", "both, or neither");
    SpindleSettings& s = scene.spindle.emplace();
    s.stall_torque_Nm = table->number("stall_torque_mNm") * 1e-3;
    s.inertia_kg_m2 = table->number("inertia_g_mm2") * 1e-9;
    table->finish();
  }
  if (auto table = root.table("loose_pieces")) {
    if (!scene.cutting) {
      root.fail("loose_pieces", "[loose_pieces] without [cutting]", "both, or neither");
    }
    LoosePiecesSettings& p = scene.loose_pieces.emplace();
    p.smallest_m3 = table->number("smallest_mm3") * 1e-9;
    p.friction = table->number("friction");
    if (const auto floor = table->number_if("floor_mm")) {
      p.floor_m = *floor * kMillimetre;
    }
    table->finish();
  }
  if (auto table = root.table("goal")) {
    if (!scene.cutting) root.fail("goal", "[goal] without [cutting]", "both of them");
    scene.goal = read_goal(*table);
  }
  if (auto table = root.table("render")) {
    RenderSettings& r = scene.render.emplace();
    const std::vector<double> size = table->numbers("size");
    r.width = static_cast<int>(size[0]);
    r.height = static_cast<int>(size[1]);
    r.fps = table->number("fps");
    r.camera = Camera(table->choice("camera"));
    r.hud = table->boolean("hud");
    r.arrows = table->boolean("arrows");
    if (const std::string text = table->text("section", ""); !text.empty()) {
      r.section = parse_section(text);
      if (!r.section) table->fail("section", "'" + text + "'", kSectionForm);
    }
    table->finish();
  }
  if (auto table = root.table("record")) {
    scene.record.emplace();
    scene.record->queue_s = table->number("queue_s");
    table->finish();
  }
}

std::string read_text(const std::string& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw InputError(file, "", "a folder", "a scene file, .toml");
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file, "", "no readable file", "a scene file, .toml");
  // Never more than may be: a pipe or a device has no size to ask for.
  std::string text(InputLimits::kSceneBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > InputLimits::kSceneBytes) {
    throw InputError(file, "", "more than 16 MiB", "a scene of at most 16 MiB");
  }
  return text;
}

}  // namespace

Scene load_scene(const std::string& file, std::span<const std::string> overrides,
                 const InputLimits& limits) {
  return parse_scene(read_text(file), file, overrides, limits);
}

Scene parse_scene(const std::string& text, const std::string& file,
                  std::span<const std::string> overrides, const InputLimits& limits) {
  check_toml_depth(text, file);
  toml::table parsed;
  try {
    parsed = toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    const toml::source_region& at = error.source();
    throw InputError(
        file,
        "line " + std::to_string(at.begin.line) + ", column " + std::to_string(at.begin.column),
        "what is no TOML (" + std::string(error.description()) + ")", "a scene");
  }
  for (const std::string& override_text : overrides) apply_override(parsed, override_text);

  Scene scene;
  scene.file = file;
  scene.text = text;
  scene.limits = limits;
  if (!overrides.empty()) {
    std::ostringstream changed;
    changed << parsed << '\n';
    scene.text = changed.str();
  }
  SceneTable root(TomlTable(parsed, file, ""), "");
  scene.title = root.text("title", std::filesystem::path(file).stem().string());
  scene.workpiece = read_workpiece(root);
  scene.tissues = read_tissues(root, scene.workpiece);
  if (scene.workpiece.solid_above &&
      std::ranges::any_of(scene.tissues, [](const auto& t) { return !!t.label; })) {
    root.fail("tissue", "label, and solid_above in [workpiece]",
              "above for grey values, label for a label map");
  }
  scene.burr = read_burr(root);
  scene.trajectory = read_trajectory(root);
  scene.haptics = read_haptics(root);
  scene.bodies = read_bodies(root, scene.tissues);
  read_device_tables(root, scene);
  read_optional_tables(root, scene);
  root.finish();
  return scene;
}

}  // namespace sulcus
