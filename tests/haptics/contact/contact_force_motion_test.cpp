#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "engine/core/units.hpp"
#include "tests/haptics/contact/contact_evaluation.hpp"
#include "tests/haptics/contact/contact_stages.hpp"

// How contact forces go from pose to pose: steadily, over edges, into thin walls, against a motion.

namespace sulcus::contact_force_motion_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using namespace test;

// --- Continuity ---------------------------------------------------------------------------------

/// Largest change and largest fall of the force over a micrometre, as the burr goes in from just
/// off the surface.
struct Steps {
  double change_N = 0.0, fall_N = 0.0;
};

Steps largest_steps(const Workpiece& workpiece, const Vector3d& touch_world, const Vector3d& out,
                    const Vector3d& axis, Scaling scaling) {
  // The round head's lowest point along `out` when its centre is off by its radius.
  const double radius_m = 0.7e-3;
  ContactScratch scratch(with(scaling));
  const std::vector<TissueSettings> tissues = test::one_tissue();
  Steps largest;
  Vector3d last_N = Vector3d::Zero();
  for (int um = -60; um <= 120; ++um) {
    const Vector3d centre = touch_world + out * (radius_m - um * 1e-6);
    const Pose pose = test::pose_along(centre - radius_m * axis, axis);
    const Vector3d force_N =
        evaluate_contact(workpiece, {round_burr(), pose, tissues, with(scaling)}, scratch)
            .wrench.force_N;
    if (um > -60) {
      largest.change_N = std::max(largest.change_N, (force_N - last_N).norm());
      largest.fall_N = std::max(largest.fall_N, (last_N - force_N).dot(out));
    }
    last_N = force_N;
  }
  EXPECT_GT(last_N.dot(out), 0.5) << "it is in contact at the end";
  return largest;
}

TEST(ContactForce, SmoothNeverJumpsNorFallsWhenVoxelsEnterOnPlanes) {
  // A plane gives at most 2 K of stiffness: the mean of depths weighted by themselves.
  const double bound_N = 2.0 * kStiffness * 1e-6;
  const Vector3d touch(0.01e-3, 0.02e-3, 0), up = Vector3d::UnitZ();
  const Steps flat = largest_steps(flat_block(), touch, up, up, Scaling::kSmooth);
  EXPECT_LT(flat.change_N, bound_N);
  Steps tilted;
  for (const Vector3d& out : {Vector3d(0.2, 0.1, 1), Vector3d(0.5, -0.4, 1), Vector3d(1, 0.2, 1),
                              Vector3d(1, 1, 1), Vector3d(-0.7, 1, 0.4)}) {
    const Vector3d n = out.normalized();
    const Workpiece plane(test::half_space({64, 64, 64}, kVoxel, n, Vector3d::Constant(31.5)));
    const Steps steps = largest_steps(plane, {0, 0, 0}, n, n, Scaling::kSmooth);
    tilted.change_N = std::max(tilted.change_N, steps.change_N);
    tilted.fall_N = std::max(tilted.fall_N, steps.fall_N);
  }
  EXPECT_LT(tilted.change_N, bound_N);
  // Under the count a voxel that enters takes stiffness from those that are deep: pushing harder,
  // the hand feels less.
  const Steps count = largest_steps(flat_block(), touch, up, up, Scaling::kCount);
  std::printf(
      "in 1 um, smooth: change %.4f N flat, %.4f N tilted, fall %.5f, %.5f N; "
      "count: change %.4f N, fall %.4f N\n",
      flat.change_N, tilted.change_N, flat.fall_N, tilted.fall_N, count.change_N, count.fall_N);
  EXPECT_LT(flat.fall_N, 1e-4);
  EXPECT_LT(tilted.fall_N, 1e-4);
  EXPECT_GT(count.fall_N, 0.005);
}

