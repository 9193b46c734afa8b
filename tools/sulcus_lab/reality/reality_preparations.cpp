#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "engine/import/build_workpiece.hpp"
#include "engine/scene/scene_file.hpp"
#include "tools/sulcus_lab/laws/law_rig.hpp"
#include "tools/sulcus_lab/reality/reality.hpp"

namespace sulcus::lab {

namespace {

/// On the hand, while scenes/crown_turbine.toml is prepared.
double greatest_force_N(CuttingLaw law, bool quick) {
  const std::array overrides{"cutting.law=" +
                             std::string(kCuttingLawNames[static_cast<std::size_t>(law)])};
  const Scene scene = load_scene(SULCUS_SCENES "/crown_turbine.toml", overrides);
  LawRig rig(scene, build_workpiece(scene));
  const Trajectory trajectory = make_trajectory(scene.trajectory);
  ScriptedDevice device(trajectory, scene.haptics.rate_hz);
  const double seconds = quick ? std::min(10.0, trajectory.duration_s()) : trajectory.duration_s();
  const auto ticks = static_cast<int>(std::ceil(seconds * scene.haptics.rate_hz));
  double greatest_N = 0.0;
  for (int t = 0; t < ticks; ++t) {
    greatest_N = std::max(greatest_N, rig.step(device).sent.force_N.norm());
  }
  return greatest_N;
}

}  // namespace

std::vector<RealityRow> reality_preparations(const RealityOptions& options) {
  RealityRow force{"greatest force while preparing a crown, N", "Elias 2003", 0.1, 4.9, {}};
  for (const CuttingLaw law : {CuttingLaw::kPaper, CuttingLaw::kSaturating}) {
    options.progress(force.check);
    force.value[static_cast<std::size_t>(law)] = greatest_force_N(law, options.quick);
  }
  return {force};
}

}  // namespace sulcus::lab
