#pragma once

#include <string>
#include <vector>

namespace sulcus::lab {

/// Change at the pulp's wall after a minute's work at 1 N, scenes/occlusal_minute.toml, K
/// (PulpHeat::end_change_K): dry, and with 30 ml/min of water at 23 C.
struct PulpFigures {
  double dry_K = 0.0, water_K = 0.0;
};
/// `overrides`: as `--set` has them, such as "cutting.law=saturating".
PulpFigures pulp_after_a_minute(const std::vector<std::string>& overrides);

}  // namespace sulcus::lab
