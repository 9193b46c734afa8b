#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/report/assessment.hpp"
#include "engine/assessment/preparation_shape.hpp"
#include "engine/scene/assessment_table.hpp"

namespace sulcus {

/// What is found where a surface does not differ from the one before it, in words.
std::string nothing_removed();

/// The measures of one preparation, while they are gathered.
class MeasureList {
 public:
  /// `settings` outlive it.
  MeasureList(std::string subject, const AssessmentSettings& settings) : settings_(settings) {
    result_.subject = std::move(subject);
  }

  /// The name is one of measure_names(). What is returned holds until the next is added.
  AssessedMeasure& add(std::string_view name, double value);
  /// Nothing where there is no figure.
  void add(std::string_view name, const std::optional<double>& value);
  void add(std::string_view name, const std::optional<PlacedFigure>& figure);
  /// All of a shape. Depths are placed where they break their limit.
  void add(const PreparationShape& shape);

  const AssessmentSettings& settings() const { return settings_; }
  const MeasureLimit* limit_of(std::string_view name) const;
  std::vector<AssessedMeasure>& measures() { return result_.measures; }

  /// In the order of measure_names(), with limits, units and the mark.
  Assessment finish();

 private:
  const AssessmentSettings& settings_;
  Assessment result_;
};

}  // namespace sulcus
