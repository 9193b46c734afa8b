#include "engine/scene/assessment_table.hpp"

#include <string>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "tests/support/scene_text.hpp"

namespace sulcus::assessment_table_test {
namespace {

AssessmentSettings parsed(const std::string& text) {
  return assessment_of("[assessment]\n" + text, "a.toml").value();
}
std::string error_of(const std::string& text) {
  try {
    (void)parsed(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(AssessmentTable, OneNumberIsAtMostUnlessTheMeasureIsOfWhatIsToStay) {
  const AssessmentSettings settings =
      parsed("undercut_mm2 = 0\ndentine_over_pulp_mm = 0.5\nconvergence_deg = [4, 14]");
  ASSERT_EQ(settings.limits.size(), 3u);
  const MeasureLimit &angle = settings.limits[0], &undercut = settings.limits[1];
  EXPECT_EQ(angle.name, "convergence_deg");
  EXPECT_FALSE(angle.met(3.9));
  EXPECT_TRUE(angle.met(4.0));
  EXPECT_TRUE(angle.met(14.0));
  EXPECT_FALSE(angle.met(14.1));
  EXPECT_TRUE(undercut.met(0.0));
  EXPECT_FALSE(undercut.met(0.01));
  EXPECT_TRUE(settings.limits[2].met(0.5));
  EXPECT_FALSE(settings.limits[2].met(0.4));
}

TEST(AssessmentTable, KeysBesideAPresetGoBeforeIt) {
  const AssessmentSettings settings =
      parsed("preset = 'crown'\ndepth_mm = [1, 2]\nforce_N = 3\nweights.depth_mm = 4");
  EXPECT_EQ(settings.kind, AssessedKind::kCrown);
  EXPECT_EQ(settings.limits.front().name, "depth_mm");
  EXPECT_EQ(settings.limits.front().high, 2.0);
  EXPECT_EQ(settings.limits.front().weight, 4.0);
  EXPECT_EQ(settings.limits.back().name, "force_N");
  EXPECT_EQ(settings.limits.size(), 7u);
  EXPECT_EQ(parsed("preset = 'crown'\nkind = 'cavity'").kind, AssessedKind::kCavity);
}

TEST(AssessmentTable, WhatItDoesNotKnowIsRefused) {
  EXPECT_FALSE(assessment_of("title = 'none'", "a.toml"));
  EXPECT_NE(error_of("depth_mm = [2, 1]").find("expected [least, most]"), std::string::npos);
  EXPECT_NE(error_of("depth_mm = [1]").find("a number or [least, most]"), std::string::npos);
  EXPECT_NE(error_of("dept_mm = 1").find("expected 'depth_mm'"), std::string::npos);
  EXPECT_NE(error_of("weights.depth_mm = 2").find("a weight without a limit"), std::string::npos);
  EXPECT_NE(error_of("insertion = [0, 0, 0]").find("a direction"), std::string::npos);
  EXPECT_NE(error_of("depth_mm = ").find("not valid TOML"), std::string::npos);
  EXPECT_NE(test::error_of("[workpiece]\nshape = 'box'\n[trajectory]\npoints_mm = [[0, 0, 9]]\n"
                           "[assessment]\ndepth_mm = 1\n")
                .find("[assessment] without [cutting]"),
            std::string::npos);
}

}  // namespace
}  // namespace sulcus::assessment_table_test
