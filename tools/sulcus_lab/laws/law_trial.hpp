#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/scene/scene.hpp"
#include "tools/sulcus_lab/laws/law_row.hpp"

namespace sulcus::lab {

/// The laws of a contact's stiffness that are measured, by their names in a scene: one that is
/// added to the engine is measured as soon as it stands here.
inline constexpr std::string_view kLawScalings[] = {"none", "count", "smooth", "potential"};

/// How much of a law is measured.
struct LawOptions {
  std::vector<std::string> scalings{std::begin(kLawScalings), std::end(kLawScalings)};
  std::vector<std::string> shapes;  // none: all
  SurfaceKind surface = SurfaceKind::kBinary;
  bool quick = false;  // fewer shapes and settings, for tests
};

/// Where a row was measured.
struct LawPlace {
  std::string shape, scaling, setting;
};

/// A law's measurement: what it finds is added here.
class LawTrial {
 public:
  LawTrial(std::string_view law, const LawOptions& options, std::vector<LawRow>& rows)
      : law_(law), options_(options), rows_(rows) {}

  SurfaceKind surface() const { return options_.surface; }
  std::string surface_name() const {
    return std::string(kSurfaceNames[static_cast<std::size_t>(surface())]);
  }
  bool quick() const { return options_.quick; }
  template <class T>
  std::vector<T> settings(std::vector<T> if_quick, std::vector<T> all) const {
    return quick() ? std::move(if_quick) : std::move(all);
  }
  /// Of those that are asked for, the ones that the law can be told of.
  std::vector<std::string> scalings(
      std::span<const std::string_view> told_of = kLawScalings) const {
    return in_both(options_.scalings, told_of);
  }
  /// The law's shapes, as far as they are asked for.
  std::vector<std::string> shapes(const std::vector<std::string>& if_quick,
                                  const std::vector<std::string>& all) const {
    std::vector<std::string> wanted;
    for (const std::string& shape : quick() ? if_quick : all) {
      if (asks_for(shape)) wanted.push_back(shape);
    }
    return wanted;
  }
  bool asks_for(const std::string& shape) const {
    return options_.shapes.empty() ||
           std::ranges::find(options_.shapes, shape) != options_.shapes.end();
  }

  void add(const LawPlace& where, std::string_view quantity, double value,
           const RowLimit& limit = {}) {
    rows_.push_back({.law = std::string(law_),
                     .shape = where.shape,
                     .scaling = where.scaling,
                     .setting = where.setting,
                     .quantity = std::string(quantity),
                     .value = value,
                     .limit = limit.value,
                     .at_least = limit.is_least});
  }

 private:
  static std::vector<std::string> in_both(const std::vector<std::string>& asked,
                                          std::span<const std::string_view> told_of) {
    std::vector<std::string> both;
    for (const std::string& name : asked) {
      if (std::ranges::find(told_of, name) != told_of.end()) both.push_back(name);
    }
    return both;
  }

  std::string_view law_;
  const LawOptions& options_;
  std::vector<LawRow>& rows_;
};

/// What only a force with a potential is held to; of the others it is reported.
inline RowLimit wanted_of_potential(std::string_view scaling, double most) {
  return scaling == "potential" ? at_most(most) : RowLimit{};
}

}  // namespace sulcus::lab
