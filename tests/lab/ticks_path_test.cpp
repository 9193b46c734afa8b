#include "tools/sulcus_lab/ticks/ticks_path.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "haptics/contact/evaluate_contact.hpp"
#include "tests/lab/plate_block.hpp"
#include "tools/sulcus_lab/ticks/ticks_cutting.hpp"

namespace sulcus::lab::ticks_path_test {
namespace {

using test::kBlockGround;
using test::plate_block;

TEST(TickPath, HoldsTheContactsAndMovesAtItsPace) {
  const Workpiece block = plate_block();
  for (const int wanted : {60, 300}) {
    const TickPath path = find_tick_path(block, kBlockGround, wanted);
    EXPECT_NEAR(path.contacts, wanted, 0.03 * wanted);
    EXPECT_GT(path.depth_m, 0.0);
    ASSERT_GT(path.poses.size(), 20u);

    const HapticsSettings settings = counting_settings(wanted);
    ContactScratch scratch(settings);
    const std::vector<TissueSettings> tissues(1);
    double sum = 0.0;
    for (std::size_t p = 0; p < path.poses.size(); ++p) {
      const Pose& next = path.poses[(p + 1) % path.poses.size()];
      const double step = (next.position - path.poses[p].position).norm();
      EXPECT_NEAR(step, kTickStep, 0.05 * kTickStep) << p;
      const auto found =
          evaluate_contact(block, {path.burr, path.poses[p], tissues, settings}, scratch).contacts;
      EXPECT_GE(static_cast<int>(found), path.least);
      EXPECT_LE(static_cast<int>(found), path.most);
      sum += found;
    }
    EXPECT_NEAR(sum / static_cast<double>(path.poses.size()), path.contacts, 1e-9);
  }
}

TEST(TickPath, RefusesMoreThanTheGroundHas) {
  EXPECT_THROW(find_tick_path(plate_block(), kBlockGround, 150000), InputError);
}

TEST(TickPath, ABallBeyondASceneLargestBurrIsOne) {
  const Burr ball = round_burr(6e-3, 0.2e-3);
  const auto distance = [&](const Eigen::Vector3d& p_tool) {
    return ball.field.sample(ball.field.field_from_tool(p_tool).cast<float>());
  };
  EXPECT_NEAR(distance({0, 3e-3, 0}), -3e-3, 0.1e-3);
  EXPECT_NEAR(distance({0, 0, 0}), 0.0, 0.02e-3);
  EXPECT_NEAR(distance({3e-3, 3e-3, 0}), 0.0, 0.02e-3);
  EXPECT_NEAR(distance({0, 6e-3, 0}), 0.0, 0.02e-3);
  EXPECT_GE(ball.capsule.radius_m, 3e-3);
  EXPECT_EQ(ball.head_length_m, 6e-3);
}

TEST(CuttingPlan, SinksWithTheGroundItTakes) {
  const Workpiece block = plate_block();
  const TickPath path = find_tick_path(block, kBlockGround, 150);
  constexpr int kTicks = 1500;  // about two voxels for each one in contact
  const CuttingPlan plan =
      plan_cutting(block, path, 150, kTicks, find_specific_energy(block, path, 150, kTicks),
                   counting_settings(150));
  ASSERT_EQ(plan.poses.size(), static_cast<std::size_t>(kTicks));
  EXPECT_GT(plan.specific_energy_J_per_m3, 0.0);
  const Pose &last = plan.poses.back(), &uncut = path.poses[(kTicks - 1) % path.poses.size()];
  EXPECT_LT(last.position.z(), uncut.position.z() - 20e-6);
  EXPECT_EQ(last.position.x(), uncut.position.x());
}

}  // namespace
}  // namespace sulcus::lab::ticks_path_test
