#include <algorithm>
#include <filesystem>

#include "engine/core/file_kind.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/table_readers.hpp"

namespace sulcus {

namespace {

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

}  // namespace

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

}  // namespace sulcus
