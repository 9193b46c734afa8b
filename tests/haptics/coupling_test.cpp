#include "haptics/coupling.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "tests/support/tools.hpp"

namespace sulcus::coupling_test {
namespace {

using Eigen::Vector3d;

constexpr double kVoxel = 50e-6;
constexpr double kHalf = 0.5 * kVoxel;
constexpr double kRadius = 0.5e-3;

const Burr& burr() {
  static const Burr round = make_burr(test::small_burr(BurrShape::kRound, 2.0 * kRadius), kVoxel);
  return round;
}

/// A face at z = 0 that one point of the tool, `at_tool`, presses into: force K times its depth.
struct PointOnFace {
  double stiffness_N_per_m;
  Vector3d at_tool = Vector3d::Zero();

  ContactResult operator()(const Pose& tool) const {
    ContactResult contact;
    const Vector3d at = tool.point(at_tool);
    if (at.z() >= 0.0) return contact;
    contact.contacts = 1;
    const Vector3d force(0, 0, -stiffness_N_per_m * at.z());
    const Vector3d arm = at - tool.point({0.0, burr().reference_m, 0.0});
    contact.wrench = {force, arm.cross(force)};
    Vector6d row;
    row << Vector3d::UnitZ(), arm.cross(Vector3d::UnitZ());
    contact.stiffness = stiffness_N_per_m * row * row.transpose();
    return contact;
  }
};

/// A coupling run tick by tick towards a device that rests, with every pose it asked about.
struct CoupledRun {
  explicit CoupledRun(const Pose& start) : springs(settings, burr()), tool(start) {}

  template <class Contact>
  CoupledResult tick(const Pose& device, const Contact& contact, double free_m = 0.0) {
    const Pose before = device_before.value_or(device);
    device_before = device;
    Pose from = tool;
    return couple(
        springs, settings, burr().reference_m, kHalf, before, device, tool,
        [&](const Pose& pose) {
          ContactResult found = contact(pose);
          const double step_m = (pose.position - from.position).norm();
          if (was_touching) longest_m = std::max(longest_m, step_m);
          was_touching = found.contacts > 0;
          from = pose;
          return found;
        },
        [&](const Pose&, double wanted_m) { return std::min(wanted_m, free_m); });
  }

  CouplingSettings settings;
  CouplingSprings springs;
  Pose tool;
  std::optional<Pose> device_before;
  double longest_m = 0.0;  // of the steps that began in contact
  bool was_touching = false;
};

Wrench felt(const CoupledRun& run, const Pose& device) {
  return pull_on_device(run.springs, device, run.tool, burr().reference_m);
}

TEST(Coupling, AStiffFaceIsFeltAsBothSpringsInARow) {
  CoupledRun run(test::upright({0, 0, 10e-6}));
  const PointOnFace face{300e3};
  for (int i = 0; i <= 1000; ++i) {
    const Pose device = test::upright({0, 0, 10e-6 - i * 1e-6});
    const CoupledResult coupled = run.tick(device, face);
    if (i < 200) continue;
    const double depth_m = i * 1e-6 - 10e-6;
    const double series_N = depth_m / (1.0 / 300e3 + 1.0 / run.settings.stiffness_N_per_m);
    ASSERT_TRUE(coupled.balanced) << i;
    const double little_N = std::max(5e-3, 0.011 * series_N);
    ASSERT_NEAR(felt(run, device).force_N.z(), series_N, little_N) << i;
    ASSERT_NEAR(coupled.contact.wrench.force_N.z(), series_N, little_N) << i;
  }
}

TEST(Coupling, NoStepInContactIsLongerThanAskedForHoweverFarTheDeviceIs) {
  CoupledRun run(test::upright({0, 0, -1e-6}));
  // Soft, so that the whole way is gone in contact.
  const PointOnFace face{100.0};
  const Pose device = test::upright({0, 0, -3e-3});
  for (int i = 0; i < 100; ++i) run.tick(device, face);
  EXPECT_LT(run.tool.position.z(), -1e-3);
  EXPECT_GT(run.longest_m, 0.9 * kHalf);
  EXPECT_LE(run.longest_m, kHalf * (1.0 + 1e-9));
}

/// A ball about the tool's middle, to its tip, presses into what it meets.
struct PressedBall {
  double radius_m = 0.5 * burr().head_length_m;
  static constexpr double kStiffness = 300e3;

