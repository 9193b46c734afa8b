#include "engine/normals/turned_map.hpp"

#include <cstring>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/normals/coarse_normal.hpp"
#include "tests/support/height_maps.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::turned_map_test {
namespace {

using Eigen::Vector3f;
using test::map_of;

/// Heights of either sign at random, and some that are none.
std::vector<int> random_heights(int ns, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<int> heights(static_cast<std::size_t>((2 * ns + 1) * (2 * ns + 1)));
  for (int& h : heights) {
    h = random() % 7 == 0 ? HeightMap::kNone : static_cast<int>(random() % 25) - 12;
  }
  return heights;
}

TEST(TurnedMap, MapsThatAreSymmetricToOneAnotherBecomeOne) {
  for (const int ns : {1, 6, 7, 10, 12}) {
    for (const Vector3f& coarse : {Vector3f(0.3f, -0.7f, 1.0f), Vector3f(-0.5f, 0.5f, 1.0f),
                                   Vector3f(0, 0.2f, 1), Vector3f(0, 0, 1)}) {
      const std::vector<int> heights = random_heights(ns, static_cast<unsigned>(ns));
      const auto at = [&](int i, int j) {
        return heights[static_cast<std::size_t>((j + ns) * (2 * ns + 1) + i + ns)];
      };
      TurnedMap first;
      first.turn(map_of(ns, 1, at), coarse);
      ASSERT_EQ(first.turns().size(), 1u);
      const Vector3f seen = first.turns()[0].of(coarse);
      EXPECT_GE(seen.x(), seen.y());
      EXPECT_GE(seen.y(), 0.0f);
      const ClosestPoint point{0.2f, -0.3f, 0.9f, 0.25f};
      const ClosestPoint back = first.back(point);
      for (int n = 0; n < 16; ++n) {
        // The map with its columns exchanged and mirrored; and upside down, its heights as well.
        const bool flip_x = (n & 1) != 0, flip_y = (n & 2) != 0, exchange = (n & 4) != 0;
        const int sign = n < 8 ? 1 : -1;
        const auto of = [&](Vector3f v) {
          if (flip_x) v.x() = -v.x();
          if (flip_y) v.y() = -v.y();
          if (exchange) std::swap(v.x(), v.y());
          return v;
        };
        const HeightMap map = map_of(ns, sign, [&](int i, int j) {
          const int x = exchange ? j : i, y = exchange ? i : j;
          const int height = at(flip_x ? -x : x, flip_y ? -y : y);
          return height == HeightMap::kNone ? height : sign * height;
        });
        TurnedMap turned;
        turned.turn(map, of(coarse));
        ASSERT_EQ(turned.turns().size(), 1u);
        ASSERT_EQ(turned.map().sign, 1);
        ASSERT_EQ(std::memcmp(turned.map().height.data(), first.map().height.data(),
                              static_cast<std::size_t>((2 * ns + 1) * map.lanes)),
                  0)
            << ns << " " << n;
        const ClosestPoint other = turned.back(point);
        const Vector3f expected = of({back.normal_x, back.normal_y, back.normal_z});
        ASSERT_EQ(Vector3f(other.normal_x, other.normal_y, other.normal_z), expected) << n;
        ASSERT_EQ(other.offset, back.offset);
      }
    }
  }
}

TEST(TurnedMap, OfASymmetricMapPointsAreTheMeanOfItsTurns) {
  // A roof along x: y may be mirrored, and so may x.
  const HeightMap roof = map_of(6, 1, [](int, int j) { return -std::abs(j); });
  TurnedMap turned;
  turned.turn(roof, {0, 0, 1});
  EXPECT_EQ(turned.turns().size(), 4u);
  const ClosestPoint mean = turned.back({0.6f, 0.48f, 0.64f, 0.5f});
  EXPECT_EQ(mean.normal_x, 0.0f);
  EXPECT_EQ(mean.normal_y, 0.0f);
  EXPECT_EQ(mean.normal_z, 1.0f);
  EXPECT_EQ(mean.offset, 0.5f);
  turned.turn(roof, {0.1f, 0, 1});
  EXPECT_EQ(turned.turns().size(), 2u);
}

TEST(SolidOffsets, AreThoseOfEveryOtherVoxelOfACube) {
  const Workpiece workpiece(test::random_blobs({40, 32, 48}, 5));
  const auto cells = workpiece.grid().cells;
  int count = 0;
  for (const Cell& c : test::surface_cells(workpiece)) {
    const int neighbourhood = 1 + static_cast<int>(c.sum() % 8);
    const int reach = std::min(6, neighbourhood / 2 * 2);
    Eigen::Vector3i expected = Eigen::Vector3i::Zero();
    for (int z = -reach; z <= reach; z += 2) {
      for (int y = -reach; y <= reach; y += 2) {
        for (int x = -reach; x <= reach; x += 2) {
          const Cell at = c + Cell(x, y, z);
          if ((at.array() < 0).any() || (at.array() >= cells.array()).any()) continue;
          if (workpiece.solid(at)) expected += Eigen::Vector3i(x, y, z) / 2;
        }
      }
    }
    ASSERT_EQ(solid_offsets(workpiece, c, neighbourhood), expected);
    ++count;
  }
  EXPECT_GT(count, 1000);
}

}  // namespace
}  // namespace sulcus::turned_map_test
