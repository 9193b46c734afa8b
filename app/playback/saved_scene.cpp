#include "app/playback/saved_scene.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus {

namespace {

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), error == std::errc{} ? end : text.data()};
}

/// A number of TOML that is no whole one with as few digits as say the same; else the word itself.
std::string shortest_word(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool is_number = error == std::errc{} && end == word.data() + word.size();
  if (!is_number || word.find('.') == std::string_view::npos) return std::string(word);
  std::string text = shortest(value);
  // In TOML what has neither would be a whole number.
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

/// As toml++ prints a scene, with numbers as short as they can be: it prints 17 digits of each.
std::string with_shortest_numbers(const std::string& toml) {
  const auto is_of_word = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '+' || c == '-' ||
           c == '_';
  };
  std::string text;
  for (std::size_t at = 0; at < toml.size();) {
    std::size_t end = at + 1;
    if (toml[at] == '"' || toml[at] == '\'') {  // as it is, to its end
      const std::string_view three = std::string_view(toml).substr(at, 3);
      const bool is_long = three == "\"\"\"" || three == "'''";
      const std::string_view mark = three.substr(0, is_long ? 3 : 1);
      end = at + mark.size();
      while (end < toml.size() && std::string_view(toml).substr(end, mark.size()) != mark) {
        end += toml[end] == '\\' && mark[0] == '"' ? 2 : 1;
      }
      end = std::min(end + mark.size(), toml.size());
      text.append(toml, at, end - at);
    } else if (is_of_word(toml[at])) {
      while (end < toml.size() && is_of_word(toml[end])) ++end;
      text += shortest_word(std::string_view(toml).substr(at, end - at));
    } else {
      text += toml[at];
    }
    at = end;
  }
  return text;
}

/// A file as seen from a folder; absolute where they have nothing in common.
std::string seen_from(const std::filesystem::path& folder, const std::string& file) {
  const std::filesystem::path to = std::filesystem::absolute(file).lexically_normal();
  const auto first_of = [](const std::filesystem::path& path) {
    const std::filesystem::path inner = path.relative_path();
    return inner.empty() ? inner : *inner.begin();
  };
  if (first_of(to) != first_of(folder)) return to.string();
  return to.lexically_relative(folder).string();
}

/// The device's limits, its poses being the recording's: no hand pushes again.
void play_device_back(const Scene& scene, std::vector<std::string>& overrides) {
  const DeviceSettings& device = *scene.device;
  if (!device.plugin) {
    overrides.emplace_back("device.model=played_back");
    return;
  }
  overrides.push_back(
      "device={model=\"played_back\", force_limit_N=" + shortest(device.force_limit_N) +
      ", torque_limit_mNm=" + shortest(device.torque_limit_Nm * 1e3) +
      ", passivity_controller=" + (device.passivity_controller ? "true" : "false") + "}");
  if (!scene.coupling) return;
  overrides.push_back("coupling.stiffness_N_per_mm=" +
                      shortest(scene.coupling->stiffness_N_per_m / kNewtonPerMillimetre));
}

}  // namespace

std::string saved_scene(const Scene& scene, const std::string& recording,
                        const std::optional<Section>& section) {
  for (const BodySettings& body : scene.bodies) {
    if (!body.solid.file.empty()) {
      throw InputError(scene.file, "[[body]] " + body.name, "a file",
                       "a built-in shape, to be saved elsewhere");
    }
  }
  const std::filesystem::path folder =
      std::filesystem::absolute(recording).lexically_normal().parent_path();
  std::vector<std::string> overrides;
  const auto keep_path = [&](const std::string& key, const std::string& file) {
    if (!file.empty()) overrides.push_back(string_override(key, seen_from(folder, file)));
  };
  keep_path("trajectory.recording", recording);
  if (scene.trajectory.hold_s > 0.0) overrides.emplace_back("trajectory.hold_s=0");
  if (scene.device) play_device_back(scene, overrides);
  keep_path("workpiece.file", scene.workpiece.file);
  for (const TissueSettings& tissue : scene.tissues) {
    if (tissue.file.empty()) continue;
    if (tissue.name.find_first_of(".=") != std::string::npos) {
      throw InputError(scene.file, "[[tissue]] " + tissue.name,
                       "a file, and '.' or '=' in its name",
                       "a name without them, to be saved elsewhere");
    }
    keep_path("tissue." + tissue.name + ".file", tissue.file);
  }
  keep_path("workpiece.labels", scene.workpiece.labels);
  keep_path("burr.file", scene.burr.file);
  if (scene.goal) keep_path("goal.file", scene.goal->file);
  if (section) {
    overrides.push_back(std::string("render.section='") + "xyz"[section->axis] + '=' +
                        shortest(section->at_m / kMillimetre) + '\'');
  }
  return with_shortest_numbers(parse_scene(scene.text, scene.file, overrides).text);
}

}  // namespace sulcus