  static Vector3d middle(const Pose& tool) {
    return tool.point({0.0, 0.5 * burr().head_length_m, 0.0});
  }
  static void press(const Pose& tool, double depth_m, const Vector3d& normal,
                    ContactResult& contact) {
    if (depth_m <= 0.0) return;
    ++contact.contacts;
    contact.deepest_m = std::max(contact.deepest_m, static_cast<float>(depth_m));
    const Vector3d arm = middle(tool) - tool.point({0.0, burr().reference_m, 0.0});
    Vector6d row;
    row << normal, arm.cross(normal);
    contact.wrench.force_N += kStiffness * depth_m * normal;
    contact.wrench.torque_Nm += kStiffness * depth_m * arm.cross(normal);
    contact.stiffness += kStiffness * row * row.transpose();
  }
};

/// On a face at z = 0, with a wall at x = `wall_m`.
struct BallOnFace : PressedBall {
  double wall_m = std::numeric_limits<double>::infinity();

  ContactResult operator()(const Pose& tool) const {
    ContactResult contact;
    press(tool, radius_m - middle(tool).z(), Vector3d::UnitZ(), contact);
    press(tool, radius_m - (wall_m - middle(tool).x()), -Vector3d::UnitX(), contact);
    return contact;
  }
};

/// On a dome of this radius, whose top is at z = 0.
struct BallOnDome : PressedBall {
  double dome_m;

  Vector3d out(const Pose& tool) const { return middle(tool) + dome_m * Vector3d::UnitZ(); }
  ContactResult operator()(const Pose& tool) const {
    ContactResult contact;
    press(tool, radius_m + dome_m - out(tool).norm(), out(tool).normalized(), contact);
    return contact;
  }
};

TEST(Coupling, AlongAFaceTheToolComesWithTheDeviceAtAnySpeed) {
  for (const double way_m : {1e-6, 50e-6, 0.5e-3, 2e-3}) {
    CoupledRun run(test::upright({0, 0, 0}));
    Pose device = test::upright({0, 0, -1e-3});
    for (int i = 0; i < 60; ++i) run.tick(device, BallOnFace());
    for (int i = 0; i < 20; ++i) {
      device.position.x() += way_m;
      const CoupledResult coupled = run.tick(device, BallOnFace());
      const Wrench on_device = felt(run, device);
      // 2 mm in a tick are more steps of half a radius than a tick has evaluations.
      if (way_m > 1e-3) {
        EXPECT_TRUE(coupled.lags);
        continue;
      }
      EXPECT_FALSE(coupled.lags);
      EXPECT_LT(std::abs(on_device.force_N.x()), 0.01) << way_m;
      EXPECT_NEAR(on_device.force_N.z(), 0.7, 0.02) << way_m;
    }
  }
}

TEST(Coupling, AWallOnTheWayIsMetNotEntered) {
  for (const double speed_m_per_s : {0.05, 0.2, 0.5}) {
    const BallOnFace contact{{}, 2.013e-3};
    CoupledRun run(test::upright({0, 0, 0}));
    Pose device = test::upright({0, 0, -1e-3});
    for (int i = 0; i < 60; ++i) run.tick(device, contact);
    double deepest_m = 0.0;
    for (int i = 0; i * speed_m_per_s * 1e-3 < 4e-3; ++i) {
      device.position.x() += speed_m_per_s * 1e-3;
      run.tick(device, contact);
      deepest_m = std::max(deepest_m, run.tool.position.x() + contact.radius_m - contact.wall_m);
    }
    for (int i = 0; i < 30; ++i) run.tick(device, contact);
    EXPECT_LT(deepest_m, 2.0 * kHalf) << speed_m_per_s;
    EXPECT_NEAR(felt(run, device).force_N.x(),
                -0.7e3 * (4e-3 - (contact.wall_m - contact.radius_m)), 0.02)
        << speed_m_per_s;
  }
}

TEST(Coupling, FreeSpaceIsCrossedAsFarAsItIsKnownToBeFree) {
  const auto nothing = [](const Pose&) { return ContactResult{}; };
  const Pose device = test::upright({3e-3, 0, 5e-3});
  CoupledRun known(test::upright({0, 0, 1e-3}));
  known.device_before = known.tool;  // the device goes all of the way in this tick
  known.tick(device, nothing, 1.0);
  EXPECT_LT((known.tool.position - device.position).norm(), 1e-6);
  CoupledRun unknown(test::upright({0, 0, 1e-3}));
  unknown.device_before = unknown.tool;
  unknown.tick(device, nothing);
  EXPECT_NEAR((unknown.tool.position - Vector3d(0, 0, 1e-3)).norm(), 15 * kHalf, 1e-9)
      << "half a voxel at a time";
}

TEST(Coupling, WhatSlipsOffIsLetGoOverTicksNotInOne) {
  const auto nothing = [](const Pose&) { return ContactResult{}; };
  const Pose device = test::upright({0, 0, -4e-3});
  CoupledRun run(test::upright({0, 0, 0}));
  run.device_before = device;
  double last_N = felt(run, device).force_N.z();
  for (int i = 0; i < 25; ++i) {
    run.tick(device, nothing, 1.0);
    const double now_N = felt(run, device).force_N.z();
    EXPECT_LE(last_N - now_N, 0.15 + 1e-9) << i;
    last_N = now_N;
  }
  EXPECT_NEAR(last_N, 0.0, 1e-3);
}

TEST(Coupling, TheSpringsPullNoHarderThanTheirLimits) {
  CoupledRun run(test::upright({0, 0, 1e-6}));
  const PointOnFace face{300e3};
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.2, Vector3d::UnitX()));
  Pose device = test::upright({0, 0, -50e-3});
  device.orientation = turn * device.orientation;
  for (int i = 0; i < 50; ++i) run.tick(device, face);
  const SpringPull pulled = pull(run.springs, device, run.tool);
  EXPECT_NEAR(pulled.wrench.force_N.norm(), run.settings.force_limit_N, 1e-9);
  EXPECT_GT(run.tool.position.z(), -0.2e-3) << "held at the face";
}

