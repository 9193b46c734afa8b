#include "app/saved_scene.hpp"

#include <filesystem>
#include <sstream>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus {

std::string saved_scene(const Scene& scene, const std::string& recording,
                        const std::optional<Section>& section) {
  for (const BodySettings& body : scene.bodies) {
    if (!body.solid.file.empty()) {
      throw InputError(scene.file, "[[body]] " + body.name, "a file",
                       "a built-in shape, to be saved elsewhere");
    }
  }
  std::vector<std::string> overrides{string_override(
      "trajectory.recording", std::filesystem::absolute(recording).lexically_normal().string())};
  const auto keep_path = [&](const std::string& key, const std::string& file) {
    if (!file.empty()) overrides.push_back(string_override(key, file));
  };
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
    std::ostringstream value;
    value << "render.section='"
          << "xyz"[section->axis] << '=' << section->at_m / kMillimetre << '\'';
    overrides.push_back(value.str());
  }
  return parse_scene(scene.text, scene.file, overrides).text;
}

}  // namespace sulcus
