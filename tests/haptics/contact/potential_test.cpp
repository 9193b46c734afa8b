#include "haptics/contact/potential.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "haptics/contact/normal_cache.hpp"
#include "haptics/contact/normals.hpp"
#include "tests/haptics/contact/contact_evaluation.hpp"

namespace sulcus::potential_test {
namespace {

using Eigen::Vector3d;
using test::Evaluation;
using test::kRadius;
using test::kStiffness;
using test::kVoxel;

/// A round burr whose field is as fine as a scene's.
const Burr& fine_burr() {
  static const Burr burr = [] {
    BurrSettings settings = test::small_burr();
    settings.field_samples = Eigen::Vector3i(128, 512, 128);
    return make_burr(settings, kVoxel);
  }();
  return burr;
}

Evaluation at(const Workpiece& workpiece, const Pose& pose,
              Outputs outputs = Outputs::kForceAndStiffness) {
  return Evaluation(workpiece, fine_burr(), pose, Scaling::kPotential, nullptr, outputs);
}

/// The force at many poses of a burr at a workpiece that stays as it is: memory and normals are
/// kept from one to the next, as from tick to tick, which changes no force.
class Forces {
 public:
  Forces(const Workpiece& workpiece, Scaling scaling)
      : workpiece_(workpiece),
        settings_(test::with(scaling)),
        scratch_(settings_),
        normals_(workpiece.grid(), settings_) {}
  Vector3d at(const Pose& pose) {
    const ContactResult result = evaluate_contact(
        workpiece_, {fine_burr(), pose, test::one_tissue(), settings_, nullptr, Outputs::kForce},
        scratch_, &normals_);
    keep_normals(settings_, ++tick_, scratch_, normals_);
    return result.wrench.force_N;
  }

 private:
  const Workpiece& workpiece_;
  const HapticsSettings settings_;
  ContactScratch scratch_;
  NormalCache normals_;
  std::uint64_t tick_ = 0;
};

/// Half a cube, cut at z = 0 and x = 0.
const Workpiece& edge_block() {
  static const Workpiece workpiece(test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {32, 64, 32}));
  return workpiece;
}

/// Turned about the burr's torque reference by small angles, and moved.
Pose moved(const Pose& pose, const Vector3d& way_m, const Vector3d& turn_rad) {
  const Vector3d reference = pose.point({0.0, fine_burr().reference_m, 0.0});
  const double angle = turn_rad.norm();
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(angle, angle > 0.0 ? Vector3d(turn_rad / angle) : Vector3d::UnitX()));
  return {reference + turn * (pose.position - reference) + way_m, turn * pose.orientation};
}

TEST(Potential, TheWrenchIsMinusTheGradientOfTheEnergy) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const Workpiece ball(test::ball({64, 64, 64}, kVoxel, {31.3, 30.8, 2.0}, 29.6));
  for (const Workpiece* workpiece : {&test::flat_block(), &edge_block(), &ball}) {
    int touching = 0;
    for (int n = 0; n < 20; ++n) {
      const Vector3d axis = Vector3d(0.4 * unit(random), 0.4 * unit(random), 1.0).normalized();
      const Pose pose = test::pose_along(
          {0.3e-3 * unit(random), 0.3e-3 * unit(random), -0.15e-3 * (1.2 + unit(random))}, axis);
      const ContactResult here = at(*workpiece, pose).result;
      // In the burr's middle its gradient has no direction.
      if (here.contacts < 20 || here.deepest_m > 0.5 * kRadius) continue;
      ++touching;
      // Between two samples of the field its gradient is even; so much that few are crossed.
      for (int a = 0; a < 6; ++a) {
        const double step = a < 3 ? 5e-8 : 5e-6;  // m; rad
        const auto energy_J = [&](double sign) {
          Vector3d way = Vector3d::Zero(), turn = Vector3d::Zero();
          (a < 3 ? way : turn)[a % 3] = sign * step;
          return at(*workpiece, moved(pose, way, turn)).result.energy_J;
        };
        const double expected = -(energy_J(1.0) - energy_J(-1.0)) / (2.0 * step);
        const double found = a < 3 ? here.wrench.force_N[a] : here.wrench.torque_Nm[a - 3];
        const double size = a < 3 ? here.wrench.force_N.norm() : here.wrench.torque_Nm.norm();
        EXPECT_NEAR(found, expected, 0.01 * size + (a < 3 ? 1e-3 : 4e-5)) << "axis " << a;
      }
    }
    EXPECT_GT(touching, 8);
  }
}

