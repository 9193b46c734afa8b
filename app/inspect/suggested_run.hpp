#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace sulcus {

/// Adds to the settings of a suggested run a grid that just holds a solid of this size, not turned,
/// in voxels of `finest_mm` or as 512 along the longest side hold it; and a way for the burr, from
/// 1 mm above `top_mm` to 0.5 mm into it.
void add_grid_and_way(const Eigen::Vector3d& size_mm, double finest_mm,
                      const Eigen::Vector3d& top_mm, std::vector<std::string>& settings);

/// "sulcus run scenes/NAME --set ...", quoted for a shell.
std::string shell_command(const std::string& scene_name, const std::vector<std::string>& settings);

/// A number to five digits, as it is printed and as commands take it.
std::string short_number(double value);
/// "[x, y, z]" of such.
std::string short_triple(const Eigen::Vector3d& p);

}  // namespace sulcus