TEST(Coupling, APressOffTheAxisTurnsTheToolUntilTheTorquesBalance) {
  // A face met at the side: the springs' middle, R up the axis, is passed at 0.8 R.
  CoupledRun run(test::upright({0, 0, 0}));
  const Vector3d side_tool(0.4e-3, 0.0, 0.0);
  const PointOnFace face{300e3, side_tool};
  run.settings.turning_stiffness_Nm_per_rad = 0.02;
  run.springs = CouplingSprings(run.settings, burr());
  Pose device;
  CoupledResult coupled;
  for (int i = 0; i <= 1000; ++i) {
    device = test::upright({0, 0, -i * 1e-6});
    coupled = run.tick(device, face);
  }
  const Vector3d middle = run.tool.point(run.springs.middle_tool);
  const Vector3d arm = run.tool.point(side_tool) - middle;
  const SpringPull pulled = pull(run.springs, device, run.tool);
  const Vector3d moment = arm.cross(coupled.contact.wrench.force_N);
  EXPECT_GT(moment.norm(), 0.2e-3);
  EXPECT_LT((pulled.wrench.torque_Nm + moment).norm(), 0.03 * moment.norm());
  // And the device gets both, about its own reference point.
  const Wrench on_device = felt(run, device);
  const Vector3d handle = device.point({0.0, burr().reference_m, 0.0});
  const Vector3d expected =
      moment +
      (device.point(run.springs.middle_tool) - handle).cross(coupled.contact.wrench.force_N);
  EXPECT_LT((on_device.torque_Nm - expected).norm(), 0.03 * expected.norm());
}

