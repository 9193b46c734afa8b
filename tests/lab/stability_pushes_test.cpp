#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"
#include "tools/sulcus_lab/stability/pushes.hpp"
#include "tools/sulcus_lab/stability/random_pushes.hpp"

namespace sulcus::lab::stability_pushes_test {
namespace {

/// A face at 20 degrees, coarse enough for a test.
const std::string kFace =
    "tissue = ['enamel']\n[workpiece]\nshape = 'plate'\ncells = [64, 64, 64]\nvoxel_mm = 0.05\n"
    "plate.thickness_mm = 1.0\nplate.tilt_deg = 20\n"
    "[burr]\nshape = 'round'\ndiameter_mm = 1.0\nfield = [32, 128, 32]\n";

Push push_on_face() {
  const double tilt = 20.0 * 0.017453292519943295;
  Push push;
  push.delay = 1;
  push.axis = {std::sin(tilt), 0.0, std::cos(tilt)};
  push.into = -push.axis;
  return push;
}

TEST(StabilityPushes, ACoupledPressIsHeldAndFeltAsStiffAsTheCoupling) {
  const Push push = push_on_face();
  const PushResult held = run_push(push, kFace, 1.0e-3 * push.axis, 1.2e-3);
  ASSERT_TRUE(held.reached);
  EXPECT_FALSE(held.popped);
  EXPECT_TRUE(held.stable()) << held.rms_m;
  EXPECT_GT(held.stiffness_N_per_m, 0.9 * 700.0);
  EXPECT_NEAR(held.contact_N, 1.0, 0.1);
  EXPECT_EQ(held.buzz_ticks, 0u);
}

TEST(StabilityPushes, ClinicalOnesAreHeldAndFeltInTheirShortForm) {
  int judged = 0;
  for (const StabilityRow& row : run_case("clinical_pushes", {.methods = {}, .brief = true}).rows) {
    judged += row.limit ? 1 : 0;
    EXPECT_TRUE(row.pass()) << row.quantity << " " << row.value;
  }
  EXPECT_EQ(judged, 46);
}

TEST(StabilityPushes, OnesOffTheAxisTurnTheHandleAsItsSpringHolds) {
  int judged = 0;
  for (const StabilityRow& row :
       run_case("pressed_off_axis", {.methods = {}, .brief = true}).rows) {
    judged += row.limit ? 1 : 0;
    EXPECT_TRUE(row.pass()) << row.quantity << " " << row.value;
    if (row.quantity == "turned_deg") {
      EXPECT_GT(row.value, 0.5);
    }
  }
  EXPECT_EQ(judged, 24);
}

TEST(StabilityPushes, ThePlainPenaltyLetsTheSamePressThroughOrBuzzes) {
  Push push = push_on_face();
  push.method = ContactMethod::kCount;
  // Too soft for 1 N, which K R / 3 does not reach; and too stiff for the loop, which throws it
  // off.
  const PushResult soft = run_push(push, kFace, 1.0e-3 * push.axis, 1.2e-3, 2e3);
  EXPECT_TRUE(soft.popped);
  EXPECT_EQ(soft.buzz_ticks, 0u);
  const PushResult stiff = run_push(push, kFace, 1.0e-3 * push.axis, 1.2e-3, 60e3);
  EXPECT_TRUE(stiff.popped || !stiff.stable());
  EXPECT_GT(stiff.buzz_ticks, 0u);
}

TEST(StabilityPushes, RandomPushesNeverCrossAndComeAgainFromTheirSeeds) {
  const Workpiece tooth(test::ball({192, 192, 192}, 50e-6, {95.0, 94.0, 96.5}, 50.0));
  const std::vector<std::uint64_t> seeds{1, 2, 3, 4, 5, 6};
  const std::vector<RandomPush> pushes = run_random_pushes(tooth, seeds);
  constexpr double kForceLimit_N = CouplingSettings{}.force_limit_N;
  for (const RandomPush& push : pushes) {
    EXPECT_TRUE(push.touched) << push.seed;
    EXPECT_FALSE(push.crossed) << push.seed;
    EXPECT_TRUE(push.finite) << push.seed;
    EXPECT_LE(push.step_N, kLargestStep_N) << push.seed;
    EXPECT_FALSE(fails(push, kForceLimit_N)) << push.seed;
    EXPECT_EQ(push.cutting, push.seed % 2 == 1);
  }
  const RandomPush again = run_random_push(tooth, 3);
  EXPECT_EQ(again.force_N, pushes[2].force_N);
  EXPECT_EQ(again.step_N, pushes[2].step_N);
  for (const StabilityRow& row : random_push_rows("ball", pushes, kForceLimit_N).rows) {
    EXPECT_TRUE(row.pass()) << row.quantity << " " << row.value;
  }
}

}  // namespace
}  // namespace sulcus::lab::stability_pushes_test
