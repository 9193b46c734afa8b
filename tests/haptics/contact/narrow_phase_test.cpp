#include "haptics/contact/narrow_phase.hpp"

#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/haptics/contact/contact_stages.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus::narrow_phase_test {
namespace {

using Eigen::Vector3d;

// What single precision may differ by between one voxel reached over its leaf and by itself, m.
constexpr double kFloatError_m = 1e-8;

double sample_at(const Workpiece& workpiece, const Burr& burr, const Pose& pose, const Cell& c) {
  const Vector3d p_tool = pose.inverse_point(workpiece.grid().centre_world(c));
  return burr.field.sample(burr.field.field_from_tool(p_tool).cast<float>());
}

Pose random_pose_near(std::mt19937& random, const Vector3d& at_world, const Burr& burr) {
  const auto unit = [&] { return static_cast<double>(random() % 2000001) * 1e-6 - 1.0; };
  Pose pose;
  pose.orientation = Eigen::Quaterniond(unit(), unit(), unit(), unit() + 0.01).normalized();
  // Some point of the head lies at the given place.
  const Vector3d in_head(unit() * 0.4e-3, (unit() + 1.0) * 0.5 * burr.head_length_m,
                         unit() * 0.4e-3);
  pose.position = at_world - pose.direction(in_head);
  return pose;
}

/// Poses of a burr against a workpiece, checked against every surface voxel there is.
void expect_as_brute_force(const Workpiece& workpiece, const Burr& burr, int poses,
                           std::uint32_t seed) {
  const std::vector<Cell> surface = test::surface_cells(workpiece);
  ContactScratch scratch{HapticsSettings{}};
  std::mt19937 random(seed);
  std::size_t total = 0;
  for (int p = 0; p < poses; ++p) {
    const Cell& near = surface[random() % surface.size()];
    const Pose pose = random_pose_near(random, workpiece.grid().centre_world(near), burr);
    const double reach_m = p % 2 == 0 ? 0.0 : workpiece.grid().voxel_m;
    const test::Found all = test::collide(workpiece, burr, pose, reach_m, scratch);
    EXPECT_GE(all.tested, all.contacts.size());

    std::map<std::uint32_t, double> found;
    for (const test::FoundContact& contact : all.contacts) {
      ASSERT_TRUE(workpiece.is_surface(contact.cell));
      ASSERT_TRUE(found.emplace(workpiece.grid().linear(contact.cell), contact.distance_m).second)
          << "a voxel twice";
    }
    for (const Cell& c : surface) {
      const double distance_m = sample_at(workpiece, burr, pose, c);
      const auto it = found.find(workpiece.grid().linear(c));
      if (it != found.end()) {
        ASSERT_NEAR(it->second, distance_m, kFloatError_m);
        ASSERT_LT(distance_m, reach_m + kFloatError_m);
      } else {
        ASSERT_GT(distance_m, reach_m - kFloatError_m)
            << "pose " << p << " misses " << c.transpose();
      }
    }
    total += found.size();
  }
  EXPECT_GT(total, 30u * static_cast<unsigned>(poses));
}

TEST(NarrowPhase, EqualsBruteForceOverAllSurfaceVoxels) {
  const Burr round = make_burr(test::small_burr(), 50e-6);
  expect_as_brute_force(Workpiece(test::random_blobs({64, 64, 64}, 31, 50e-6)), round, 60, 1);
  expect_as_brute_force(Workpiece(test::ball({64, 64, 64}, 34.8e-6, {31, 32, 33}, 27)), round, 60,
                        2);
}

TEST(NarrowPhase, EqualsBruteForceWhereLeavesReachFarBeyondTheField) {
  // Voxels so large that a leaf's centre lies outside the box of samples when its corner touches.
  const Workpiece workpiece(test::random_blobs({40, 40, 40}, 32, 100e-6));
  for (BurrShape shape : {BurrShape::kRound, BurrShape::kFissure, BurrShape::kInvertedCone}) {
    expect_as_brute_force(workpiece, make_burr(test::small_burr(shape, 1.0e-3), 100e-6), 60, 3);
  }
}

TEST(NarrowPhase, FindsALoneVoxelAtTheCornerOfItsLeaf) {
  // The hardest case of passing leaves over by one sample at their centre: from every side, just
  // in touch, the voxel at the far end of the leaf's diagonal.
  const Burr burr = make_burr(test::small_burr(), 100e-6);
  const Workpiece workpiece(test::block({24, 24, 24}, 100e-6, {8, 8, 8}, {9, 9, 9}));
  const Vector3d at_world = workpiece.grid().centre_world({8, 8, 8});
  const Vector3d out = -Vector3d::Ones().normalized();  // from the leaf's centre to the voxel
  ContactScratch scratch{HapticsSettings{}};
  std::mt19937 random(4);
  int touching = 0;
  for (int p = 0; p < 3000; ++p) {
    // The head's centre beyond the voxel, on the leaf's diagonal, 5 um deeper than its radius.
    const auto unit = [&] { return static_cast<double>(random() % 2000001) * 1e-6 - 1.0; };
    Pose pose;
    pose.orientation = Eigen::Quaterniond(unit(), unit(), unit(), unit() + 0.01).normalized();
    const Vector3d centre_world = at_world + out * (0.7e-3 - 5e-6);
    pose.position = centre_world - pose.direction(Vector3d(0, 0.7e-3, 0));
    if (!(sample_at(workpiece, burr, pose, {8, 8, 8}) < -1e-8)) continue;
    ++touching;
    ASSERT_EQ(test::collide(workpiece, burr, pose, 0.0, scratch).contacts.size(), 1u)
        << "pose " << p;
  }
  EXPECT_GT(touching, 2000);
}

TEST(NarrowPhase, ContactsComeInTheOrderOfTheLeaves) {
  const Workpiece workpiece(test::ball({64, 64, 64}, 50e-6, {31, 32, 33}, 27));
  const Burr burr = make_burr(test::small_burr(), 50e-6);
  ContactScratch scratch{HapticsSettings{}};
  const test::Found found =
      test::collide(workpiece, burr, test::upright({0, 0, 1.2e-3}), 0.0, scratch);
  ASSERT_GT(found.contacts.size(), 50u);
  auto leaf = scratch.leaves.begin();
  for (const test::FoundContact& contact : found.contacts) {
    leaf = std::find(leaf, scratch.leaves.end(), workpiece.grid().leaf_of(contact.cell));
    ASSERT_NE(leaf, scratch.leaves.end());
  }
}

TEST(NarrowPhase, TheDeepestAreKeptInTheirOrder) {
  const Workpiece workpiece(test::ball({64, 64, 64}, 50e-6, {31, 32, 33}, 27));
  const Burr burr = make_burr(test::small_burr(), 50e-6);
  const Pose pose = test::upright({0, 0, 1.2e-3});
  ContactScratch scratch{HapticsSettings{}};
  const test::Found all = test::collide(workpiece, burr, pose, 0.0, scratch);
  std::vector<test::FoundContact> deepest = all.contacts;
  std::sort(deepest.begin(), deepest.end(), [](const auto& a, const auto& b) {
    return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : a.key() < b.key();
  });
  ASSERT_GT(deepest.size(), 200u);
  // All; just short of all; less than half, so that the buffer is thinned on the way; one.
  for (const std::size_t capacity :
       {deepest.size(), deepest.size() - 1, deepest.size() / 5, std::size_t{1}}) {
    HapticsSettings settings;
    settings.max_contacts = static_cast<int>(capacity);
    ContactScratch small(settings);
    const test::Found found = test::collide(workpiece, burr, pose, 0.0, small, true);
    EXPECT_EQ(found.tested, all.tested);
    ASSERT_EQ(found.contacts.size(), capacity);
    std::vector<std::uint32_t> kept, expected, chosen;
    for (const auto& contact : found.contacts) kept.push_back(contact.key());
    for (std::size_t i = 0; i < capacity; ++i) chosen.push_back(deepest[i].key());
    // In the order that they have without the limit: sums must not depend on a partition.
    for (const auto& contact : all.contacts) {
      if (std::count(chosen.begin(), chosen.end(), contact.key()) == 1) {
        expected.push_back(contact.key());
      }
    }
    EXPECT_EQ(kept, expected);
  }
}

}  // namespace
}  // namespace sulcus::narrow_phase_test