TEST(ContactForce, SmoothHardlyJumpsOnCurvesAndInGrooves) {
  const Workpiece balls([] {
    VoxelModel model = test::two_balls();
    model.grid.voxel_m = kVoxel;
    return model;
  }());
  const VoxelGrid& grid = balls.grid();
  const auto world = [&](const Vector3d& p) { return grid.world_from_index(p); };
  const Vector3d a(20.2, 17.6, 22.9), b(28.7, 29.3, 19.4);
  const Vector3d out_a = Vector3d(-1, -1, 0.6).normalized();
  const double ball_N =
      largest_steps(balls, world(a + 13.3 * out_a), out_a, out_a, Scaling::kSmooth).change_N;
  // Into the groove between the balls, in the plane where they meet.
  const Vector3d out_groove = (b - a).cross(Vector3d(1, 0, 0.3)).normalized();
  const Vector3d meet = 0.5 * (a + b) + 13.0 * out_groove;
  const double groove_N =
      largest_steps(balls, world(meet), out_groove, out_groove, Scaling::kSmooth).change_N;
  std::printf("largest force step in 1 um under smooth: ball %.4f N, groove %.4f N\n", ball_N,
              groove_N);
  EXPECT_LT(ball_N, 3.0 * kStiffness * 1e-6);
  EXPECT_LT(groove_N, 3.0 * kStiffness * 1e-6);
}

TEST(ContactForce, SlidingOverAPlaneRipplesLittleUnderSmooth) {
  const Vector3d out = Vector3d(0.3, 0.2, 1).normalized();
  const Workpiece tilted(test::half_space({64, 64, 64}, kVoxel, out, Vector3d::Constant(31.5)));
  const Vector3d along = out.cross(Vector3d::UnitY()).normalized();
  double least = 1e9, most = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Pose pose = test::pose_along(-0.1e-3 * out + along * (i - 50) * 4e-6, out);
    const double force_N =
        Evaluation(tilted, round_burr(), pose, Scaling::kSmooth).result.wrench.force_N.dot(out);
    least = std::min(least, force_N);
    most = std::max(most, force_N);
  }
  std::printf("sliding over a tilted plane: %.3f to %.3f N\n", least, most);
  EXPECT_LT(most - least, 0.06 * most);
}

// --- Edges --------------------------------------------------------------------------------------

TEST(ContactForce, BehindACouplingTheForceTurnsWithTheToolRoundAnEdge) {
  // An edge of 90 degrees along y at the origin; the ball's middle goes round it, a voxel deep.
  const Workpiece edge(test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {32, 64, 32}));
  const auto turn_deg = [](const Vector3d& v) { return std::atan2(v.x(), v.z()) / kDegree - 45.0; };
  double largest_deg[2] = {}, off_deg[2] = {};  // plain, coupled
  for (const bool coupled : {false, true}) {
    std::optional<double> before_deg;
    for (double at_deg = -40.0; at_deg <= 40.0; at_deg += 1.0) {
      const double a = (45.0 + at_deg) * kDegree, r = kRadius - kVoxel;
      const Vector3d middle(r * std::sin(a), 0.3 * kVoxel, r * std::cos(a));
      const Evaluation e(edge, round_burr(), test::upright(middle - kRadius * Vector3d::UnitZ()),
                         Scaling::kSmooth, nullptr,
                         coupled ? Outputs::kCoupling : Outputs::kForceAndStiffness);
      ASSERT_GT(e.result.contacts, 0u) << at_deg;
      const double now_deg = turn_deg(e.result.wrench.force_N);
      off_deg[coupled] = std::max(off_deg[coupled], std::abs(now_deg - at_deg));
      if (before_deg) {
        largest_deg[coupled] = std::max(largest_deg[coupled], std::abs(now_deg - *before_deg));
      }
      before_deg = now_deg;
    }
  }
  std::printf("round an edge, degrees off the tool's: %.1f, coupled %.1f; in 1 degree %.1f, %.1f\n",
              off_deg[0], off_deg[1], largest_deg[0], largest_deg[1]);
  EXPECT_GT(off_deg[0], 15.0) << "else there is nothing to be mended";
  EXPECT_LT(off_deg[1], 8.0);
  EXPECT_LT(largest_deg[1], 5.0);
}

TEST(ContactForce, AwayFromEdgesACouplingChangesNoDirection) {
  for (const Vector3d& out : {Vector3d(0, 0, 1), Vector3d(0.2, 0.1, 1), Vector3d(0.5, -0.4, 1)}) {
    const Vector3d n = out.normalized();
    const Workpiece plane(test::half_space({64, 64, 64}, kVoxel, n, Vector3d::Constant(31.5)));
    const Vector3d tip = (kRadius - 20e-6) * n - kRadius * Vector3d::UnitZ();
    const Evaluation plain(plane, round_burr(), test::upright(tip), Scaling::kSmooth),
        coupled(plane, round_burr(), test::upright(tip), Scaling::kSmooth, nullptr,
                Outputs::kCoupling);
    const Vector3d a = plain.result.wrench.force_N, b = coupled.result.wrench.force_N;
    ASSERT_GT(a.norm(), 0.01);
    EXPECT_LT((a - b).norm(), 2e-3 * a.norm()) << n.transpose();
  }
}

