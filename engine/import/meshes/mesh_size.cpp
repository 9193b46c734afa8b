#include "engine/import/meshes/mesh_size.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/units.hpp"

namespace sulcus {
namespace {

// A little less than the crown of a milk tooth; a jaw with its base.
constexpr double kSmallest_mm = 2.5, kLargest_mm = 150.0;
constexpr double kUsual_mm = 20.0;  // a molar with its roots
constexpr std::array<const char*, 5> kSpoken{"micrometres", "mm", "cm", "metres", "inches"};

bool may_be_tooth(double longest_mm) {
  return longest_mm >= kSmallest_mm && longest_mm <= kLargest_mm;
}

}  // namespace

double longest_side_m(std::span<const TissueSurface> surfaces) {
  Eigen::AlignedBox3f box;
  for (const TissueSurface& surface : surfaces) {
    for (const Eigen::Vector3f& p : surface.mesh.positions) box.extend(p);
  }
  return static_cast<double>(box.sizes().maxCoeff());
}

std::string doubt_size(double longest_m, MeshUnit unit) {
  const double longest_mm = longest_m / kMillimetre;
  if (may_be_tooth(longest_mm)) return {};
  std::vector<std::pair<double, std::size_t>> fitting;  // how far from the usual, unit
  const auto length_mm = [&](std::size_t other) {
    return longest_mm * kMeshUnits_m[other] / metres_of(unit);
  };
  for (std::size_t other = 0; other < kMeshUnits_m.size(); ++other) {
    if (!may_be_tooth(length_mm(other))) continue;
    fitting.emplace_back(std::abs(std::log(length_mm(other) / kUsual_mm)), other);
  }
  std::ranges::sort(fitting);
  std::ostringstream text;
  text.precision(3);
  text << longest_mm << " mm long, as no tooth is";
  if (fitting.empty()) text << ", in whatever unit";
  for (std::size_t i = 0; i < fitting.size(); ++i) {
    const std::size_t other = fitting[i].second;
    text << (i == 0 ? "; in " : ", in ") << kSpoken[other] << (i == 0 ? " it would be " : " ")
         << length_mm(other) << " mm (unit = \"" << kMeshUnitNames[other] << "\")";
  }
  return text.str();
}

}  // namespace sulcus
