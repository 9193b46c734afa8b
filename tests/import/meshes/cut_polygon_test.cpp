#include "engine/import/meshes/cut_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace sulcus::cut_polygon_test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// Laid into a plane aslant.
std::vector<Vector3f> aslant(const std::vector<Vector2d>& outline) {
  const Eigen::Matrix3d turn =
      (Eigen::AngleAxisd(0.7, Vector3d::UnitX()) * Eigen::AngleAxisd(2.1, Vector3d::UnitY()))
          .toRotationMatrix();
  std::vector<Vector3f> positions;
  for (const Vector2d& p : outline) {
    positions.push_back((turn * Vector3d(p.x(), p.y(), 0.0) + Vector3d(3, -1, 2)).cast<float>());
  }
  return positions;
}

Triangles cut(const std::vector<Vector3f>& positions) {
  std::vector<std::uint32_t> polygon(positions.size());
  std::iota(polygon.begin(), polygon.end(), 0u);
  Triangles triangles;
  cut_polygon(positions, polygon, triangles);
  return triangles;
}

/// By the shoelace formula.
double area_of(const std::vector<Vector2d>& outline) {
  double twice = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2d &a = outline[i], &b = outline[(i + 1) % outline.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

/// Whatever the polygon: the sides of the triangles are its own once each, and every other one
/// both ways. The areas of triangles that do not overlap add up to its own.
void expect_cut(const std::vector<Vector2d>& outline, bool simple = true) {
  const std::vector<Vector3f> positions = aslant(outline);
  const Triangles triangles = cut(positions);
  ASSERT_EQ(triangles.size(), outline.size() - 2);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  double area = 0.0;
  for (const auto& t : triangles) {
    for (std::size_t e = 0; e < 3; ++e) {
      ++sides[{t[e], t[(e + 1) % 3]}];
      --sides[{t[(e + 1) % 3], t[e]}];
    }
    const Vector3d a = positions[t[0]].cast<double>();
    area +=
        0.5 * (positions[t[1]].cast<double>() - a).cross(positions[t[2]].cast<double>() - a).norm();
  }
  for (const auto& [side, count] : sides) {
    const auto count_of_outline = static_cast<std::uint32_t>(outline.size());
    const int of_outline = (side.first + 1) % count_of_outline == side.second   ? 1
                           : (side.second + 1) % count_of_outline == side.first ? -1
                                                                                : 0;
    EXPECT_EQ(count, of_outline) << side.first << ' ' << side.second;
  }
  if (simple) {
    EXPECT_NEAR(area, std::abs(area_of(outline)), 1e-5 * area);
  }
}

TEST(CutPolygon, AConvexOneIsAFan) {
  EXPECT_EQ(cut(aslant({{0, 0}, {2, 0}, {3, 1}, {2, 3}, {0, 2}})),
            (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

TEST(CutPolygon, ConcaveOnesFromEveryCornerAndEitherWay) {
  const std::vector<std::vector<Vector2d>> outlines = {
      {{0, 0}, {4, 0}, {1, 1}, {0, 4}},                                  // an arrow head
      {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}},                  // L
      {{0, 0}, {5, 0}, {5, 3}, {4, 3}, {4, 1}, {1, 1}, {1, 3}, {0, 3}},  // U
      {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}, {0, 1}}};
  for (std::vector<Vector2d> outline : outlines) {
    for (std::size_t first = 0; first < outline.size(); ++first) {
      std::rotate(outline.begin(), outline.begin() + 1, outline.end());
      expect_cut(outline);
      std::vector<Vector2d> back(outline.rbegin(), outline.rend());
      expect_cut(back);
    }
  }
}

TEST(CutPolygon, StarsCombsAndSpirals) {
  std::mt19937 random(5);
  for (int corners = 4; corners < 60; ++corners) {
    std::vector<Vector2d> star;
    for (int c = 0; c < corners; ++c) {
      const double angle = 2.0 * std::numbers::pi * c / corners;
      const double radius = 1.0 + static_cast<double>(random() % 1000) / 100.0;
      star.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    expect_cut(star);
  }
  std::vector<Vector2d> comb, spiral;
  for (int tooth = 0; tooth < 40; ++tooth) {
    comb.insert(comb.end(), {{2.0 * tooth, 0.0}, {2.0 * tooth + 1.0, 9.0}});
  }
  comb.insert(comb.end(), {{80.0, 0.0}, {80.0, -1.0}, {0.0, -1.0}});
  std::reverse(comb.begin(), comb.end());
  expect_cut(comb);
  for (int c = 0; c < 100; ++c) {
    spiral.emplace_back((2 + 0.1 * c) * std::cos(0.2 * c), (2 + 0.1 * c) * std::sin(0.2 * c));
  }
  for (int c = 99; c >= 0; --c) {
    spiral.emplace_back((1 + 0.1 * c) * std::cos(0.2 * c), (1 + 0.1 * c) * std::sin(0.2 * c));
  }
  expect_cut(spiral);
}

TEST(CutPolygon, WhatCrossesItselfOrIsALineKeepsItsSides) {
  expect_cut({{0, 0}, {2, 2}, {2, 0}, {0, 2}}, false);
  expect_cut({{0, 0}, {1, 1}, {2, 2}, {3, 3}, {1.5, 1.5}}, false);
  std::vector<Vector2d> pentagram;
  for (int c = 0; c < 5; ++c) {
    const double angle = 4.0 * std::numbers::pi * c / 5;
    pentagram.emplace_back(std::cos(angle), std::sin(angle));
  }
  expect_cut(pentagram, false);
}

}  // namespace
}  // namespace sulcus::cut_polygon_test
