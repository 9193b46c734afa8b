// How a hand worked: of motions whose figures can be written down.
#include "engine/assessment/hand_process.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus::hand_process_test {
namespace {

constexpr double kRate_hz = 1000.0;
const Eigen::Vector3d kUp = Eigen::Vector3d::UnitZ();

/// A hand at rest, clear of the tooth.
std::vector<HandTick> at_rest(std::size_t count) {
  std::vector<HandTick> ticks(count);
  for (std::size_t i = 0; i < count; ++i) ticks[i] = {i, Eigen::Vector3d::Zero(), kUp, 0.0, false};
  return ticks;
}
void touch(std::vector<HandTick>& ticks, std::size_t first, std::size_t count) {
  for (std::size_t i = first; i < first + count; ++i) ticks[i].in_contact = true;
}
HandProcess process(const std::vector<HandTick>& ticks, double over_N = 1e9) {
  return hand_process(ticks, kRate_hz, over_N, kUp);
}

TEST(HandProcess, StrokesAreContactsThatShortGapsDoNotEnd) {
  std::vector<HandTick> ticks = at_rest(10000);
  touch(ticks, 1000, 400);
  for (std::size_t i = 1200; i < 1230; ++i) ticks[i].in_contact = false;  // of one stroke
  touch(ticks, 1800, 400);
  touch(ticks, 2600, 20);  // a touch, no stroke
  touch(ticks, 5000, 700);
  const HandProcess found = process(ticks);
  EXPECT_EQ(found.strokes, 3u);
  EXPECT_NEAR(found.stroke_s, 0.5, 1e-9);
  EXPECT_NEAR(found.strokes_per_s, 3.0 / 4.7, 1e-9);
  EXPECT_EQ(found.pauses, 1u);
  EXPECT_NEAR(found.longest_pause_s, 2.381, 1e-9);
}

TEST(HandProcess, PathsAndAnglesAreThoseOfACircle) {
  // One turn of 2 mm in a second, the burr leaning outward by 10 degrees, more by 5 at one place.
  std::vector<HandTick> ticks = at_rest(1001);
  touch(ticks, 0, 1001);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(i) / 1000.0;
    const double lean = (i == 700 ? 15.0 : 10.0) * std::numbers::pi / 180.0;
    const Eigen::Vector3d out(std::cos(turn), std::sin(turn), 0.0);
    ticks[i].tip_m = 2e-3 * out;
    ticks[i].axis = std::cos(lean) * kUp + std::sin(lean) * out;
  }
  const HandProcess found = process(ticks);
  EXPECT_NEAR(found.path_mm, 4.0 * std::numbers::pi, 1e-3);
  EXPECT_NEAR(found.stroke_mm, found.path_mm, 1e-9);
  EXPECT_NEAR(*found.burr_angle_deg, 10.0, 0.01);
  EXPECT_NEAR(found.greatest_burr_angle_deg->value, 15.0, 1e-9);
  EXPECT_EQ(found.greatest_burr_angle_deg->at, 700u);
}

TEST(HandProcess, ForcesAreThoseInContact) {
  std::vector<HandTick> ticks = at_rest(2000);
  touch(ticks, 500, 1000);
  for (std::size_t i = 0; i < ticks.size(); ++i)
    ticks[i].force_N = 9.0;  // felt, but not of contact
  for (std::size_t i = 0; i < 1000; ++i) ticks[500 + i].force_N = 1e-3 * static_cast<double>(i + 1);
  const HandProcess found = process(ticks, 0.8);
  EXPECT_NEAR(*found.median_force_N, 0.5, 0.002);
  EXPECT_NEAR(*found.p95_force_N, 0.95, 0.002);
  EXPECT_NEAR(found.over_force_s, 0.2, 1e-9);
  EXPECT_DOUBLE_EQ(found.greatest_force_N->value, 1.0);
  EXPECT_EQ(found.greatest_force_N->at, 1499u);
}

TEST(HandProcess, TheReachOfLeastJerkIsTheSmoothest) {
  // 10 tau^3 - 15 tau^4 + 6 tau^5 [Flash and Hogan 1985]: the jerk's square comes to 720 L^2 / D^5,
  // the peak speed to 1.875 L / D.
  std::vector<HandTick> ticks = at_rest(1000);
  touch(ticks, 0, 1000);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const double t = static_cast<double>(i) / 1000.0;
    ticks[i].tip_m.x() = 5e-3 * (10.0 * t * t * t - 15.0 * t * t * t * t + 6.0 * std::pow(t, 5));
  }
  const double best = -std::log(720.0 / (1.875 * 1.875));
  EXPECT_NEAR(process(ticks).smoothness.value(), best, 0.05);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ticks[i].tip_m.y() = 1e-4 * std::sin(2.0 * std::numbers::pi * static_cast<double>(i) / 100.0);
  }
  EXPECT_LT(process(ticks).smoothness.value(), best - 3.0);  // with a tremor of 10 Hz
}

TEST(HandProcess, AStraightEvenStrokeHasNoSmoothness) {
  std::vector<HandTick> ticks = at_rest(1000);
  touch(ticks, 0, 1000);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ticks[i].tip_m = Eigen::Vector3d(-1.1e-3, 0.7e-3, 6.3e-3) +
                     static_cast<double>(i) / 1000.0 * Eigen::Vector3d(2.1e-3, -0.3e-3, 0.0);
  }
  EXPECT_FALSE(process(ticks).smoothness) << "of how places are rounded";
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ticks[i].tip_m.z() += 1e-9 * std::sin(2.0 * std::numbers::pi * static_cast<double>(i) / 100.0);
  }
  EXPECT_TRUE(process(ticks).smoothness) << "of a tremor of a nanometre";
}

TEST(HandProcess, OfAHandThatTouchesNothingThereIsNoStroke) {
  const HandProcess found = process(at_rest(100));
  EXPECT_EQ(found.strokes, 0u);
  EXPECT_EQ(found.stroke_s, 0.0);
  EXPECT_FALSE(found.median_force_N || found.burr_angle_deg || found.smoothness);
  EXPECT_EQ(process({}).path_mm, 0.0);
}

TEST(HandProcess, ATissueIsTimedByTheTenthsThatWereSpentOnIt) {
  std::vector<HandRemoval> removals;
  for (std::uint64_t tick = 0; tick < 1000; ++tick) removals.push_back({tick, 0, 1e-3});
  for (std::uint64_t tick = 5000; tick < 5500; ++tick) removals.push_back({tick, 1, 4e-3});
  removals.push_back({5500, 0, 0.1});  // in a tenth of the second tissue
  for (std::uint64_t tick = 5501; tick < 5600; ++tick) removals.push_back({tick, 1, 4e-3});
  EXPECT_NEAR(removal_rate(removals, 0, kRate_hz), 1.1, 1e-9);
  EXPECT_NEAR(removal_rate(removals, 1, kRate_hz), 2.396 / 0.6, 1e-9);
  EXPECT_EQ(removal_rate(removals, 2, kRate_hz), 0.0);
}

}  // namespace
}  // namespace sulcus::hand_process_test
