#include "app/report/measure_list.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus::measure_list_test {
namespace {

/// Of a preparation in which nothing is to be found but what was removed.
Assessment of_nothing(AssessedKind kind, const std::string& name) {
  AssessmentSettings settings;
  settings.kind = kind;
  settings.limits = {{"undercut_mm2", {}, 0.0}, {name, 1.0, {}}};
  MeasureList all("tooth", settings);
  all.add(PreparationShape{});
  return all.finish();
}

TEST(MeasureList, WhatEveryPreparationHasIsNotMetWhereItIsNotThere) {
  for (const char* name : {"depth_mm", "isthmus_mm", "wall_left_mm"}) {
    const Assessment found = of_nothing(AssessedKind::kCavity, name);
    EXPECT_EQ(found.not_measured, std::vector<std::string>{name});
    EXPECT_DOUBLE_EQ(found.mark.value(), 50.0) << name;
  }
  EXPECT_DOUBLE_EQ(of_nothing(AssessedKind::kCrown, "margin_mm").mark.value(), 50.0);
}

TEST(MeasureList, WhatAKindDoesNotHaveDoesNotCount) {
  EXPECT_DOUBLE_EQ(of_nothing(AssessedKind::kCrown, "wall_left_mm").mark.value(), 100.0);
  EXPECT_DOUBLE_EQ(of_nothing(AssessedKind::kCavity, "margin_mm").mark.value(), 100.0);
}

}  // namespace
}  // namespace sulcus::measure_list_test
