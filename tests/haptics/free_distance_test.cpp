#include "haptics/free_distance.hpp"

#include <random>

#include <gtest/gtest.h>

#include "haptics/contact/evaluate_contact.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus::free_distance_test {
namespace {

using Eigen::Vector3d;

constexpr double kVoxel = 50e-6;

const Workpiece& flat_block() {
  static const Workpiece workpiece(test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {64, 64, 32}));
  return workpiece;
}
const Burr& burr() {
  static const Burr round = make_burr(test::small_burr(), kVoxel);
  return round;
}

TEST(FreeDistance, IsTheWayToAFaceButForLessThanTwoVoxels) {
  ContactScratch scratch{HapticsSettings{}};
  for (const double gap_m : {0.06e-3, 0.2e-3, 0.35e-3, 0.9e-3, 1.7e-3}) {
    const double way_m =
        free_distance(flat_block(), burr(), test::upright({0, 0, gap_m}), 5e-3, scratch);
    EXPECT_LE(way_m, gap_m) << gap_m;
    // Up to eight voxels by the voxels themselves, further by leaves and the capsule.
    const double within_m = gap_m < 7.0 * kVoxel ? 2.0 * kVoxel : 0.6 * gap_m;
    EXPECT_GT(way_m, gap_m - within_m) << gap_m;
  }
  EXPECT_EQ(free_distance(flat_block(), burr(), test::upright({0, 0, -0.1e-3}), 5e-3, scratch),
            0.0);
}

TEST(FreeDistance, IsNoLongerThanAskedForAndThatIsFoundAtOnce) {
  ContactScratch scratch{HapticsSettings{}};
  EXPECT_EQ(free_distance(flat_block(), burr(), test::upright({0, 0, 1e-3}), 0.1e-3, scratch),
            0.1e-3);
}

TEST(FreeDistance, WhatIsNearIsLeftAsNoContact) {
  // What is in the scratch at the end of a tick is cut.
  ContactScratch scratch{HapticsSettings{}};
  for (const double gap_m : {-0.1e-3, 0.06e-3, 0.2e-3}) {
    free_distance(flat_block(), burr(), test::upright({0, 0, gap_m}), 5e-3, scratch);
    EXPECT_TRUE(scratch.contacts.empty()) << gap_m;
    EXPECT_TRUE(scratch.queries.empty()) << gap_m;
  }
}

TEST(FreeDistance, NoWayOfThatLengthEndsInContact) {
  const Workpiece blobs(test::random_blobs({64, 64, 64}, 5));
  ContactScratch scratch{HapticsSettings{}};
  std::mt19937 random(11);
  const auto part = [&] { return static_cast<double>(random() % 2001u) / 1000.0 - 1.0; };
  int moved = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Vector3d axis = Vector3d(part(), part(), part()).normalized();
    Pose pose = test::pose_along(2.5e-3 * Vector3d(part(), part(), part()), axis);
    const double way_m = free_distance(blobs, burr(), pose, 1e-3, scratch);
    if (way_m == 0.0) continue;
    ++moved;
    pose.position += 0.999 * way_m * Vector3d(part(), part(), part()).normalized();
    const ContactResult there =
        evaluate_contact(blobs, {burr(), pose, test::one_tissue(), HapticsSettings{}}, scratch);
    EXPECT_EQ(there.contacts, 0u) << "way " << way_m << " in trial " << trial;
  }
  EXPECT_GT(moved, 50);
}

}  // namespace
}  // namespace sulcus::free_distance_test