TEST(Coupling, AWrenchAndAStiffnessAboutAnotherPointDoTheSameWork) {
  const Vector3d from(1e-3, -2e-3, 3e-3), to(-2e-3, 1e-3, 0.5e-3);
  const Wrench wrench{{1, 2, -3}, {4e-3, -5e-3, 6e-3}};
  Vector6d motion_to;
  motion_to << 1e-6, 2e-6, -1e-6, 3e-4, -1e-4, 2e-4;
  // The same motion as seen at `from`.
  Vector6d motion_from = motion_to;
  const Vector3d turn = motion_to.tail<3>();
  motion_from.head<3>() += turn.cross(from - to);
  const auto work = [](const Wrench& w, const Vector6d& m) {
    return w.force_N.dot(m.head<3>()) + w.torque_Nm.dot(m.tail<3>());
  };
  EXPECT_NEAR(work(about(wrench, from, to), motion_to), work(wrench, motion_from), 1e-18);
  Matrix6d stiffness = Matrix6d::Random();
  stiffness = (stiffness * stiffness.transpose()).eval();
  EXPECT_NEAR(motion_to.dot(about(stiffness, from, to) * motion_to),
              motion_from.dot(stiffness * motion_from), 1e-18);
}

TEST(Coupling, AContactThatGivesWayCountsAsNone) {
  SpringPull springs{{}, 700.0, 0.2};
  Matrix6d contact = Matrix6d::Zero();
  contact(2, 2) = 300e3;
  contact(0, 0) = -5e3;  // the further along x, the less it holds
  Vector6d residual = Vector6d::Zero();
  residual[0] = 0.7;
  residual[2] = -0.3;
  const Vector6d step = coupled_step(springs, contact, residual, 1e-3);
  EXPECT_NEAR(step[0], 1e-3, 1e-9) << "as far as the spring alone goes";
  EXPECT_NEAR(step[2], -0.3 / (300e3 + 700.0), 1e-12);
}

TEST(Coupling, GoesOnInTheNextTickWhenTheContactsOfATickAreUsedUp) {
  CoupledRun run(test::upright({0, 0, -1e-6}));
  const PointOnFace face{1e3};
  const auto many = [&](const Pose& pose) {
    ContactResult contact = face(pose);
    contact.contacts *= 12000;
    return contact;
  };
  const Pose device = test::upright({0, 0, -1e-3});
  EXPECT_EQ(run.tick(device, many).evaluations, 2) << "a step there always is";
  EXPECT_GT(run.tool.position.z(), -1e-6 - 1.01 * kHalf);
  const Vector3d first = run.tool.position;
  run.settings.contacts_per_tick = 36000;
  const CoupledResult more = run.tick(device, many);
  EXPECT_EQ(more.evaluations, 3);
  EXPECT_FALSE(more.balanced);
  EXPECT_GT((run.tool.position - first).norm(), 1.5 * kHalf);
}

/// A bump across x, on whose other side, from x = 0 on, the contact pushes another way at once.
struct Ridge {
  ContactResult operator()(const Pose& tool) const {
    const Vector3d middle = tool.point({0.0, 0.5 * burr().head_length_m, 0.0});
    const Vector3d normal = Vector3d(middle.x() < 0.0 ? -0.3 : 0.3, 0.0, 1.0).normalized();
    ContactResult contact;
    const double depth_m = kRadius - normal.dot(middle);
    if (depth_m <= 0.0) return contact;
    constexpr double kStiffness = 50e3;
    contact.contacts = 1;
    const Vector3d reference = tool.point({0.0, burr().reference_m, 0.0});
    contact.wrench.force_N = kStiffness * depth_m * normal;
    contact.wrench.torque_Nm = (middle - reference).cross(contact.wrench.force_N);
    Vector6d row;
    row << normal, (middle - reference).cross(normal);
    contact.stiffness = kStiffness * row * row.transpose();
    return contact;
  }
};

