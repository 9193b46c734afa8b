#pragma once

#include <string>
#include <vector>

#include "engine/heat/tooth_heat.hpp"

namespace sulcus::lab {

/// How warm the pulp of a tooth becomes while a scene with [heat] and a built-in shape is run to
/// its end; the scripted burr follows the trajectory. `overrides`: as `--set` has them. No file is
/// written. InputError as load_scene; std::invalid_argument where the scene has no heat or its
/// tooth no pulp.
PulpHeat pulp_after_work(const std::string& scene_file, const std::vector<std::string>& overrides);

/// The rows of sulcus-lab reality: change at the pulp's wall after 60 s at 1 N, K
/// (PulpHeat::end_change_K), dry and with 30 ml/min of water at 23 C. `overrides`: more of them,
/// such as "cutting.law=saturating".
struct PulpFigures {
  double dry_K = 0.0, water_K = 0.0;
};
PulpFigures pulp_after_a_minute(const std::vector<std::string>& overrides = {});

}  // namespace sulcus::lab
