#include "haptics/body.hpp"

#include <gtest/gtest.h>

#include "haptics/contact/evaluate_contact.hpp"
#include "haptics/tick.hpp"
#include "tests/haptics/tick_run.hpp"
#include "tests/support/allocation_count.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus::body_test {
namespace {

using Eigen::Vector3d;

constexpr double kVoxel = 50e-6;

VoxelModel ball() { return test::ball({48, 48, 48}, kVoxel, {23.5, 23.5, 23.5}, 18.0); }

const Burr& burr() {
  static const Burr round = make_burr(test::small_burr(), kVoxel);
  return round;
}

/// Down onto the top of a ball about the origin, 0.1 mm deep.
Pose on_top() { return test::upright({0.05e-3, 0.1e-3, 0.8e-3}); }

/// A scene with one body beside the workpiece, at a pose.
Scene scene_with_body(const Pose& place, bool cuttable) {
  Scene scene;
  scene.tissues = test::one_tissue();
  scene.tissues[0].specific_energy_J_per_m3 = 0.02e9;  // soft, so that voxels go within a few ticks
  scene.cutting.emplace();
  BodySettings& body = scene.bodies.emplace_back();
  body.world_from_grid = place;
  body.cuttable = cuttable;
  return scene;
}

ContactResult contact_of(const Body& body, const ContactQuery& query, ContactScratch& scratch) {
  ContactResult result;
  const NearBody near{&body, &scratch, &result};
  return evaluate_contact({&near, 1}, query);
}

void expect_near(const Vector3d& a, const Vector3d& b, double tolerance) {
  EXPECT_LT((a - b).norm(), tolerance) << a.transpose() << " instead of " << b.transpose();
}

TEST(Body, ItsContactIsThatOfTheSameSolidMovedAndTurned) {
  const Pose place{{3e-3, -1e-3, 2e-3}, rotation_xyz({0.4, -1.1, 2.0})};
  Scene scene = scene_with_body(place, true);
  const Body body(scene, scene.bodies[0], Workpiece(ball()));
  const Workpiece same(ball());
  ContactScratch scratch(scene.haptics);
  const Twist twist{{2e-3, -1e-3, 3e-3}, {0.1, 0.2, -0.3}, 700.0};
  const ContactResult at_origin = evaluate_contact(
      same, {burr(), on_top(), scene.tissues, scene.haptics, &twist, Outputs::kForceAndStiffness},
      scratch);
  ASSERT_GT(at_origin.contacts, 20u);

  const Twist twist_world{place.direction(twist.linear_m_per_s),
                          place.direction(twist.angular_rad_per_s), twist.spindle_rad_per_s};
  const ContactResult found = contact_of(body,
                                         {burr(), place * on_top(), scene.tissues, scene.haptics,
                                          &twist_world, Outputs::kForceAndStiffness},
                                         scratch);
  EXPECT_EQ(found.contacts, at_origin.contacts);
  const double force_N = at_origin.wrench.force_N.norm();
  expect_near(found.wrench.force_N, place.direction(at_origin.wrench.force_N), 1e-5 * force_N);
  expect_near(found.wrench.torque_Nm, place.direction(at_origin.wrench.torque_Nm),
              1e-5 * at_origin.wrench.torque_Nm.norm());
  ASSERT_GT(at_origin.tangential.force_N.norm(), 0.02 * force_N);
  expect_near(found.tangential.force_N, place.direction(at_origin.tangential.force_N),
              1e-4 * force_N);
  // Pushed along a direction it answers with what the turned stiffness says.
  const Vector3d along = Vector3d(0.3, 0.2, -0.9).normalized();
  expect_near(found.stiffness.topLeftCorner<3, 3>() * place.direction(along),
              place.direction(at_origin.stiffness.topLeftCorner<3, 3>() * along),
              1e-4 * at_origin.stiffness.topLeftCorner<3, 3>().norm());
}

TEST(Body, WhatHoldsIsNotRubbedAt) {
  const Scene scene = scene_with_body({}, false);
  const Body body(scene, scene.bodies[0], Workpiece(ball()));
  EXPECT_FALSE(body.removal);
  ContactScratch scratch(scene.haptics);
  const Twist twist{{}, {}, 700.0};
  const ContactResult found =
      contact_of(body, {burr(), on_top(), scene.tissues, scene.haptics, &twist}, scratch);
  EXPECT_GT(found.wrench.force_N.norm(), 0.01);
  EXPECT_TRUE(found.tangential.force_N.isZero(0.0));
}

TEST(Body, OfOneTissueItHasThatTissuesStiffness) {
  Scene scene = scene_with_body({}, false);
  scene.tissues.push_back(scene.tissues[0]);
  scene.tissues[1].stiffness_N_per_m *= 3.0;
  const Body first(scene, scene.bodies[0], Workpiece(ball()));
  scene.bodies[0].tissue = 1;
  const Body second(scene, scene.bodies[0], Workpiece(ball()));
  ContactScratch scratch(scene.haptics);
  const auto force_N = [&](const Body& body) {
    return contact_of(body, {burr(), on_top(), scene.tissues, scene.haptics}, scratch)
        .wrench.force_N.norm();
  };
  EXPECT_NEAR(force_N(second), 3.0 * force_N(first), 1e-5 * force_N(second));
}

/// The workpiece's ball at the origin, a neighbour's, and the burr between or on one of them.
struct TwoBalls {
  explicit TwoBalls(bool cuttable, const Vector3d& place = {0.0, 0.0, 3e-3})
      : scene(scene_with_body({place, Eigen::Quaterniond::Identity()}, cuttable)),
        context{scene, burr()},
        state(initial_state(scene, {Workpiece(ball()), Workpiece(ball())})),
        scratch(scene) {}

