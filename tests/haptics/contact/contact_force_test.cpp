#include "haptics/contact/contact_force.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/haptics/contact/contact_evaluation.hpp"
#include "tests/haptics/contact/contact_stages.hpp"

namespace sulcus::contact_force_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using namespace test;

double depth_sum(const Workpiece& workpiece, const Burr& burr, const Pose& pose, int& contacts) {
  double sum_m = 0.0;
  contacts = 0;
  for (const Cell& c : test::surface_cells(workpiece)) {
    const double d = -probe(burr, pose, workpiece.grid().centre_world(c)).distance_m;
    if (d <= 0.0) continue;
    sum_m += d;
    ++contacts;
  }
  return sum_m;
}

TEST(ContactForce, NoneIsTheSumOfStiffnessTimesDepthAlongTheNormal) {
  const Pose pose = test::upright({0.13e-3, -0.21e-3, -0.12e-3});
  const Evaluation e(flat_block(), round_burr(), pose, Scaling::kNone);
  int contacts = 0;
  const double sum_m = depth_sum(flat_block(), round_burr(), pose, contacts);
  ASSERT_GT(contacts, 50);
  EXPECT_EQ(e.result.contacts, static_cast<unsigned>(contacts));
  EXPECT_NEAR(e.result.wrench.force_N.z(), kStiffness * sum_m, 1e-5 * kStiffness * sum_m);
  EXPECT_EQ(e.result.wrench.force_N.x(), 0.0);
  EXPECT_EQ(e.result.wrench.force_N.y(), 0.0);
}

TEST(ContactForce, CountIsStiffnessTimesTheMeanDepth) {
  const Pose pose = test::upright({0.13e-3, -0.21e-3, -0.12e-3});
  const Evaluation e(flat_block(), round_burr(), pose, Scaling::kCount);
  int contacts = 0;
  const double mean_m = depth_sum(flat_block(), round_burr(), pose, contacts) / contacts;
  EXPECT_NEAR(e.result.wrench.force_N.z(), kStiffness * mean_m, 1e-5 * kStiffness * mean_m);
  EXPECT_EQ(e.result.wrench.force_N.x(), 0.0);
}

TEST(ContactForce, SmoothWeighsByDepthAtTheSurface) {
  const Pose pose =
      test::pose_along({0.13e-3, -0.21e-3, -0.12e-3}, Vector3d(0.3, -0.2, 1).normalized());
  const Evaluation e(flat_block(), round_burr(), pose, Scaling::kSmooth);
  double weights = 0.0, weighted_m = 0.0;
  for (const Cell& c : test::surface_cells(flat_block())) {
    if (c.z() != 31 || (c.head<2>().array() < 8).any() || (c.head<2>().array() > 55).any())
      continue;
    const Vector3d surface = flat_block().grid().centre_world(c) + Vector3d(0, 0, 0.5 * kVoxel);
    const Probe p = probe(round_burr(), pose, surface);
    if (p.distance_m >= 0.0) continue;
    const double weight = -p.distance_m / kVoxel * std::clamp(-p.away.z() / 0.2, 0.0, 1.0);
    weights += weight;
    weighted_m += weight * -p.distance_m;
  }
  ASSERT_GT(weights, 10.0);
  const double expected_N = kStiffness * weighted_m / weights;
  EXPECT_NEAR(e.result.wrench.force_N.z(), expected_N, 1e-4 * expected_N);
}

TEST(ContactForce, ALoneVoxelIsSofterThanAWallUnderSmooth) {
  const Workpiece lone(test::block({64, 64, 64}, kVoxel, {31, 31, 31}, {32, 32, 32}));
  const Pose pose = test::upright(lone.grid().centre_world({31, 31, 31}) - Vector3d(0, 0, 20e-6));
  const double none_N =
      Evaluation(lone, round_burr(), pose, Scaling::kNone).result.wrench.force_N.norm();
  const double smooth_N =
      Evaluation(lone, round_burr(), pose, Scaling::kSmooth).result.wrench.force_N.norm();
  const double depth_m =
      -probe(round_burr(), pose, lone.grid().centre_world({31, 31, 31})).distance_m;
  EXPECT_NEAR(depth_m, 20e-6, 1e-6);
  EXPECT_NEAR(none_N, kStiffness * depth_m, 1e-3 * none_N);
  // Half a voxel deeper at its face; its weight, its depth there in voxels, of the 10 that make
  // full stiffness.
  const double at_face_m = depth_m + 0.5 * kVoxel;
  EXPECT_NEAR(smooth_N, kStiffness * at_face_m * (at_face_m / kVoxel) / 10.0, 1e-3 * smooth_N);
}

