#include "haptics/contact/covered_faces.hpp"

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus::covered_faces_test {
namespace {

using Eigen::Vector3d;

constexpr double kVoxel = 50e-6;

/// One block, or the same cut in two bodies that meet at x = 0.
struct Halves {
  explicit Halves(Scaling scaling, const Pose& place = {}, bool keep_normals = true) {
    scene.tissues = test::one_tissue();
    scene.haptics.scaling = scaling;
    scene.haptics.keep_normals = keep_normals;
    BodySettings& other = scene.bodies.emplace_back();
    other.world_from_grid = place;
    bodies.emplace_back(scene,
                        Workpiece(test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {32, 64, 32})));
    bodies.emplace_back(scene, other,
                        Workpiece(test::block({64, 64, 64}, kVoxel, {32, 0, 0}, {64, 64, 32})));
    scratch.emplace_back(scene.haptics);
    scratch.emplace_back(scene.haptics);
  }
  ContactResult contact(const Burr& burr, const Pose& pose, Outputs outputs = Outputs::kForce) {
    const std::array near{NearBody{&bodies[0], &scratch[0], &results[0]},
                          NearBody{&bodies[1], &scratch[1], &results[1]}};
    return evaluate_contact(near, {burr, pose, scene.tissues, scene.haptics, nullptr, outputs});
  }

  Scene scene;
  std::vector<Body> bodies;
  std::vector<ContactScratch> scratch;
  std::array<ContactResult, 2> results;
};

const Burr& burr() {
  static const Burr burr = make_burr(test::small_burr(), kVoxel);
  return burr;
}

class CoveredFaces : public ::testing::TestWithParam<Scaling> {};

TEST_P(CoveredFaces, OverTheSeamOfTwoHalvesTheForceIsThatOfTheWhole) {
  const Scaling scaling = GetParam();
  const Workpiece whole(test::block({64, 64, 64}, kVoxel, {0, 0, 0}, {64, 64, 32}));
  Halves halves(scaling);
  ContactScratch scratch(halves.scene.haptics);
  for (int n = -8; n <= 8; ++n) {
    for (const Vector3d& axis : {Vector3d(0, 0, 1), Vector3d(0.3, 0.1, 1)}) {
      const Pose pose =
          test::pose_along({0.31 * n * kVoxel, 0.2 * kVoxel, -0.1e-3}, axis.normalized());
      const ContactResult expected =
          evaluate_contact(whole,
                           {burr(), pose, halves.scene.tissues, halves.scene.haptics, nullptr,
                            Outputs::kForceAndStiffness},
                           scratch);
      const ContactResult found = halves.contact(burr(), pose, Outputs::kForceAndStiffness);
      const double size_N = expected.wrench.force_N.norm();
      ASSERT_GT(size_N, 0.5);
      // At the rim one more or less: near the seam normals are out by tenths of a degree.
      EXPECT_NEAR(found.contacts, expected.contacts, 1) << n;
      EXPECT_LT((found.wrench.force_N - expected.wrench.force_N).norm(), 0.01 * size_N) << n;
      const Eigen::Matrix3d of_whole = expected.stiffness.topLeftCorner(3, 3);
      const Eigen::Matrix3d of_halves = found.stiffness.topLeftCorner(3, 3);
      EXPECT_LT((of_halves - of_whole).norm(), 0.02 * of_whole.norm()) << n;
    }
  }
}

TEST_P(CoveredFaces, WhereTheBodiesLieApartEachHasAllItsFaces) {
  // A gap of two voxels: the burr is wider, and feels both rims as each body by itself has them.
  const Pose apart{{2.0 * kVoxel, 0, 0}, Eigen::Quaterniond::Identity()};
  Halves halves(GetParam(), apart);
  const Pose over = test::upright({kVoxel, 0.2 * kVoxel, -0.1e-3});
  const ContactQuery query{burr(), over, halves.scene.tissues, halves.scene.haptics};
  ContactResult alone;
  for (const Body& body : halves.bodies) {
    ContactScratch scratch(halves.scene.haptics);
    ContactResult result;
    const NearBody near{&body, &scratch, &result};
    alone += evaluate_contact({&near, 1}, query);
  }
  const ContactResult found = halves.contact(burr(), over);
  EXPECT_EQ(found.contacts, alone.contacts);
  const double together = found.wrench.force_N.z() / alone.wrench.force_N.z();
  if (GetParam() == Scaling::kNone) {
    EXPECT_NEAR(together, 1.0, 1e-9);
  } else {
    // One sum divides both: two bodies that lie alike hold as one.
    EXPECT_NEAR(together, 0.5, 0.05);
  }
}

TEST_P(CoveredFaces, OverManyBlocksOfVoxelsTheyAreTheSameWithoutACache) {
  // The seam lies in the first blocks of the second half: what is dropped there moves the rest.
  static const Burr large = make_burr(test::small_burr(BurrShape::kRound, 5e-3), kVoxel);
  const Pose pose = test::upright({0.1e-3, 0.05e-3, -0.9e-3});
  Halves cached(GetParam()), anew(GetParam(), {}, false);
  const ContactResult expected = cached.contact(large, pose), found = anew.contact(large, pose);
  ASSERT_GT(anew.results[1].tested, ContactBlock::kVoxels);
  EXPECT_EQ(found.contacts, expected.contacts);
  EXPECT_EQ(found.wrench.force_N, expected.wrench.force_N);
  EXPECT_EQ(found.wrench.torque_Nm, expected.wrench.torque_Nm);
}

std::string name_of(const ::testing::TestParamInfo<Scaling>& scaling) {
  return std::string(kScalingNames[static_cast<std::size_t>(scaling.param)]);
}
INSTANTIATE_TEST_SUITE_P(Scalings, CoveredFaces,
                         ::testing::Values(Scaling::kNone, Scaling::kCount, Scaling::kSmooth,
                                           Scaling::kPotential),
                         name_of);

}  // namespace
}  // namespace sulcus::covered_faces_test
