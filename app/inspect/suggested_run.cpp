#include "app/inspect/suggested_run.hpp"

#include <algorithm>
#include <cmath>

#include "app/terminal/terminal.hpp"
#include "engine/core/user_text.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

namespace {

/// Up to two digits: 0.0434 becomes 0.044.
double rounded_up(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return std::ceil(value / power - 1e-9) * power;
}

}  // namespace

std::string short_number(double value) {
  return formatted("%.5g", std::abs(value) < 1e-9 ? 0.0 : value);
}

std::string short_triple(const Eigen::Vector3d& p) {
  return "[" + short_number(p.x()) + ", " + short_number(p.y()) + ", " + short_number(p.z()) + "]";
}

void add_grid_and_way(const Eigen::Vector3d& size_mm, double finest_mm,
                      const Eigen::Vector3d& top_mm, std::vector<std::string>& settings) {
  constexpr double kMargin = 8.0, kMost = 512.0;  // voxels
  const double voxel_mm = std::clamp(
      rounded_up(std::max(size_mm.maxCoeff() / (kMost - 2.0 * kMargin), finest_mm)), 1e-3, 10.0);
  const Eigen::Vector3d leaves =
      ((size_mm.array() / voxel_mm + 2.0 * kMargin) / kLeafEdge).ceil().matrix();
  const Eigen::Vector3d cells =
      (leaves * kLeafEdge).cwiseMin(static_cast<double>(kMaxCellsPerAxis));
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  settings.push_back("workpiece.voxel_mm=" + short_number(voxel_mm));
  settings.push_back("workpiece.cells=" + short_triple(cells));
  settings.push_back("trajectory.points_mm=[" + short_triple(top_mm + up) + ", " +
                     short_triple(top_mm - 0.5 * up) + "]");
}

std::string shell_command(const std::string& scene_name, const std::vector<std::string>& settings) {
  std::string command = "sulcus run scenes/" + scene_name;
  for (const std::string& setting : settings) command += " --set " + for_shell(setting);
  return command;
}

}  // namespace sulcus