TEST(Coupling, OverAnEdgeTheForceTurnsALittleATickAndByWhatTheWayMakesOfIt) {
  constexpr double kStep_m = 5e-6;
  CoupledRun run(test::upright({-0.3e-3, 0.0, 0.2e-3}));
  EXPECT_NEAR(run.springs.radius_m, kRadius, kVoxel);
  Vector3d before = Vector3d::Zero();
  double turned = 0.0;
  for (int i = 0; i < 120; ++i) {
    const Pose device = test::upright({-0.3e-3 + i * kStep_m, 0.0, -0.2e-3});
    run.tick(device, Ridge{}, 10e-6);
    const Vector3d now = felt(run, device).force_N;
    if (i > 60) {  // it has come down
      const double turn = std::atan2(before.cross(now).norm(), before.dot(now));
      const double arc_m = run.springs.radius_m - before.norm() / run.settings.stiffness_N_per_m;
      EXPECT_LT(turn, 0.005 + kStep_m / arc_m + 1e-9) << i;
      turned += turn;
    }
    before = now;
  }
  EXPECT_GT(turned, 0.2) << "over the edge";
}

TEST(Coupling, AToolThatMaySlideButALittleATickPressesOnTheFaceMeanwhile) {
  // It has just come to the face, and slides to over the device at 0.3 degrees a tick.
  for (const Vector3d& way_m : {Vector3d(0, 0.5e-3, 0), Vector3d(0, -0.5e-3, 0),
                                Vector3d(-0.5e-3, 0, 0), Vector3d(0.3e-3, 0.4e-3, 0)}) {
    CoupledRun run(test::upright({0, 0, -1e-8}));
    const Pose device = test::upright(way_m - 1e-3 * Vector3d::UnitZ());
    for (int i = 0; i < 5; ++i) {
      const CoupledResult coupled = run.tick(device, BallOnFace());
      EXPECT_LT(run.tool.position.head<2>().norm(), 0.05e-3);
      EXPECT_NEAR(coupled.contact.wrench.force_N.z(), felt(run, device).force_N.z(), 0.01) << i;
      EXPECT_GT(coupled.contact.wrench.force_N.z(), 0.69) << i;
    }
  }
}

TEST(Coupling, DownADomeTheToolIsOnItAtTheEndOfATickAsLongAsItIsPulledThere) {
  constexpr double kQuantum_m = 23e-6;  // by which encoders make the device jump
  for (const Vector3d& aside : {Vector3d(0, 1, 0), Vector3d(-1, 0, 0), Vector3d(0.6, -0.8, 0)}) {
    for (const double dome_m : {0.2e-3, 0.35e-3, 0.6e-3, 2e-3}) {
      const BallOnDome dome{{}, dome_m};
      CoupledRun run(test::upright({0, 0, -1e-6}));
      Pose device = test::upright({0, 0, -2e-3});
      for (int i = 0; i < 20; ++i) run.tick(device, dome);
      for (int i = 0; i < 40; ++i) {
        if (i % 3 == 0) device.position += kQuantum_m * aside;
        const CoupledResult coupled = run.tick(device, dome);
        const double pulled_N = felt(run, device).force_N.dot(dome.out(run.tool).normalized());
        EXPECT_TRUE(pulled_N <= 0.1 || coupled.contact.contacts > 0) << dome_m << ", tick " << i;
      }
      EXPECT_GT(run.tool.position.dot(aside), 0.15e-3) << dome_m;
    }
  }
}