/// Work that a contact takes in along a way of the burr's middle, J, and the most of it on the way.
struct WayWork {
  double in_J = 0.0, most_J = 0.0;
};
template <class Way>
WayWork work_along(const Workpiece& workpiece, Scaling scaling, int steps, const Way& way) {
  WayWork work;
  Forces forces(workpiece, scaling);
  Vector3d force_before = Vector3d::Zero(), place_before = Vector3d::Zero();
  for (int i = 0; i <= steps; ++i) {
    const Vector3d place = way(static_cast<double>(i) / steps);
    const Pose pose = test::upright(place - Vector3d(0, 0, kRadius));
    const Vector3d force = forces.at(pose);
    if (i > 0) work.in_J -= 0.5 * (force + force_before).dot(place - place_before);
    work.most_J = std::max(work.most_J, work.in_J);
    force_before = force, place_before = place;
  }
  return work;
}

/// Into the top, `depth_m` deep, over the edge to a quarter of that, and out of the side; the
/// middle of a round burr.
Vector3d over_the_edge(double depth_m, double part) {
  const double over = std::clamp((part - 0.4) / 0.2, 0.0, 1.0);
  const double d = kRadius - depth_m * (1.0 - 0.75 * over);
  const double out = kRadius + 0.01e-3, length = 0.5e-3, y = 0.013e-3;
  if (part < 0.2) return {-length, y, out + (d - out) * part / 0.2};
  if (part < 0.4) return {-length * (0.4 - part) / 0.2, y, d};
  if (part < 0.6) {
    const double angle = 0.5 * std::numbers::pi * (part - 0.4) / 0.2;
    return {d * std::sin(angle), y, d * std::cos(angle)};
  }
  if (part < 0.8) return {d, y, -length * (part - 0.6) / 0.2};
  return {d + (out - d) * (part - 0.8) / 0.2, y, -length};
}

TEST(Potential, WhatAWayOverAnEdgeTakesInItGivesBack) {
  for (const double depth_m : {0.05e-3, 0.1e-3, 0.2e-3}) {
    for (const bool back : {false, true}) {
      const auto way = [&](double part) {
        return over_the_edge(depth_m, back ? 1.0 - part : part);
      };
      const WayWork work = work_along(edge_block(), Scaling::kPotential, 4000, way);
      EXPECT_GT(work.most_J, 0.8 * kStiffness * depth_m * depth_m / 3.0);
      EXPECT_LT(std::abs(work.in_J), 0.005 * work.most_J) << depth_m << (back ? " back" : "");
    }
  }
  // What the way is worth as a test: without a potential a turn is not free.
  const WayWork smooth = work_along(edge_block(), Scaling::kSmooth, 4000,
                                    [](double part) { return over_the_edge(0.1e-3, part); });
  EXPECT_GT(std::abs(smooth.in_J), 0.1 * smooth.most_J);
}

TEST(Potential, ARoundBurrOnAFaceIsTwoThirdsAsStiffAsTheTissue) {
  for (const double depth_m : {0.05e-3, 0.1e-3}) {
    for (int n = 0; n < 20; ++n) {
      const Pose pose = test::pose_along(
          Vector3d(0.37 * n, 0.21 * n, 0.0) * kVoxel +
              kRadius * (Vector3d::UnitZ() - Vector3d(0.3, 0.2, 0.9).normalized()) -
              Vector3d(0, 0, depth_m),
          Vector3d(0.3, 0.2, 0.9).normalized());
      const Vector3d force = at(test::flat_block(), pose).result.wrench.force_N;
      EXPECT_NEAR(force.z(), 2.0 / 3.0 * kStiffness * depth_m, 0.05 * force.z());
      EXPECT_LT(force.head<2>().norm(), 0.01 * force.z());
    }
  }
}