// --- Thin walls ---------------------------------------------------------------------------------

TEST(ContactForce, AThinWallPushesBackLikeAThickOne) {
  const Burr burr = make_burr(test::small_burr(BurrShape::kRound, 1.0e-3), kVoxel);
  for (const Vector3d& towards :
       {Vector3d(0, 0, 1), Vector3d(0.3, 0.2, 1), Vector3d(1, 0.4, 0.8)}) {
    const Vector3d out = towards.normalized();
    const auto wall = [&](double thickness) {
      return Workpiece(test::make_model({64, 64, 64}, kVoxel, [&](const Cell& c) {
        const double depth = -out.dot(c.cast<double>() - Vector3d(31.7, 31.6, 31.9));
        return depth >= 0.0 && depth < thickness;
      }));
    };
    const Workpiece thin = wall(2.0), thick = wall(24.0);
    const Vector3d surface = thin.grid().world_from_index(Vector3d(31.7, 31.6, 31.9)) +
                             0.5 * out.cwiseAbs().maxCoeff() * kVoxel * out;
    const Pose pose = test::pose_along(surface - 0.1e-3 * out, out);
    const Vector3d thin_N = Evaluation(thin, burr, pose, Scaling::kSmooth).result.wrench.force_N;
    const Vector3d thick_N = Evaluation(thick, burr, pose, Scaling::kSmooth).result.wrench.force_N;
    std::printf("wall of 2 voxels: %.3f N of %.3f N, %.1f deg off\n", thin_N.dot(out),
                thick_N.dot(out), test::angle_deg(thin_N, out));
    EXPECT_GT(thick_N.dot(out), 1.0);
    EXPECT_GT(thin_N.dot(out), 0.9 * thick_N.dot(out));
    EXPECT_LT(test::angle_deg(thin_N, out), 5.0);
  }
}

// --- Stiffness ----------------------------------------------------------------------------------

TEST(ContactForce, StiffnessIsTheDerivativeOfTheWrenchOnAFlatFace) {
  // A flat end wider than the block: depths are exactly linear in the pose.
  const Workpiece pillar(test::block({32, 32, 64}, kVoxel, {8, 8, 0}, {24, 24, 32}));
  const Burr burr = make_burr(test::small_burr(BurrShape::kFissure, 4e-3), kVoxel);
  const auto evaluate = [&](const Pose& pose) {
    ContactScratch scratch(with(Scaling::kNone));
    // The normals of an endless plane.
    return test::force_of(pillar, burr, pose, 0.0, Scaling::kNone, Outputs::kForceAndStiffness,
                          scratch, [](const Cell&) { return std::pair(Vector3f(0, 0, 1), 0.0f); });
  };
  const Pose pose = test::upright({0.3e-3, 0.2e-3, -0.06e-3});
  const Vector3d reference = pose.position + Vector3d(0, 0, burr.reference_m);
  const ContactResult at = evaluate(pose);
  ASSERT_EQ(at.contacts, 256u);
  EXPECT_NEAR(at.stiffness(2, 2), 256 * kStiffness, 1e-6 * 256 * kStiffness);
  EXPECT_TRUE(at.stiffness.isApprox(at.stiffness.transpose(), 0.0));

  // Along x and y the reference moves with the force held, which is no part of the stiffness.
  for (int column = 2; column < 6; ++column) {
    const double step = column < 3 ? 1e-6 : 1e-5;  // m; rad
    Eigen::Matrix<double, 6, 1> difference = Eigen::Matrix<double, 6, 1>::Zero();
    for (int sign : {-1, 1}) {
      Pose moved = pose;
      if (column < 3) {
        moved.position += sign * step * Vector3d::Unit(column);
      } else {
        const Eigen::Quaterniond turn(Eigen::AngleAxisd(sign * step, Vector3d::Unit(column - 3)));
        moved.position = reference + turn * (pose.position - reference);
        moved.orientation = turn * pose.orientation;
      }
      const Wrench wrench = evaluate(moved).wrench;
      const double scale = -sign / (2.0 * step);
      difference.head<3>() += scale * wrench.force_N;
      difference.tail<3>() += scale * wrench.torque_Nm;
    }
    const double size = at.stiffness.col(column).norm() + 1e-9 * at.stiffness.norm();
    EXPECT_LT((difference - at.stiffness.col(column)).norm(), 2e-3 * size)
        << "column " << column << "\n"
        << difference.transpose() << "\n"
        << at.stiffness.col(column).transpose();
  }
}

