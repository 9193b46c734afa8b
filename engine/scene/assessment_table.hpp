#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace sulcus {

/// What a preparation can be measured by, once: its names are the keys of [assessment] and what
/// assessment.json calls them.
struct MeasureName {
  std::string_view name, unit, what;
  bool at_least;  // what a limit of one number means; else at most
};
std::span<const MeasureName> measure_names() noexcept;

/// What a measure is to be.
struct MeasureLimit {
  std::string name;
  std::optional<double> low, high;
  double weight = 1.0;  // in the mark

  /// Never by what is no number.
  bool met(double value) const {
    return !(low && !(value >= *low)) && !(high && !(value <= *high));
  }
};

enum class AssessedKind : std::uint8_t { kCavity, kCrown };
inline constexpr std::array<std::string_view, 2> kAssessedKindNames{"cavity", "crown"};

/// [assessment]: what a preparation is measured and marked by. A run knows nothing of it.
struct AssessmentSettings {
  AssessedKind kind = AssessedKind::kCavity;
  Eigen::Vector3d insertion{0, 0, 1};                 // out of the tooth, a unit vector
  Eigen::Vector3d mesial{1, 0, 0}, buccal{0, -1, 0};  // out of the tooth, unit vectors
  double tolerance_mm = 0.3;                          // of a comparison with a goal
  double voxel_mm = 0.02;            // between the rays that surfaces are measured on, at least
  std::vector<MeasureLimit> limits;  // in the order of measure_names()
};

/// Of a scene's text, or a file's with nothing but [assessment]; none where the table is absent.
/// `file` is for messages. InputError where it is not as `sulcus help scene` says.
std::optional<AssessmentSettings> assessment_of(const std::string& text, const std::string& file);

}  // namespace sulcus
