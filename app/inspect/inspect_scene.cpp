#include <cstdio>

#include "app/inspect/burr_facts.hpp"
#include "app/inspect/inspect.hpp"
#include "app/playback/scene_trajectory.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus {

void inspect_scene(const std::string& file, const std::vector<std::string>& overrides,
                   const std::string& picture_png) {
  const Scene scene = load_scene(file, overrides);
  const WorkpieceSettings& w = scene.workpiece;
  const Trajectory trajectory = scene_trajectory(scene);
  say("scene            %s\n", scene.title.c_str());
  say("workpiece        %s\n", w.shape ? "built-in shape" : w.file.c_str());
  say("cells            %d x %d x %d of %g mm\n", w.cells.x(), w.cells.y(), w.cells.z(),
      w.voxel_m / kMillimetre);
  for (const TissueSettings& t : scene.tissues) {
    say("tissue           %s: %g N/mm, %g J/mm3%s%s\n", t.name.c_str(),
        t.stiffness_N_per_m / kNewtonPerMillimetre, t.specific_energy_J_per_m3 / kJoulePerMm3,
        t.file.empty() ? "" : ", ", t.file.c_str());
  }
  for (const BodySettings& body : scene.bodies) {
    say("body             %s%s\n", body.name.c_str(), body.cuttable ? ", cuttable" : "");
  }
  say("trajectory       %.3f s, %.0f ticks\n", trajectory.duration_s(),
      trajectory.duration_s() * scene.haptics.rate_hz);
  say("parts            %s%s%s%s%s\n", scene.device ? "device " : "",
      scene.coupling ? "coupling " : "", scene.cutting ? "cutting " : "",
      scene.render ? "render " : "", scene.record ? "record" : "");
  if (!picture_png.empty()) show_burr(scene, picture_png);
}

}  // namespace sulcus