TEST(Potential, StiffnessIsTheDerivativeOfTheForceAcrossAFace) {
  for (const double depth_m : {0.015e-3, 0.05e-3, 0.1e-3}) {
    const auto pose = [&](double deeper_m) {
      return test::upright({0.017e-3, 0.011e-3, -depth_m - deeper_m});
    };
    constexpr double kStep = 1e-6;
    const double difference = (at(test::flat_block(), pose(kStep)).result.wrench.force_N.z() -
                               at(test::flat_block(), pose(-kStep)).result.wrench.force_N.z()) /
                              (2.0 * kStep);
    const Matrix6d stiffness = at(test::flat_block(), pose(0.0)).result.stiffness;
    EXPECT_NEAR(stiffness(2, 2), difference, 0.05 * difference) << depth_m;
    // A face holds nothing that slides along it: what points at a slant hold, the turning of
    // their directions takes back.
    EXPECT_LT(std::abs(stiffness(0, 0)), 0.03 * difference);
    EXPECT_LT(std::abs(stiffness(1, 1)), 0.03 * difference);
  }
}

TEST(Potential, APointComesInWithoutAStepOfForce) {
  // Over a corner, where few points come one by one.
  const Workpiece corner(test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {32, 32, 32}));
  Forces forces(corner, Scaling::kPotential);
  Vector3d before = Vector3d::Zero();
  double largest_N = 0.0;
  for (int n = 0; n < 2000; ++n) {
    const Vector3d middle = Vector3d(0.5, 0.4, 0.8).normalized() * (kRadius - 0.1e-6 * n);
    const Vector3d force = forces.at(test::upright(middle - Vector3d(0, 0, kRadius)));
    if (n > 0) largest_N = std::max(largest_N, (force - before).norm());
    before = force;
  }
  EXPECT_GT(before.norm(), 0.5);
  // From one cell of the burr's field to the next a direction turns by spacing / radius, 0.02.
  EXPECT_LT(largest_N, 0.025 * before.norm());
}

TEST(Potential, AThinWallPushesBackLikeAThickOneFromWherePointsLie) {
  for (const int voxels : {1, 2, 3, 6}) {
    const Workpiece wall(test::block({64, 64, 64}, kVoxel, {0, 0, 32 - voxels}, {64, 64, 32}));
    const Pose pose = test::upright({0.02e-3, 0.01e-3, -0.1e-3});
    const double thick_N = at(test::flat_block(), pose).result.wrench.force_N.z();
    EXPECT_GT(at(wall, pose).result.wrench.force_N.z(), 0.85 * thick_N) << voxels;
  }
}

TEST(Potential, FrictionTakesTheSharesOfTheForce) {
  Burr still = fine_burr();
  still.speed_rad_per_s = 0.0;
  const Twist twist{{0.1, 0.0, 0.0}, {0, 0, 0}, 0.0};
  const Pose pose = test::upright({0.017e-3, 0.011e-3, -0.1e-3});
  const Evaluation e(test::flat_block(), still, pose, Scaling::kPotential, &twist);
  const double normal_N = (e.result.wrench.force_N - e.result.tangential.force_N).z();
  EXPECT_NEAR(e.result.tangential.force_N.x(), -still.tangential_ratio * normal_N,
              0.05 * normal_N * still.tangential_ratio);
  double power_W = 0.0;
  for (const Contact contact : e.scratch.contacts) {
    EXPECT_GE(contact.normal_force_N, 0.0f);
    power_W += contact.power_W;
  }
  EXPECT_NEAR(power_W, -e.result.tangential.force_N.x() * 0.1, 1e-4 * power_W);
}

}  // namespace
}  // namespace sulcus::potential_test
