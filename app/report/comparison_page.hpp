#pragma once

#include <string>
#include <vector>

#include "app/report/assessment.hpp"
#include "engine/scene/assessment_table.hpp"

namespace sulcus {

/// A recording, what was found of it and by which limits.
struct ComparedAttempt {
  std::string recording;
  Assessment assessment;
  AssessmentSettings settings;
};

/// How many a page has room for, side by side.
inline constexpr std::size_t kMostCompared = 4;

/// Writes a page of two to kMostCompared attempts, as write_review_page: side by side in one camera
/// and one scale of colours, with their measures beside each other, the better of each marked, and
/// curves on the same axes. InputError as page_attempt and three_js().
void write_comparison_page(const std::vector<ComparedAttempt>& attempts, const std::string& file);

}  // namespace sulcus
