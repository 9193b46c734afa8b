#pragma once

#include <string>

#include "app/report/assessment.hpp"

namespace sulcus {

/// How a person reads the name of a measure, its unit and its limit: "Greatest depth", "mm",
/// "1.5 to 1.75".
std::string measure_title(const AssessedMeasure& measure);
std::string unit_title(const std::string& unit);
std::string limit_title(const MeasureLimit& limit);

/// What was measured, what it was to be, whether that was met and when it came about. Rows of what
/// was not met have a button that goes there.
std::string assessment_table(const Assessment& assessment);

}  // namespace sulcus
