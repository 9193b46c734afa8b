#include "haptics/device/force_fade.hpp"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus::force_fade_test {
namespace {

using Eigen::Vector3d;

std::vector<Wrench> all_of(ForceFade fade) {
  std::vector<Wrench> sent;
  while (!fade.is_over()) sent.push_back(fade.next());
  return sent;
}

TEST(ForceFade, FallsInAStraightLineToZeroIn50Ms) {
  OutputLimits limits;
  const Wrench held{Vector3d(0, -1.2, 3.0), Vector3d(0.05, 0, 0)};
  const std::vector<Wrench> sent = all_of(ForceFade(held, limits));
  ASSERT_EQ(sent.size(), 50u);
  for (std::size_t i = 0; i < 50; ++i) {
    const double left = static_cast<double>(49 - i) / 50.0;
    EXPECT_TRUE(sent[i].force_N.isApprox(left * held.force_N, 1e-12)) << i;
    EXPECT_TRUE(sent[i].torque_Nm.isApprox(left * held.torque_Nm, 1e-12)) << i;
  }
  EXPECT_EQ(sent.back().force_N, Vector3d::Zero().eval());
}

TEST(ForceFade, TakesLongerRatherThanLongerSteps) {
  OutputLimits limits;
  limits.dt_s = 10e-3;  // 5 ticks in 50 ms
  for (const Wrench& held :
       {Wrench{Vector3d(40, 0, 0), {0, 0, 0}}, Wrench{Vector3d(0, 0, 3.3), Vector3d(0, 2.0, 0)}}) {
    Wrench before = held;
    for (const Wrench& now : all_of(ForceFade(held, limits))) {
      EXPECT_LE((now.force_N - before.force_N).norm(), limits.force_step_N * (1 + 1e-9));
      EXPECT_LE((now.torque_Nm - before.torque_Nm).norm(), limits.torque_step_Nm * (1 + 1e-9));
      before = now;
    }
    EXPECT_EQ(before.force_N, Vector3d::Zero().eval());
    EXPECT_EQ(before.torque_Nm, Vector3d::Zero().eval());
  }
}

TEST(ForceFade, OfNothingThereIsNothingToTakeOff) {
  const OutputLimits limits;
  EXPECT_TRUE(ForceFade({}, limits).is_over());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ForceFade unknown({Vector3d(nan, 0, 0), {0, 0, 0}}, limits);
  EXPECT_TRUE(unknown.is_over());
  EXPECT_EQ(unknown.next().force_N, Vector3d::Zero().eval());
}

}  // namespace
}  // namespace sulcus::force_fade_test
