#include "engine/scene/scene_keys.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/scene/scene_table.hpp"
#include "tests/support/scene_text.hpp"

namespace sulcus::scene_keys_test {
namespace {

using test::error_of;

struct Line {
  std::string table, key, value;
};

/// A scene that has every table and is taken.
std::vector<Line> whole_scene() {
  return {{"workpiece", "shape", "'molar'"},
          {"tissue", "name", "'enamel'"},
          {"trajectory", "points_mm", "[[0, 0, 9]]"},
          {"body", "shape", "'box'"},
          {"device", "model", "'simulated'"},
          {"goal", "shape", "'box'"},
          {"goal", "size_mm", "[1, 1, 1]"}};
}

/// As TOML, tables in the order of the reader; those of the workpiece's shapes below [[body]] too.
/// `omitted`: a table that is left out, with those in it.
std::string text_of(const std::vector<Line>& lines, const std::string& omitted = {}) {
  std::string text;
  const auto add = [&](const std::string& name, bool repeated) {
    if (!omitted.empty() && (name == omitted || name.starts_with(omitted + "."))) return;
    if (!name.empty()) text += repeated ? "[[" + name + "]]\n" : "[" + name + "]\n";
    for (const Line& line : lines) {
      if (line.table == name) text += line.key + " = " + line.value + "\n";
    }
  };
  for (const SceneTableKeys& table : scene_tables()) {
    add(std::string(table.name), table.repeated);
    if (table.inherits_from.empty()) continue;
    for (const SceneTableKeys& other : scene_tables()) {
      const std::string beginning = std::string(table.inherits_from) + ".";
      if (!other.name.starts_with(beginning)) continue;
      add(std::string(table.name) + "." + std::string(other.name.substr(beginning.size())), false);
    }
  }
  return text;
}

/// The whole scene with one key set, and without what that key excludes.
std::string scene_with(const std::string& table, const SceneKey& key, const std::string& value) {
  std::vector<Line> lines = whole_scene();
  const bool of_mesh = key.key == "unit";
  const bool other_solid = of_mesh || key.key == "file" || key.key == "recording" ||
                           (table == "goal" && key.key == "solid_above");
  const bool of_plugin = table == "device" &&
                         (key.key == "plugin" || key.key == "settings" ||
                          key.key == "stiffness_N_per_mm" || key.key == "position_mm" ||
                          key.key == "rotation_deg" || key.key == "scale" || key.key == "recentre");
  std::erase_if(lines, [&](const Line& line) {
    return line.table == table &&
           (line.key == key.key || (other_solid && (line.key == "shape" || line.key == "size_mm" ||
                                                    line.key == "points_mm")));
  });
  if (table == "goal" && key.key == "solid_above") lines.push_back({"goal", "file", "'a.stl'"});
  if (of_mesh) lines.push_back({table, "file", "'a.stl'"});
  if (of_plugin) {
    std::erase_if(lines, [](const Line& line) { return line.table == "device"; });
    if (key.key != "plugin") lines.push_back({"device", "plugin", "'a'"});
  }
  lines.push_back({table, std::string(key.key), value});
  return text_of(lines);
}

/// Calls `visit` with every table's name and each key that it may have.
template <class Visit>
void for_every_key(const Visit& visit) {
  for (const SceneTableKeys& table : scene_tables()) {
    for (const SceneKey& key : table.keys) {
      visit(std::string(table.name), key);
      for (const SceneTableKeys& heir : scene_tables()) {
        if (heir.inherits_from.empty() || !table.name.starts_with(heir.inherits_from)) continue;
        if (find_scene_key(heir.name, key.key) != &key && table.name == heir.inherits_from)
          continue;  // own
        visit(std::string(heir.name) + std::string(table.name.substr(heir.inherits_from.size())),
              key);
      }
    }
  }
}

TEST(SceneKeys, TheWholeSceneIsTaken) { EXPECT_EQ(error_of(text_of(whole_scene())), "no error"); }

// A date is what no key takes: whoever reads the key refuses it, and where nobody does the key is
// unknown or no error comes.
TEST(SceneKeys, EveryKeyIsRead) {
  int count = 0;
  for_every_key([&](const std::string& table, const SceneKey& key) {
    const std::string place = (table.empty() ? "" : table + ".") + std::string(key.key);
    const std::string error = error_of(scene_with(table, key, "1979-05-27"));
    EXPECT_NE(error.find(", " + place + ": found 1979-05-27, expected "), std::string::npos)
        << place << ": " << error;
    ++count;
  });
  EXPECT_GT(count, 110);
}

TEST(SceneKeys, EveryTableIsRead) {
  for (const SceneTableKeys& table : scene_tables()) {
    if (table.name.empty()) continue;
    const std::string name(table.name);
    const std::size_t dot = name.find('.');
    std::vector<Line> lines = whole_scene();
    lines.push_back(dot == std::string::npos
                        ? Line{"", name, "1979-05-27"}
                        : Line{name.substr(0, dot), name.substr(dot + 1), "1979-05-27"});
    const std::string error = error_of(text_of(lines, name));
    const std::string kind = table.repeated ? "tables, [[" : "a table, [";
    EXPECT_NE(error.find(", " + name + ": found 1979-05-27, expected " + kind), std::string::npos)
        << name << ": " << error;
  }
}

TEST(SceneKeys, EveryDefaultIsTaken) {
  int count = 0;
  for_every_key([&](const std::string& table, const SceneKey& key) {
    if (!has_default(key)) return;
    std::string text = scene_with(table, key, std::string(key.default_toml));
    EXPECT_EQ(error_of(text), "no error") << table << "." << key.key << "\n" << text;
    ++count;
  });
  EXPECT_GT(count, 60);
}

TEST(SceneKeys, TheReaderTakesNothingElse) {
  const toml::table parsed = toml::parse("voxel_m = 1\nvoxel_mm = 0.05");
  SceneTable table(TomlTable(parsed, "f.toml", "workpiece"), "workpiece");
  EXPECT_THROW((void)table.number("voxel_m"), std::logic_error);
  EXPECT_THROW((void)table.whole("voxel_mm"), std::logic_error);
  EXPECT_THROW((void)table.table("cube"), std::logic_error);
  EXPECT_THROW((void)table.number("solid_above"), std::logic_error);  // it has no default
  EXPECT_EQ(table.number("voxel_mm"), 0.05);
}

TEST(SceneKeys, ABodyHasTheKeysOfAWorkpiece) {
  EXPECT_EQ(find_scene_key("body", "voxel_mm"), find_scene_key("workpiece", "voxel_mm"));
  EXPECT_EQ(find_scene_key("body.torus", "minor_mm"),
            find_scene_key("workpiece.torus", "minor_mm"));
  EXPECT_NE(find_scene_key("body", "cuttable"), nullptr);
  EXPECT_EQ(find_scene_key("workpiece", "cuttable"), nullptr);
  EXPECT_EQ(find_scene_key("burr", "voxel_mm"), nullptr);
  EXPECT_EQ(find_scene_table("body.cube"), nullptr);
}

TEST(SceneKeys, EachSaysWhatItIsOnce) {
  std::set<std::string> names;
  for (const SceneTableKeys& table : scene_tables()) {
    EXPECT_FALSE(table.what.empty()) << table.name;
    for (const SceneKey& key : table.keys) {
      const std::string name = std::string(table.name) + "." + std::string(key.key);
      EXPECT_TRUE(names.insert(name).second) << name;
      EXPECT_FALSE(key.what.empty()) << name;
      EXPECT_EQ(key.words.empty(), key.kind != KeyKind::kChoice) << name;
      EXPECT_TRUE(key.kind != KeyKind::kNumber || key.range.least < key.range.most) << name;
    }
  }
}

TEST(SceneKeys, UnitsStandAtTheEndOfAName) {
  EXPECT_EQ(unit_of_key("voxel_mm"), "mm");
  EXPECT_EQ(unit_of_key("smallest_mm3"), "mm3");
  EXPECT_EQ(unit_of_key("stiffness_N_per_mm"), "N/mm");
  EXPECT_EQ(unit_of_key("specific_energy_J_per_mm3"), "J/mm3");
  EXPECT_EQ(unit_of_key("hand_turning_damping_mNm_s_per_rad"), "mN m s/rad");
  EXPECT_EQ(unit_of_key("speed_rpm"), "rpm");
  EXPECT_EQ(unit_of_key("friction"), "");
  EXPECT_EQ(unit_of_key("cells"), "");
}

}  // namespace
}  // namespace sulcus::scene_keys_test
