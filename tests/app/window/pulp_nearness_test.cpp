#include "app/window/pulp_nearness.hpp"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "engine/outcome/voxel_distance.hpp"
#include "engine/scene/scene.hpp"
#include "tests/outcome/labelled_model.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::pulp_nearness_test {
namespace {

/// A ball of pulp within a block.
VoxelModel tooth() {
  return test::labelled(
      test::block({48, 48, 48}, 1e-4, {4, 4, 4}, {44, 44, 44}), [](const Cell& c) {
        return (c - Cell(20, 22, 24)).cast<double>().norm() < 7.5 ? std::uint8_t{1}
                                                                  : std::uint8_t{0};
      });
}

TEST(PulpNearness, OfAPointIsThatOfTheMarking) {
  const VoxelModel start = tooth();
  const auto tissues = test::tissues_named({"enamel", "pulp"});
  const PulpNearness near(start, tissues);
  ASSERT_TRUE(near.has_pulp());
  const VoxelSet pulp = voxels_of_tissue(start, 1);
  for (const Cell& c : {Cell(40, 40, 40), Cell(5, 22, 24), Cell(20, 22, 40), Cell(29, 22, 24)}) {
    VoxelSet point(start.grid);
    point.insert(c);
    const double truth = 1e-4 * std::sqrt(squared_distances(point, pulp).at(0));
    EXPECT_NEAR(near.distance_m(start.grid.centre_world(c)).value(), truth, 1e-9);
  }
}

TEST(PulpNearness, OfARoundBurrIsThatOfItsMiddleLessItsRadius) {
  const VoxelModel start = tooth();
  const PulpNearness near(start, test::tissues_named({"enamel", "pulp"}));
  BurrSettings settings;
  settings.shape = BurrShape::kRound;
  settings.diameter_m = 0.8e-3;
  const Burr burr = make_burr(settings, 1e-4);
  Pose pose;  // its axis along +y
  pose.position = {0.2e-3, 0.9e-3, 0.1e-3};
  const double of_middle = near.distance_m(pose.point({0.0, 0.4e-3, 0.0})).value();
  EXPECT_NEAR(near.distance_m(burr, pose).value(), of_middle - 0.4e-3, 10e-6);
}

TEST(PulpNearness, SaysNothingWhereThereIsNone) {
  const VoxelModel start = tooth();
  EXPECT_FALSE(PulpNearness(start, test::tissues_named({"enamel", "dentine"})).has_pulp());
  VoxelModel plain = start;
  plain.tissues = nullptr;
  const PulpNearness none(plain, test::tissues_named({"enamel", "pulp"}));
  EXPECT_FALSE(none.distance_m(Eigen::Vector3d::Zero()));
}

}  // namespace
}  // namespace sulcus::pulp_nearness_test
