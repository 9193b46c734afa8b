#include "tools/sulcus_lab/pareto/net_force.hpp"

#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "engine/scene/trajectory.hpp"
#include "engine/shapes/voxelise_implicit.hpp"

namespace sulcus::lab::net_force_test {
namespace {

using Eigen::Vector3d;

constexpr double kVoxel = 35e-6;
constexpr double kBall = 40.0 * kVoxel, kHead = 20.0 * kVoxel, kDepth = 4.0 * kVoxel;

VoxelGrid grid_of(int cells) {
  VoxelGrid grid;
  grid.cells = Eigen::Vector3i::Constant(cells);
  grid.voxel_m = kVoxel;
  return grid;
}

Burr round_burr() {
  BurrSettings settings;
  settings.diameter_m = 2.0 * kHead;
  settings.field_samples = Eigen::Vector3i(96, 384, 96);
  return make_burr(settings, kVoxel);
}

/// A round burr pressed into a ball about the origin, along `outward_`.
class NetForce : public ::testing::Test {
 protected:
  NetForce()
      : ball_(kBall),
        shape_({side_of(ball_)}, ball_.bounds()),
        workpiece_(voxelise_implicit(ball_, grid_of(96), nullptr)),
        surface_(workpiece_, shape_),
        burr_(round_burr()),
        scratch_(settings_) {
    const Vector3d centre = (kBall + kHead - kDepth) * outward_;
    pose_.orientation = orientation_along(outward_);
    pose_.position = centre - kHead * outward_;
    truth_ = true_force(surface_, burr_, pose_, settings_, scratch_);
  }
  /// The truth as if a tick had found it, its normals turned by `turn`.
  Contacts contacts_turned(const Eigen::Quaterniond& turn, double stronger = 1.0) const {
    Contacts contacts(truth_.contacts.size());
    for (const TrueContact& known : truth_.contacts) {
      Contact contact;
      contact.cell = cell_of_key(known.voxel);
      contact.normal = (turn * known.normal).cast<float>();
      contact.normal_force_N = static_cast<float>(stronger * known.normal_force_N);
      contacts.push_back(contact);
    }
    return contacts;
  }

  SphereShape ball_;
  ComposedShape shape_;
  Workpiece workpiece_;
  KnownSurface surface_;
  Burr burr_;
  HapticsSettings settings_;
  ContactScratch scratch_;
  Vector3d outward_ = Vector3d(0.3, -0.5, 0.8).normalized();
  Pose pose_;
  TrueForce truth_;
};

TEST_F(NetForce, TheTruthIsTakenAtTheFootPoints) {
  ASSERT_GT(truth_.contacts.size(), 200u);
  EXPECT_NEAR(truth_.deepest_m / kVoxel, 4.0, 0.05);  // of points a voxel apart
  for (const TrueContact& contact : truth_.contacts) {
    const Vector3d centre = workpiece_.grid().centre_world(cell_of_key(contact.voxel));
    ASSERT_LT((contact.normal - centre.normalized()).norm(), 1e-9);
  }
  EXPECT_GT(truth_.force_N.normalized().dot(outward_), std::cos(0.01));
  Vector3d sum = Vector3d::Zero();
  for (const TrueContact& contact : truth_.contacts) sum += contact.normal_force_N * contact.normal;
  EXPECT_LT((sum - truth_.force_N).norm(), 1e-5 * truth_.force_N.norm());
}

TEST_F(NetForce, ATickThatIsTrueHasNoError) {
  const NetForceErrors errors = net_force_errors(
      surface_, truth_, contacts_turned(Eigen::Quaterniond::Identity()), truth_.force_N);
  EXPECT_LT(errors.directions, 1e-5);
  EXPECT_LT(errors.own_weights, 1e-5);
  EXPECT_EQ(errors.whole, 0.0);
  EXPECT_LT(errors.mean_angle_deg, 1e-4);
}

TEST_F(NetForce, NormalsTurnedAsOneTurnTheForce) {
  const double turned_deg = 3.0, turned = turned_deg * 0.017453292519943295;
  const Vector3d across = outward_.unitOrthogonal();
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(turned, across));
  const Vector3d force = turn * truth_.force_N;
  const NetForceErrors errors = net_force_errors(surface_, truth_, contacts_turned(turn), force);
  // The force is nearly across the axis of the turn, the normals are within 0.2 rad of that.
  EXPECT_NEAR(errors.directions, 2.0 * std::sin(0.5 * turned), 1e-4);
  EXPECT_NEAR(errors.own_weights, errors.directions, 1e-5);
  EXPECT_NEAR(errors.whole, errors.directions, 1e-5);
  EXPECT_NEAR(errors.mean_angle_deg, turned_deg, 0.1);
}

TEST_F(NetForce, AForceThatIsTooStrongIsAnErrorOfTheWholeAlone) {
  const Contacts contacts = contacts_turned(Eigen::Quaterniond::Identity(), 1.1);
  const NetForceErrors errors = net_force_errors(surface_, truth_, contacts, 1.1 * truth_.force_N);
  EXPECT_LT(errors.directions, 1e-5);
  EXPECT_LT(errors.own_weights, 1e-5);
  EXPECT_NEAR(errors.whole, 0.1, 1e-9);
}

TEST_F(NetForce, TheContinuumsForceOnABallIsItsIntegral) {
  // Over the polar angle t of the ball's surface; a is the distance of the centres, s that from
  // the burr's to the surface.
  const double a = kBall + kHead - kDepth;
  double force = 0.0, weights = 0.0;
  for (double t = 0.5e-5; t < 1.0; t += 1e-5) {
    const double s = std::sqrt(kBall * kBall + a * a - 2.0 * kBall * a * std::cos(t));
    const double depth = kHead - s;
    if (depth <= 0.0) break;
    force += depth * depth * std::cos(t) * std::sin(t);
    weights += depth * std::sin(t);
  }
  const double stiffness = 30e3;
  const Vector3d found = continuum_force(surface_, burr_, pose_, truth_.box_world, stiffness, 3);
  EXPECT_NEAR(found.norm(), stiffness * force / weights, 2e-3 * found.norm());
  EXPECT_GT(found.normalized().dot(outward_), std::cos(1e-3));
  EXPECT_LT((found - truth_.force_N).norm(), 0.02 * found.norm());
}

}  // namespace
}  // namespace sulcus::lab::net_force_test
