#include <cmath>
#include <filesystem>
#include <sstream>

#include "engine/core/units.hpp"
#include "engine/scene/burr_number.hpp"
#include "engine/scene/scene_keys.hpp"
#include "engine/scene/table_readers.hpp"
#include "engine/scene/toml_table.hpp"

namespace sulcus {

namespace {

/// What the number says, where the table names one; what else is said of the shape must agree.
void apply_burr_number(SceneTable& table, bool saturates, BurrSettings& b) {
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
  if (table.has("material") && number->material && b.material != number->material) {
    refuse("material");
  }
  if (table.has("grit") && number->grit && b.grit != number->grit) refuse("grit");
  if (saturates && !number->unknown.empty() && !table.has("material") && !table.has("grit")) {
    table.fail("iso", number->unknown,
               "806 and 514, 524, 534 or 544, a diamond; 500, carbide; else burr.material or "
               "burr.grit beside it");
  }
  b.shape = number->shape;
  b.diameter_m = number->diameter_m;
  if (number->length_m) b.length_m = number->length_m;
  if (number->material) b.material = *number->material;
  if (number->grit) b.grit = *number->grit;
}

std::string name_of(const BurrSettings& burr) {
  if (burr.shape == BurrShape::kFile) return std::filesystem::path(burr.file).stem().string();
  std::ostringstream name;
  name << find_scene_key("burr", "shape")->words[static_cast<std::size_t>(burr.shape)] << ' '
       << burr.diameter_m / kMillimetre << " mm";
  return name.str();
}

/// [burr] with the spare one in its place: of the first what does not say which burr it is.
toml::table in_its_place(const toml::table& burr, const toml::table& spare) {
  toml::table both = burr;
  for (const char* which : {"shape", "file", "unit", "iso", "diameter_mm", "length_mm", "material",
                            "grit", "worn_mm"}) {
    both.erase(which);
  }
  for (const auto& [key, value] : spare) {
    if (key != "name") both.insert_or_assign(key, value);
  }
  return both;
}

}  // namespace

BurrSettings read_burr(SceneTable& table, bool saturates, BurrSettings b) {
  b.file = table.path("file");
  const auto shape = table.choice_if("shape");
  if (shape && !b.file.empty()) table.fail("shape", "both a shape and a file", "one of them");
  if (!b.file.empty()) b.shape = BurrShape::kFile;
  b.unit = MeshUnit(table.choice("unit"));
  if (b.file.empty() && table.has("unit")) {
    table.fail("unit", "a unit beside no file", "both of them");
  }
  if (shape) b.shape = BurrShape(*shape);
  b.diameter_m = table.number("diameter_mm") * kMillimetre;
  if (const auto length = table.number_if("length_mm")) {
    b.length_m = *length * kMillimetre;
  }
  if (const auto material = table.choice_if("material")) b.material = BurrMaterial(*material);
  if (const auto grit = table.choice_if("grit")) b.grit = Grit(*grit);
  b.worn_m = table.number("worn_mm") * kMillimetre;
  apply_burr_number(table, saturates, b);
  if (const auto speed = table.number_if("speed_rpm")) {
    b.speed_rad_per_s = *speed * kRevolutionPerMinute;
  }
  b.tangential_ratio = table.number("tangential_ratio", b.tangential_ratio);
  if (table.is_text("field")) {
    table.expect_word("field", "auto");
    b.field_samples.reset();
  } else {
    const Eigen::Vector3d n = table.vector3("field");
    b.field_samples = n.cast<int>();
    if (b.field_samples->cast<double>() != n) {
      table.fail("field", "fractions", "3 whole numbers, or \"auto\"");
    }
  }
  if (const auto spacing = table.number_if("field_spacing_mm")) {
    b.field_spacing_m = *spacing * kMillimetre;
  }
  b.reference_m = table.number("reference_mm") * kMillimetre;
  table.finish();
  return b;
}

std::vector<BurrChoice> read_burrs(SceneTable& root, const toml::table& scene,
                                   const std::string& file, bool saturates,
                                   const BurrSettings& usual) {
  constexpr std::size_t kMost = 15;
  std::vector<SceneTable> spares = root.tables("spare_burr");
  if (spares.empty()) return {};
  if (spares.size() > kMost) {
    root.fail("spare_burr", std::to_string(spares.size()), "at most " + std::to_string(kMost));
  }
  const toml::table* const named = scene["burr"].as_table();
  const toml::table burr = named ? *named : toml::table();
  std::vector<BurrChoice> choices;
  const auto add = [&](toml::table both, const std::string& place, std::string name) {
    SceneTable table(TomlTable(both, file, place), "burr");
    const BurrSettings read = read_burr(table, saturates, usual);
    if (name.empty()) name = name_of(read);
    if (!read.file.empty()) both.insert_or_assign("file", read.file);  // from wherever it is read
    both.is_inline(true);
    std::ostringstream text;
    text << "burr=" << both;
    choices.push_back({std::move(name), text.str()});
  };
  add(burr, "burr", "");
  const toml::array& tables = *scene["spare_burr"].as_array();
  for (std::size_t i = 0; i < spares.size(); ++i) {
    std::string name = spares[i].text("name", "");
    (void)read_burr(spares[i], saturates, usual);  // what is wrong with it alone, and where
    add(in_its_place(burr, *tables[i].as_table()), "spare_burr", std::move(name));
  }
  return choices;
}

}  // namespace sulcus