TEST(ContactForce, UnderSmoothTheStiffnessHasTheDerivativesOfTheWeights) {
  // A flat end on a pillar: 256 surface points, all as deep.
  const Workpiece pillar(test::block({32, 32, 64}, kVoxel, {8, 8, 0}, {24, 24, 32}));
  const Burr burr = make_burr(test::small_burr(BurrShape::kFissure, 4e-3), kVoxel);
  const auto evaluate = [&](double depth_m) {
    const Pose pose = test::upright({0.3e-3, 0.2e-3, -depth_m});
    ContactScratch scratch(with(Scaling::kSmooth));
    return test::force_of(pillar, burr, pose, kVoxel, Scaling::kSmooth, Outputs::kForceAndStiffness,
                          scratch, [](const Cell& cell) {
                            const float side =
                                cell.z() == 31 ? 1.0f : -1.0f;  // those below are dropped
                            return std::pair(Vector3f(0, 0, side), 0.5f);
                          });
  };
  // The sum of weights, 256 d / voxel, divides from 2 um on.
  for (const double depth_m : {1.5e-6, 3e-6, 20e-6}) {
    constexpr double kStep = 0.2e-6;
    const double difference = (evaluate(depth_m + kStep).wrench.force_N.z() -
                               evaluate(depth_m - kStep).wrench.force_N.z()) /
                              (2.0 * kStep);
    const ContactResult at = evaluate(depth_m);
    ASSERT_EQ(at.contacts, 256u);
    EXPECT_NEAR(at.stiffness(2, 2), difference, 2e-3 * difference) << depth_m;
  }
}

TEST(ContactForce, McNeelysIsDividedByTheTensOfContacts) {
  const auto force_N = [](double depth_m, Scaling scaling, std::uint32_t& contacts) {
    const Evaluation e(flat_block(), round_burr(), test::upright({0, 0, -depth_m}), scaling);
    contacts = e.result.contacts;
    return e.result.wrench.force_N.z();
  };
  for (const double depth_m : {0.027e-3, 0.2e-3}) {
    std::uint32_t contacts = 0;
    const double plain_N = force_N(depth_m, Scaling::kNone, contacts);
    const double tens = std::max(1.0, contacts / 10.0);
    EXPECT_EQ(tens > 1.0, depth_m > 0.1e-3) << contacts;
    EXPECT_NEAR(force_N(depth_m, Scaling::kMcNeely, contacts), plain_N / tens, 1e-6 * plain_N);
  }
}

TEST(ContactForce, StiffnessIsPositiveSemidefiniteWhereWeightsDoNotGrow) {
  for (const Scaling scaling : {Scaling::kNone, Scaling::kCount, Scaling::kMcNeely}) {
    const Evaluation e(flat_block(), round_burr(),
                       test::pose_along({0.2e-3, 0, -0.1e-3}, Vector3d(0.2, 0.1, 1).normalized()),
                       scaling);
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(e.result.stiffness);
    EXPECT_GT(solver.eigenvalues().maxCoeff(), 0.0);
    EXPECT_GT(solver.eigenvalues().minCoeff(), -1e-9 * solver.eigenvalues().maxCoeff());
  }
}

// --- Cutting ------------------------------------------------------------------------------------

Burr resting(Burr burr) {
  burr.speed_rad_per_s = 0.0;
  return burr;
}