  TickResult step(const Pose& pose) {
    struct Still final : Device {
      Pose at;
      std::optional<Pose> pose(std::uint64_t) noexcept override { return at; }
      void apply(const Wrench&) noexcept override {}
    } device;
    device.at = pose;
    return tick(context, device, state, scratch);
  }
  Workpiece& workpiece() { return state.workpiece().solid; }
  Body& neighbour() { return state.bodies[1]; }

  Scene scene;
  TickContext context;
  SimulationState state;
  TickScratch scratch;
};

TEST(BodyTick, BothBodiesPushAtOnce) {
  // Beside one another, the burr's head between them: its radius reaches 0.1 mm into each.
  const double radius_m = 0.5 * test::small_burr().diameter_m;
  const double apart_m = 2.0 * (18.0 * kVoxel + radius_m - 0.1e-3);
  TwoBalls run(false, {apart_m, 0.0, 0.0});
  const Pose between = test::upright({0.5 * apart_m, 0.0, -radius_m});
  const TickResult record = run.step(between);
  const std::uint32_t all = record.contact.contacts;
  const std::uint32_t with_neighbour = run.scratch.bodies[1].result.contacts;
  EXPECT_GT(with_neighbour, 10u);
  EXPECT_GT(all - with_neighbour, 10u);
  const Vector3d from_neighbour = run.scratch.bodies[1].result.wrench.force_N;
  EXPECT_LT(from_neighbour.x(), -0.01) << "pushed away from it";
  EXPECT_LT(std::abs(record.sent.force_N.x()), 0.1 * std::abs(from_neighbour.x())) << "they cancel";
  EXPECT_EQ(run.neighbour().touched_ticks, 1u);
  EXPECT_DOUBLE_EQ(run.neighbour().peak_force_N, from_neighbour.norm());

  run.step(test::upright({0.5 * apart_m, 0.0, 5e-3}));
  EXPECT_EQ(run.neighbour().touched_ticks, 1u) << "left again";
}

TEST(BodyTick, OnlyACuttableOneIsCutAndTheEnergyIsItsOwn) {
  for (const bool cuttable : {false, true}) {
    TwoBalls run(cuttable);
    const std::uint64_t before = run.workpiece().hash(),
                        neighbour_before = run.neighbour().solid.hash();
    Pose on_neighbour = on_top();
    on_neighbour.position.z() += 3e-3;
    std::size_t edits = 0;
    for (int i = 0; i < 100; ++i) {
      EXPECT_EQ(run.step(on_neighbour).removed, 0u) << "of the workpiece";
      edits += run.scratch.edits.size();
      for (const Edit& edit : run.scratch.edits) EXPECT_EQ(edit.body, 1);
    }
    EXPECT_EQ(run.workpiece().hash(), before);
    EXPECT_EQ(edits > 0, cuttable);
    EXPECT_EQ(run.neighbour().solid.hash() != neighbour_before, cuttable);
    if (!cuttable) continue;
    const RemovalState& removal = *run.neighbour().removal;
    EXPECT_EQ(removal.removed_voxels[0], edits);
    EXPECT_EQ(run.state.work_J(), removal.work_J);
    EXPECT_NEAR(removal.removed_J + removal.stored_J() + removal.heat_J, removal.work_J,
                1e-9 * removal.work_J);
  }
}

TEST(BodyTick, TheStatesHashKnowsWhatWasCutOfIt) {
  TwoBalls cut(true), spared(true);
  Pose on_neighbour = on_top();
  on_neighbour.position.z() += 3e-3;
  EXPECT_EQ(cut.state.hash(), spared.state.hash());
  cut.step(on_neighbour);
  spared.step(on_neighbour);
  EXPECT_EQ(cut.state.hash(), spared.state.hash());
  cut.neighbour().solid.remove({23, 23, 41});
  EXPECT_NE(cut.state.hash(), spared.state.hash());
}

TEST(BodyTick, AllocatesNothing) {
  TwoBalls run(true);
  Pose on_neighbour = on_top();
  on_neighbour.position.z() += 3e-3;
  run.step(on_neighbour);  // tables are made once, on first use
  const std::uint64_t before = test::allocation_count();
  for (int i = 0; i < 50; ++i) run.step(on_neighbour);
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(BodyTick, WithoutOneNothingIsKeptForAny) {
  Scene scene = scene_with_body({}, true);
  const TickScratch with(scene);
  scene.bodies.clear();
  const TickScratch without(scene);
  EXPECT_EQ(without.bodies.capacity(), 1u);
  EXPECT_EQ(2 * without.contact_bytes(), with.contact_bytes());
  EXPECT_LT(without.edits.capacity(), with.edits.capacity());
}

TEST(BodyTick, TheBoxesOfBothHoldTheirVoxels) {
  const Pose place{{3e-3, -1e-3, 2e-3}, rotation_xyz({0.4, -1.1, 2.0})};
  const Scene scene = scene_with_body(place, false);
  for (const Body& body : make_bodies(scene, {Workpiece(ball()), Workpiece(ball())})) {
    for (const Cell& c : test::solid_cells(body.solid.model())) {
      const Vector3d centre = body.world_from_grid.point(body.solid.grid().centre_world(c));
      ASSERT_TRUE(body.bounds_world.contains(centre));
      ASSERT_TRUE(body.solid_bounds_world.contains(centre));
    }
  }
}

TEST(BodyTick, TheBoxOfItsVoxelsEndsWithTheirLeaves) {
  const Body body(scene_with_body({}, false),
                  Workpiece(test::ball({96, 48, 64}, kVoxel, {70.5, 23.5, 20.5}, 12.0)));
  const VoxelGrid& grid = body.solid.grid();
  Eigen::AlignedBox3d centres;
  for (const Cell& c : test::solid_cells(body.solid.model())) centres.extend(grid.centre_world(c));
  const Vector3d beyond = Vector3d::Constant((kLeafEdge + 1) * grid.voxel_m);
  EXPECT_TRUE(Eigen::AlignedBox3d(centres.min() - beyond, centres.max() + beyond)
                  .contains(body.solid_bounds_world));
}

TEST(BodyTick, OneThatIsNotInContactChangesNoForce) {
  TwoBalls near(true, {2e-3, 0.0, 0.0}), far(true, {40e-3, 0.0, 0.0});
  for (int i = 0; i < 60; ++i) {
    Pose pose = on_top();
    pose.position.z() += 0.2e-3 - i * 5e-6;
    TickResult a = near.step(pose);
    const TickResult b = far.step(pose);
    a.contact.leaves = b.contact.leaves;  // the nearer one's leaves are looked at
    a.contact.tested = b.contact.tested;
    ASSERT_TRUE(test::same(a, b)) << i;
  }
  EXPECT_GT(near.state.workpiece().touched_ticks, 0u);
}

}  // namespace
}  // namespace sulcus::body_test