TEST(ContactForce, TorqueIsTheSumOfArmsTimesForcesAboutTheReference) {
  const Vector3d axis = Vector3d(0.4, -0.2, 1).normalized();
  const Pose pose = test::pose_along({0.3e-3, 0.1e-3, -0.15e-3}, axis);
  const Evaluation e(flat_block(), round_burr(), pose, Scaling::kNone);
  const Vector3d reference = pose.position + 40e-3 * axis;
  Vector3d torque = Vector3d::Zero();
  for (const Contact contact : e.scratch.contacts) {
    const Vector3d force = kStiffness * contact.depth_m * contact.normal.cast<double>();
    torque += (flat_block().grid().centre_world(contact.cell) - reference).cross(force);
  }
  EXPECT_GT(torque.norm(), 1e-3);
  EXPECT_TRUE(e.result.wrench.torque_Nm.isApprox(torque, 1e-6));
}

TEST(ContactForce, TorqueAboutThePointOfContactIsNone) {
  // An upright round burr on a plane: the force goes through its axis.
  const Evaluation e(flat_block(), round_burr(), test::upright({0, 0, -0.1e-3}), Scaling::kSmooth);
  EXPECT_GT(e.result.wrench.force_N.z(), 0.5);
  EXPECT_LT(e.result.wrench.torque_Nm.norm(), 1e-5 * e.result.wrench.force_N.z());
}

TEST(ContactForce, EachTissueHasItsStiffness) {
  VoxelModel model = test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {64, 64, 32});
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf)
    tissues->set_uniform(leaf, 1);
  model.tissues = tissues;
  const Workpiece soft(std::move(model));
  std::vector<TissueSettings> two(2);
  two[1].stiffness_N_per_m = 0.1 * kStiffness;
  const Pose pose = test::upright({0, 0, -0.1e-3});
  ContactScratch scratch(with(Scaling::kCount));
  const double force_N =
      evaluate_contact(soft, {round_burr(), pose, two, with(Scaling::kCount)}, scratch)
          .wrench.force_N.z();
  const Evaluation hard(flat_block(), round_burr(), pose, Scaling::kCount);
  EXPECT_NEAR(force_N, 0.1 * hard.result.wrench.force_N.z(), kFloat * force_N);
}

TEST(ContactForce, WithoutANormalTheToolsGradientIsTaken) {
  // A lone voxel beside the axis: symmetric, so the method knows no direction.
  const Workpiece lone(test::block({64, 64, 64}, kVoxel, {31, 31, 31}, {32, 32, 32}));
  const Pose pose =
      test::upright(lone.grid().centre_world({31, 31, 31}) - Vector3d(0.3e-3, 0, 0.1e-3));
  for (const Scaling scaling : {Scaling::kNone, Scaling::kCount, Scaling::kSmooth}) {
    const Evaluation e(lone, round_burr(), pose, scaling);
    ASSERT_EQ(e.result.contacts, 1u);
    const Vector3d away = probe(round_burr(), pose, lone.grid().centre_world({31, 31, 31})).away;
    EXPECT_GT(e.result.wrench.force_N.norm(), 0.01);
    EXPECT_LT(test::angle_deg(e.result.wrench.force_N, -away), 0.1);
  }
}

TEST(ContactForce, AContactThatFacesAwayIsDroppedUnderSmoothOnly) {
  const Pose pose = test::upright({0, 0, -0.1e-3});
  Contact contact;
  contact.cell = Cell(32, 32, 31);
  const auto distance_m = static_cast<float>(
      probe(round_burr(), pose, flat_block().grid().centre_world(contact.cell)).distance_m);
  ASSERT_LT(distance_m, 0.0f);
  contact.normal = Vector3f(0, 0, -1);
  for (const Scaling scaling : {Scaling::kNone, Scaling::kCount, Scaling::kSmooth}) {
    ContactScratch scratch(with(scaling));
    test::add_contact(scratch, contact, distance_m);
    ContactResult result;
    const std::vector<TissueSettings> tissues = test::one_tissue();
    const HapticsSettings settings = with(scaling);
    const ContactQuery query{round_burr(), pose, tissues, settings};
    ContactForce force(flat_block(), query);
    const MeasureSums all = force.measured(scratch);
    force.sum(all, scratch, result);
    if (scaling == Scaling::kSmooth) {
      EXPECT_EQ(all.counted, 0u);
      EXPECT_EQ(result.wrench.force_N, Vector3d(0, 0, 0));
    } else {
      EXPECT_LT(result.wrench.force_N.z(), 0.0);
    }
  }
}

TEST(ContactForce, NoContactNoForce) {
  for (const Scaling scaling : {Scaling::kNone, Scaling::kCount, Scaling::kSmooth}) {
    const Evaluation e(flat_block(), round_burr(), test::upright({0, 0, 0.2e-3}), scaling);
    EXPECT_EQ(e.result.contacts, 0u);
    EXPECT_EQ(e.result.wrench.force_N, Vector3d(0, 0, 0));
    EXPECT_EQ(e.result.wrench.torque_Nm, Vector3d(0, 0, 0));
    EXPECT_TRUE(e.result.stiffness.isZero(0.0));
  }
}

}  // namespace
}  // namespace sulcus::contact_force_test