TEST(ContactForce, SlidingFastTheTangentialForceIsBetaTimesTheNormalOneAgainstTheMotion) {
  const Burr burr = resting(round_burr());
  const Pose pose = test::upright({0, 0, -0.1e-3});
  Twist twist;
  twist.linear_m_per_s = Vector3d(0.03, 0.04, 0);
  const Evaluation still(flat_block(), burr, pose, Scaling::kSmooth);
  const Evaluation sliding(flat_block(), burr, pose, Scaling::kSmooth, &twist);
  const double normal_N = still.result.wrench.force_N.z();
  const Vector3d tangential = sliding.result.wrench.force_N - still.result.wrench.force_N;
  EXPECT_TRUE(tangential.isApprox(-0.3 * normal_N * Vector3d(0.6, 0.8, 0), kFloat));
  double power_W = 0.0;
  for (const Contact contact : sliding.scratch.contacts) power_W += contact.power_W;
  EXPECT_NEAR(power_W, 0.3 * normal_N * 0.05, 1e-9);
  for (const Contact contact : still.scratch.contacts) EXPECT_EQ(contact.power_W, 0.0);
}

TEST(ContactForce, SlidingSlowlyTheTangentialForceFadesWithTheSpeed) {
  const Burr burr = resting(round_burr());
  const Pose pose = test::upright({0, 0, -0.1e-3});
  const double normal_N =
      Evaluation(flat_block(), burr, pose, Scaling::kSmooth).result.wrench.force_N.z();
  for (const double speed : {0.0, 1e-6, 1e-3, 5e-3}) {
    Twist twist;
    twist.linear_m_per_s = Vector3d(-speed, 0, 0);
    const Evaluation e(flat_block(), burr, pose, Scaling::kSmooth, &twist);
    EXPECT_NEAR(e.result.wrench.force_N.x(), 0.3 * normal_N * speed / 10e-3,
                kFloat * normal_N * speed / 10e-3);
    double power_W = 0.0;
    for (const Contact contact : e.scratch.contacts) power_W += contact.power_W;
    EXPECT_NEAR(power_W, 0.3 * normal_N * speed * speed / 10e-3,
                kFloat * normal_N * speed * speed / 10e-3);
  }
}

TEST(ContactForce, MotionAlongTheNormalHasNoTangentialForce) {
  const Burr burr = resting(round_burr());
  const Pose pose = test::upright({0, 0, -0.1e-3});
  Twist twist;
  twist.linear_m_per_s = Vector3d(0, 0, -0.5);
  const Evaluation still(flat_block(), burr, pose, Scaling::kSmooth);
  const Evaluation pressing(flat_block(), burr, pose, Scaling::kSmooth, &twist);
  EXPECT_TRUE(pressing.result.wrench.force_N.isApprox(still.result.wrench.force_N, 1e-12));
}

TEST(ContactForce, TheSpindleRubsAcrossTheAxis) {
  // Held at 60 degrees the contact lies beside the axis: the burr's surface there moves along
  // axis x radius, and the tooth drags the tool the other way.
  const Vector3d axis = Vector3d(std::sqrt(0.75), 0, 0.5);
  const Vector3d centre(0, 0, 0.7e-3 - 0.1e-3);
  const Pose pose = test::pose_along(centre - 0.7e-3 * axis, axis);
  const Twist rest{.spindle_rad_per_s = round_burr().speed_rad_per_s};
  const Evaluation e(flat_block(), round_burr(), pose, Scaling::kSmooth, &rest);
  const Vector3d surface_velocity =
      (round_burr().speed_rad_per_s * axis).cross(Vector3d(0, 0, -0.6e-3));
  ASSERT_GT(surface_velocity.norm(), 0.3);
  const Vector3d force_N = e.result.wrench.force_N;
  const double tangential_N = force_N.dot(surface_velocity.normalized());
  EXPECT_LT(tangential_N, 0.0);
  EXPECT_NEAR(-tangential_N, 0.3 * force_N.z(), 0.01 * force_N.z());
}

TEST(ContactForce, OnTheAxisOfTheSpindleNothingIsDividedByNought) {
  const Twist rest{.spindle_rad_per_s = round_burr().speed_rad_per_s};
  const Evaluation e(flat_block(), round_burr(), test::upright({0, 0, -0.1e-3}), Scaling::kSmooth,
                     &rest);
  EXPECT_TRUE(e.result.wrench.force_N.allFinite());
  EXPECT_LT(e.result.wrench.force_N.head<2>().norm(), 0.01 * e.result.wrench.force_N.z());
  for (const Contact contact : e.scratch.contacts) EXPECT_TRUE(std::isfinite(contact.power_W));
}

}  // namespace
}  // namespace sulcus::contact_force_motion_test