TEST(Coupling, ASmallForceTurnsAsItLikes) {
  const CouplingSprings springs(CouplingSettings{}, burr());
  const Pose tool = test::upright({0, 0, 0});
  const Pose near = test::upright({0, 0, -50e-6}), far = test::upright({0, 0, -100e-6});
  EXPECT_EQ(ForceTurn(springs, near, near, tool).cosine, -1.0);
  const ForceTurn turn(springs, far, far, tool);
  EXPECT_LT((turn.felt + Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_NEAR(std::acos(turn.cosine), 0.005, 1e-5);
}

TEST(Coupling, AStepEndsAtTheBorderOfTheConeThatItWouldPass) {
  const Vector3d axis = Vector3d::UnitZ();
  const double cosine = std::cos(0.1);
  const auto part = [&](const Vector3d& stretch, const Vector3d& step) {
    return step_fraction_in_cone(stretch, step, axis, cosine);
  };
  const auto angle_after = [&](const Vector3d& stretch, const Vector3d& step) {
    const Vector3d rest = stretch - part(stretch, step) * step;
    return std::atan2(rest.head<2>().norm(), rest.z());
  };
  EXPECT_EQ(part({0, 0, 1}, {0.05, 0, 0}), 1.0) << "stays within";
  EXPECT_NEAR(angle_after({0, 0, 1}, {0.5, 0, 0}), 0.1, 1e-9) << "from within";
  EXPECT_NEAR(angle_after({0.3, 0, 1}, {0.5, 0, 0}), 0.1, 1e-9) << "all through it";
  EXPECT_GT(part({0.3, 0, 1}, {0.5, 0, 0}), 0.5) << "to the far side";
  EXPECT_EQ(part({0.3, 0, 1}, {0.1, 0, 0}), 1.0) << "towards it";
  EXPECT_EQ(part({-0.3, 0, 1}, {0.1, 0, 0}), 0.0) << "away from it";
  EXPECT_EQ(part({0, 0.5, 1}, {0.1, 0, 0}), 1.0) << "past it";
  EXPECT_EQ(part({0, 0, -1}, {0, 0, 0.5}), 1.0) << "in the opposite one";
}

TEST(Coupling, AStepAlongAStretchOnTheBorderOfTheConeIsNotHeldBack) {
  const Vector3d axis(0.36, 0.48, 0.8);
  const Vector3d across = axis.unitOrthogonal(), third = axis.cross(across);
  for (int i = 0; i < 1000; ++i) {
    const double turn = 0.006 * i, cosine = std::cos(0.005 + 1e-5 * i);
    const Vector3d out = std::cos(turn) * across + std::sin(turn) * third;
    const Vector3d stretch = 1e-3 * (axis + 1e-3 * out);
    const Vector3d step = -1e-4 * out;
    const Vector3d rest = stretch - step_fraction_in_cone(stretch, step, axis, cosine) * step;
    EXPECT_EQ(step_fraction_in_cone(rest, 0.1 * rest, axis, cosine), 1.0) << i;
  }
}

TEST(Coupling, AStepChangesTheSpringsForceByNoMoreThanItMay) {
  const CouplingSettings settings;
  const CouplingSprings springs(settings, burr());
  const double k = springs.stiffness_N_per_m;
  const Vector3d stretch(0, 0, -1e-3);
  const auto part = [&](const Vector3d& stretched, const Vector3d& step, double most_N) {
    Vector3d before = k * stretched;
    if (before.norm() > springs.force_limit_N) before *= springs.force_limit_N / before.norm();
    return step_fraction_of_change(springs, stretched, step, before, most_N);
  };
  EXPECT_EQ(part(stretch, {0.1e-3, 0, 0}, 0.08), 1.0);
  EXPECT_NEAR(part(stretch, {0.2e-3, 0, 0}, 0.07), 0.5, 1e-6);
  EXPECT_NEAR(part(stretch, {0, 0, -1e-3}, 0.07), 0.1, 1e-6);
  // At the springs' limit: along the stretch there is no change, across it the force turns.
  const Vector3d saturated(0, 0, -10e-3);
  EXPECT_EQ(part(saturated, {0, 0, -2e-3}, 0.07), 1.0);
  EXPECT_NEAR(part(saturated, {1e-3, 0, 0}, 0.066), 0.2, 1e-4);
  // A step of no length is a number.
  EXPECT_EQ(part(stretch, {0, 0, 0}, 0.0), 1.0);
  EXPECT_GE(part(stretch, {1e-200, 0, 0}, 0.0), 0.0);
}

TEST(Coupling, AContactThatIsNotFiniteMovesNothing) {
  CoupledRun run(test::upright({0, 0, 0}));
  const auto broken = [](const Pose&) {
    ContactResult contact;
    contact.contacts = 1;
    contact.wrench.force_N.x() = std::numeric_limits<double>::quiet_NaN();
    return contact;
  };
  EXPECT_EQ(run.tick(test::upright({0, 0, -1e-3}), broken).evaluations, 1);
  EXPECT_EQ(run.tool.position, Vector3d(0, 0, 0));
}

}  // namespace
}  // namespace sulcus::coupling_test
