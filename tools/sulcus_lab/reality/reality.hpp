#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/scene/scene.hpp"

namespace sulcus::lab {

/// A published figure, as a band, and what Sulcus gives.
struct RealityRow {
  std::string check;   // with its unit
  std::string source;  // ends in "(fitted)" where constants of the law were fitted to the band
  double low = 0.0, high = 0.0;
  std::array<double, kCuttingLawNames.size()> value{};  // by CuttingLaw; not a number: no figure

  /// What has no figure is out.
  bool in(CuttingLaw law) const {
    const double v = value[static_cast<std::size_t>(law)];
    return v >= low && v <= high;
  }
  bool fitted() const { return source.ends_with("(fitted)"); }
};

struct RealityOptions {
  bool quick = false;  // voxels of 0.06 mm, and of preparations the beginning
  std::function<void(const std::string&)> progress = [](const std::string&) {};
};

/// Rows that are measured together: a section of the table, in a file of its own. To add one: its
/// function here, its file, its line in `reality_sections`.
struct RealitySection {
  std::string_view name;
  std::vector<RealityRow> (*measure)(const RealityOptions& options);
};
std::span<const RealitySection> reality_sections() noexcept;

/// How fast a burr cuts under a load, against load, speed, grit, wear and tissue; how it drags.
std::vector<RealityRow> reality_rates(const RealityOptions& options);
/// What the preset of the turbine gives, and how it sags.
std::vector<RealityRow> reality_handpieces(const RealityOptions& options);
/// The forces of a preparation.
std::vector<RealityRow> reality_preparations(const RealityOptions& options);
/// The pulp after a minute's work, dry and with water.
std::vector<RealityRow> reality_heat(const RealityOptions& options);
/// The pitch of a turbine that cuts.
std::vector<RealityRow> reality_sound(const RealityOptions& options);

}  // namespace sulcus::lab
