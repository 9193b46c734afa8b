#include "engine/normals/normal_method.hpp"

#include <gtest/gtest.h>

#include "tests/support/normal_errors.hpp"

namespace sulcus {
namespace {

TEST(NormalMethod, TheNamedMethodIsTakenWithItsSettings) {
  const Workpiece workpiece(test::two_balls());
  HapticsSettings settings;
  settings.neighbourhood = 4;
  settings.trace = 7;
  int differ = 0;
  for (const Cell& c : test::surface_cells(workpiece)) {
    settings.normals = NormalMethod::kLdm;
    const SurfaceEstimate ldm = estimate_surface(workpiece, c, settings);
    ASSERT_TRUE(test::same_bits(ldm, estimate_ldm(workpiece, c, 4, 7)));
    settings.normals = NormalMethod::kLdmPaper;
    const SurfaceEstimate paper = estimate_surface(workpiece, c, settings);
    ASSERT_TRUE(test::same_bits(paper, estimate_ldm_paper(workpiece, c, 4, 7)));
    differ += !test::same_bits(ldm, paper);
  }
  EXPECT_GT(differ, 100);
}

}  // namespace
}  // namespace sulcus
