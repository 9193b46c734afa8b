#include "engine/normals/neighbour_pattern.hpp"

#include <bit>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "tests/support/normal_errors.hpp"

namespace sulcus::neighbour_pattern_test {
namespace {

bool has_opposing_pair(int pattern) {
  return (pattern & 3) == 3 || (pattern >> 2 & 3) == 3 || (pattern >> 4 & 3) == 3;
}

TEST(NeighbourPattern, ThirtySevenOfSixtyFourHoldAnOpposingPair) {
  int pairs = 0;
  for (int pattern = 0; pattern < 64; ++pattern) pairs += has_opposing_pair(pattern);
  EXPECT_EQ(pairs, 37);
}

TEST(NeighbourPattern, EightCancelToNoDirection) {
  int none = 0;
  for (int pattern = 0; pattern < 64; ++pattern) {
    if (!(projection_directions()[pattern].array() == 0).all()) continue;
    ++none;
    EXPECT_TRUE(pattern == 0 || has_opposing_pair(pattern)) << pattern;
  }
  EXPECT_EQ(none, 8);
}

TEST(NeighbourPattern, TwentySixDirectionsRemain) {
  std::set<std::tuple<int, int, int>> directions;
  for (const Eigen::Vector3i& d : projection_directions()) {
    EXPECT_LE(d.cwiseAbs().maxCoeff(), 1);
    if (!(d.array() == 0).all()) directions.insert({d.x(), d.y(), d.z()});
  }
  EXPECT_EQ(directions.size(), 26u);
}

TEST(NeighbourPattern, DirectionIsTheSumOfTheExposedFaces) {
  for (int pattern = 0; pattern < 64; ++pattern) {
    Eigen::Vector3i sum = Eigen::Vector3i::Zero();
    for (int face = 0; face < 6; ++face) {
      if ((pattern >> face & 1) != 0) {
        sum += (face % 2 == 0 ? -1 : 1) * Eigen::Vector3i::Unit(face / 2);
      }
    }
    EXPECT_EQ(projection_directions()[pattern], sum) << pattern;
  }
}

TEST(NeighbourPattern, ExposedFacesAreReadFromTheVoxels) {
  for (const Cell& at : {Cell(12, 12, 12), Cell(8, 15, 16), Cell(7, 8, 7)}) {  // leaf borders too
    for (int pattern = 0; pattern < 64; ++pattern) {
      EXPECT_EQ(exposed_faces(test::pattern_workpiece(pattern, at), at), pattern);
    }
  }
}

TEST(NeighbourPattern, BeyondTheGridAllIsExposed) {
  const Workpiece workpiece(test::make_model({8, 8, 8}, 1e-4, [](const Cell&) { return true; }));
  EXPECT_EQ(exposed_faces(workpiece, {0, 0, 0}), 0b010101);
  EXPECT_EQ(exposed_faces(workpiece, {7, 7, 7}), 0b101010);
  EXPECT_EQ(exposed_faces(workpiece, {3, 3, 3}), 0);
}

}  // namespace
}  // namespace sulcus::neighbour_pattern_test
