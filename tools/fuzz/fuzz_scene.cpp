#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "engine/scene/scene_file.hpp"
#include "engine/scene/trajectory.hpp"
#include "tools/fuzz/fuzz_targets.hpp"
#include "tools/fuzz/handed_file.hpp"

namespace sulcus::fuzz {

void fuzz_scene(Bytes bytes) {
  const auto end = std::ranges::find(bytes, 0);
  const std::string text(bytes.begin(), end);
  std::vector<std::string> overrides;
  if (end != bytes.end()) {
    std::istringstream lines(std::string(end + 1, bytes.end()));
    for (std::string line; std::getline(lines, line);) overrides.push_back(line);
  }
  Scene scene;
  if (!reads([&] { scene = parse_scene(text, "/scenes/fuzzed.toml", overrides); })) return;
  // What a recording carries of it must read again, as the same.
  Scene again;
  expect(reads([&] { again = parse_scene(scene.text, "/scenes/fuzzed.toml"); }),
         "the text of a scene is refused: " + scene.text);
  expect(again.workpiece.cells == scene.workpiece.cells &&
             again.tissues.size() == scene.tissues.size() &&
             again.bodies.size() == scene.bodies.size(),
         "the text of a scene is another scene: " + scene.text);
  if (!scene.trajectory.file.empty()) return;
  const Trajectory trajectory = make_trajectory(scene.trajectory);
  expect(trajectory.pose_at(0.5 * trajectory.duration_s()).position.allFinite(),
         "a pose that is not finite");
}

}  // namespace sulcus::fuzz
