#include "engine/normals/rough_columns.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "tests/support/height_maps.hpp"

namespace sulcus::rough_columns_test {
namespace {

using test::map_of;

/// Five columns and more that are two off their neighbours' mean line, by their places one after
/// the other: the smaller principal variance of these.
bool rough_by_hand(const HeightMap& map) {
  const auto found = [&](int i, int j) {
    return std::abs(i) <= map.ns && std::abs(j) <= map.ns && map.at(i, j) != HeightMap::kNone;
  };
  std::vector<Eigen::Vector2d> places;
  for (int j = -map.ns; j <= map.ns; ++j) {
    for (int i = -map.ns; i <= map.ns; ++i) {
      const auto out_of_line = [&](int di, int dj) {
        return found(i, j) && found(i - di, j - dj) && found(i + di, j + dj) &&
               std::abs(map.at(i - di, j - dj) - 2 * map.at(i, j) + map.at(i + di, j + dj)) >= 2;
      };
      if (out_of_line(1, 0) || out_of_line(0, 1)) places.emplace_back(i, j);
    }
  }
  if (places.size() < 5) return false;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : places) mean += p / static_cast<double>(places.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& p : places) {
    spread += (p - mean) * (p - mean).transpose() / static_cast<double>(places.size());
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues()[0] >= 4.0 - 1e-9;
}

TEST(RoughColumns, AreThoseCountedOneByOneInEveryTurn) {
  std::mt19937 random(1);
  int rough = 0;
  constexpr int kMaps = 2000;
  for (int n = 0; n < kMaps; ++n) {
    const int ns = 1 + n % 12, seldom = 2 + n % 60;
    std::vector<int> heights(static_cast<std::size_t>((2 * ns + 1) * (2 * ns + 1)));
    for (int& h : heights) {
      const auto number = static_cast<unsigned>(random());
      h = number % 31 == 0                              ? HeightMap::kNone
          : static_cast<int>(number / 64) % seldom == 0 ? 2 - static_cast<int>(number & 4)
                                                        : 0;
    }
    const auto at = [&](int i, int j) {
      return heights[static_cast<std::size_t>((j + ns) * (2 * ns + 1) + i + ns)];
    };
    const HeightMap map = map_of(ns, 1, at);
    const bool found = has_rough_columns(map);
    ASSERT_EQ(found, rough_by_hand(map)) << n;
    ASSERT_EQ(found, has_rough_columns(map_of(ns, 1, [&](int i, int j) { return at(j, i); })));
    ASSERT_EQ(found, has_rough_columns(map_of(ns, 1, [&](int i, int j) { return at(-i, j); })));
    ASSERT_EQ(found, has_rough_columns(map_of(ns, 1, [&](int i, int j) {
                const int h = at(i, -j);
                return h == HeightMap::kNone ? h : -h;
              })));
    rough += found ? 1 : 0;
  }
  EXPECT_GT(rough, kMaps / 4);
  EXPECT_LT(rough, kMaps * 3 / 4);
}

TEST(RoughColumns, AreNotThoseOfPlanesBallsAndEdges) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int n = 0; n < 3000; ++n) {
    const double a = 1.5 * any(random), b = 1.5 * any(random), c = any(random);
    const auto plane = [&](int i, int j) { return a * i + b * j + c; };
    ASSERT_FALSE(has_rough_columns(map_of(6, 1, [&](int i, int j) {
      return std::floor(plane(i, j));
    }))) << n;
    const double bend = 0.02 * any(random);  // balls of 25 voxels and more
    ASSERT_FALSE(has_rough_columns(map_of(6, 1, [&](int i, int j) {
      return std::floor(0.4 * plane(i, j) + bend * (i * i + j * j));
    }))) << n;
    const double turn = M_PI * any(random), steep = 2.0 * any(random), where = 6.0 * any(random);
    ASSERT_FALSE(has_rough_columns(map_of(6, 1, [&](int i, int j) {
      const double past = std::cos(turn) * i + std::sin(turn) * j - where;
      return std::floor(0.3 * plane(i, j) + steep * std::max(past, 0.0));
    }))) << n;
  }
}

TEST(RoughColumns, AreThoseOfNoise) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  int rough = 0;
  constexpr int kMaps = 1000;
  for (int n = 0; n < kMaps; ++n) {
    const double a = any(random), b = any(random);
    rough += has_rough_columns(map_of(
                 6, 1, [&](int i, int j) { return std::floor(a * i + b * j + 0.7 * any(random)); }))
                 ? 1
                 : 0;
  }
  EXPECT_GT(rough, kMaps * 95 / 100);
}

}  // namespace
}  // namespace sulcus::rough_columns_test
