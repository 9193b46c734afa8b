#include "engine/scene/scene_file.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/core/error.hpp"
#include "engine/core/input_limits.hpp"
#include "engine/core/units.hpp"
#include "engine/normals/normal_choice.hpp"
#include "engine/scene/handpiece_presets.hpp"
#include "engine/scene/table_readers.hpp"
#include "engine/scene/toml_table.hpp"

namespace sulcus {

namespace {

// --- [trajectory], [haptics] --------------------------------------------------------------------

TrajectorySettings read_trajectory(SceneTable& root) {
  TrajectorySettings t;
  auto table = root.table("trajectory");
  if (!table) root.fail("trajectory", "no such table", "[trajectory] with points_mm or a file");
  for (const auto& p : table->rows("points_mm")) {
    t.points_m.push_back(Eigen::Vector3d(p.data()) * kMillimetre);
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
  table->whole("refine_per_tick");  // of earlier scenes and recordings; without effect
  h.max_contacts = table->whole("max_contacts");
  table->finish();
  return h;
}

/// Fractions are read by the ldm methods alone: to the others a voxel that is hardly filled is one.
void check_normals(const SceneTable& root, const Scene& scene) {
  const auto has_fractions = [](const WorkpieceSettings& solid) {
    return solid.surface == SurfaceKind::kFractions;
  };
  const NormalMethod method = scene.haptics.normals;
  if (method == NormalMethod::kLdm || method == NormalMethod::kLdmFast ||
      !(has_fractions(scene.workpiece) ||
        std::ranges::any_of(scene.bodies, has_fractions, &BodySettings::solid))) {
    return;
  }
  root.fail("haptics",
            "normals = \"" + std::string(kNormalMethodNames[static_cast<std::size_t>(method)]) +
                "\" for surface = \"fractions\"",
            "ldm or ldm_fast");
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

// --- [cutting], [spindle]: before [burr], whose defaults they set --------------------------------

std::optional<CuttingSettings> read_cutting(SceneTable& root) {
  auto table = root.table("cutting");
  if (!table) return {};
  CuttingSettings c;
  c.law = CuttingLaw(table->choice("law"));
  c.max_cut_voxels = table->whole("max_cut_voxels");
  table->finish();
  return c;
}

/// The spindle of a scene, and the speed of its preset, where it names one, to `free_rad_per_s`.
std::optional<SpindleSettings> read_spindle(SceneTable& root, double& free_rad_per_s) {
  auto table = root.table("spindle");
  if (!table) return {};
  if (!root.has("cutting")) root.fail("spindle", "[spindle] without [cutting]", "both, or neither");
  SpindleSettings s;
  if (const auto preset = table->choice_if("preset")) {
    const HandpiecePreset& handpiece = handpiece_presets()[*preset];
    s = handpiece.spindle;
    free_rad_per_s = handpiece.free_rad_per_s;
  }
  if (const auto stall = table->number_if("stall_torque_mNm")) s.stall_torque_Nm = *stall * 1e-3;
  if (const auto inertia = table->number_if("inertia_g_mm2")) s.inertia_kg_m2 = *inertia * 1e-9;
  s.droop = table->number("droop", s.droop);
  if (const auto power_W = table->number_if("power_W")) s.power_W = power_W;
  table->finish();
  return s;
}

// --- The other optional tables ------------------------------------------------------------------

HeatSettings read_heat(SceneTable& table, const WorkpieceSettings& workpiece) {
  HeatSettings h;
  h.cell_m = table.number("cell_mm") * kMillimetre;
  h.start_C = table.number("start_C");
  h.tooth_share = table.number("tooth_share");
  h.water_m3_per_s = table.number("water_ml_min") * kMillilitrePerMinute;
  h.water_C = table.number("water_C");
  h.spray = Spray(table.choice("spray"));
  h.air_C = table.number("air_C");
  if (const auto gum = table.number_if("gum_mm")) h.gum_m = *gum * kMillimetre;
  constexpr std::int64_t kMostCells = 1 << 24;
  const int edge = h.cell_voxels(workpiece.voxel_m);
  const std::int64_t cells =
      ((workpiece.cells.array() + (edge - 1)) / edge).cast<std::int64_t>().prod();
  if (cells > kMostCells) {
    table.fail("cell_mm", std::to_string(cells) + " cells",
               "larger ones: at most " + std::to_string(kMostCells) + " of them");
  }
  table.finish();
  return h;
}

/// [goal]: a cavity, a distance to the pulp, or both.
void read_goals(SceneTable& table, Scene& scene) {
  if (const auto distance_mm = table.number_if("pulp_distance_mm")) {
    scene.least_pulp_distance_m = *distance_mm * kMillimetre;
    if (std::ranges::find(scene.tissues, "pulp", &TissueSettings::name) == scene.tissues.end()) {
      table.fail("pulp_distance_mm", "no tissue named pulp", "one beside it");
    }
    if (!table.has("shape") && !table.has("file")) return table.finish();
  }
  scene.goal = read_goal(table);
}

void read_optional_tables(SceneTable& root, Scene& scene) {
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
    read_goals(*table, scene);
  }
  if (auto table = root.table("assessment")) {
    if (!scene.cutting) root.fail("assessment", "[assessment] without [cutting]", "both of them");
    (void)read_assessment(*table);  // a run has no use for it: assessment_of() reads it again
  }
  if (auto table = root.table("heat")) {
    if (!scene.cutting) root.fail("heat", "[heat] without [cutting]", "both of them");
    scene.heat = read_heat(*table, scene.workpiece);
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
  if (auto table = root.table("stream")) scene.stream = read_stream(*table);
}

}  // namespace

std::string read_scene_text(const std::string& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    throw InputError(file, "", "a folder", "a scene file, .toml");
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file, "", "no readable file", "a scene file, .toml");
  // Never more than may be: a pipe or a device has no size to ask for.
  std::string text(InputLimits::kSceneBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (in.bad()) {
    throw InputError(file, "", "a file that cannot be read to its end", "a scene file, .toml");
  }
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.starts_with("\x89HDF")) {
    throw InputError(file, "", "HDF5, as of a recording", "a scene file, .toml");
  }
  if (text.size() > InputLimits::kSceneBytes) {
    throw InputError(file, "", "more than 16 MiB", "a scene of at most 16 MiB");
  }
  return text;
}

Scene load_scene(const std::string& file, std::span<const std::string> overrides,
                 const InputLimits& limits) {
  return parse_scene(read_scene_text(file), file, overrides, limits);
}

Scene parse_scene(const std::string& text, const std::string& file,
                  std::span<const std::string> overrides, const InputLimits& limits) {
  toml::table parsed = parse_toml(text, file, "a scene");
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
  scene.cutting = read_cutting(root);
  BurrSettings usual;
  scene.spindle = read_spindle(root, usual.speed_rad_per_s);
  const bool saturates = scene.cutting && scene.cutting->law == CuttingLaw::kSaturating;
  if (saturates) usual.tangential_ratio = kSaturatingTangentialRatio;
  scene.burr = usual;
  if (auto table = root.table("burr")) scene.burr = read_burr(*table, saturates, usual);
  scene.burrs = read_burrs(root, parsed, file, saturates, usual);
  scene.trajectory = read_trajectory(root);
  scene.haptics = read_haptics(root);
  scene.bodies = read_bodies(root, scene.tissues);
  check_normals(root, scene);
  read_device_tables(root, scene);
  read_optional_tables(root, scene);
  root.finish();
  return scene;
}

}  // namespace sulcus
