#include "engine/normals/map_kernels.hpp"

#include <cmath>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

#include "engine/normals/leaf_tiles.hpp"
#include "tests/support/map_kernels_fixture.hpp"

namespace sulcus::map_kernels_test {
namespace {

class MapKernelsTest : public test::MapKernelsFixture {};
INSTANTIATE_TEST_SUITE_P(Sets, MapKernelsTest, test::fast_sets(), test::set_of);

constexpr TraceOrder kOrders[] = {TraceOrder::kRowFirst, TraceOrder::kColumnFirst,
                                  TraceOrder::kBoth};

TEST_P(MapKernelsTest, TracesAreTheSameBitForBit) {
  int whole = 0, broken = 0, count = 0;
  for_maps([&](const ColumnBits::Windows& columns, int sign) {
    for (const int ns : {1, 4, 6, 7, 12}) {
      for (const int stride : {1, 2}) {
        if (stride == 2 && ns > 7) continue;
        for (const int trace : {5, 12, kMaxTrace}) {
          HeightMap a = ask(ns, stride, sign);
          a.order = kOrders[count++ % 3];
          HeightMap b = a;
          trace_one(*plain_, columns, trace, a);
          trace_one(*fast_, columns, trace, b);
          ASSERT_EQ(a.lanes, b.lanes);
          ASSERT_EQ(a.whole_rings, b.whole_rings);
          ASSERT_EQ(a.even_rings, b.even_rings);
          for (int k = 0; k < (2 * ns + 1) * a.lanes; ++k) {
            ASSERT_EQ(a.height[k], b.height[k]) << "ns " << ns << " place " << k;
          }
          (a.whole_rings == ns ? whole : broken) += 1;
        }
      }
    }
  });
  EXPECT_GT(whole, 1000);
  EXPECT_GT(broken, 1000);
}

TEST_P(MapKernelsTest, MapsTracedTogetherAreThoseTracedOneByOne) {
  std::vector<ColumnBits::Windows> columns;
  std::vector<int> signs;
  for (const Workpiece& workpiece : shapes()) {
    columns.clear(), signs.clear();
    for (const Cell& c : test::surface_cells(workpiece)) {
      columns.push_back(windows(workpiece, c, static_cast<int>(c.sum() % 3)));
      signs.push_back(c.sum() % 5 < 2 ? 1 : -1);
    }
    for (const int ns : {6, 12}) {
      for (const std::size_t count : {std::size_t{1}, std::size_t{9}, columns.size()}) {
        std::vector<HeightMap> maps;
        for (std::size_t k = 0; k < count; ++k) maps.push_back(ask(ns, 1, signs[k]));
        fast_->trace(columns.data(), count, 12, maps.data());
        for (std::size_t k = 0; k < count; ++k) {
          HeightMap one = ask(ns, 1, signs[k]);
          trace_one(*plain_, columns[k], 12, one);
          ASSERT_EQ(maps[k].whole_rings, one.whole_rings);
          ASSERT_EQ(maps[k].even_rings, one.even_rings);
          const auto size = static_cast<std::size_t>((2 * ns + 1) * one.lanes);
          ASSERT_EQ(std::memcmp(maps[k].height.data(), one.height.data(), size), 0);
        }
      }
    }
  }
}

TEST_P(MapKernelsTest, AMapIsWhatAWalkOverTheVoxelsFinds) {
  // A slope of one half, and a step of four that is not followed.
  const VoxelModel model = test::make_model({48, 48, 48}, 1e-4, [](const Cell& c) {
    return c.z() <= 20 + c.x() / 2 - 12 + (c.y() > 26 ? 4 : 0);
  });
  const Workpiece workpiece{VoxelModel(model)};
  for (const MapKernels* kernels : {plain_, fast_}) {
    HeightMap map = ask(6, 1, 1);
    trace_one(*kernels, windows(workpiece, {24, 24, 20}, 2), 12, map);
    for (int i = -6; i <= 6; ++i) {
      for (int j = -6; j <= 2; ++j) EXPECT_EQ(map.at(i, j), (24 + i) / 2 - 12) << i << " " << j;
      for (int j = 3; j <= 6; ++j) EXPECT_EQ(map.at(i, j), HeightMap::kNone) << i << " " << j;
    }
    EXPECT_EQ(map.whole_rings, 2);
  }
}

TEST_P(MapKernelsTest, FitsAndResidualsAreTheSameBitForBit) {
  for_maps([&](const ColumnBits::Windows& columns, int sign) {
    for (const int ns : {3, 6, 12}) {
      HeightMap map = ask(ns, 1, sign);
      trace_one(*plain_, columns, 12, map);
      if (map.whole_rings < 1) continue;
      QuadricSums a, b;
      const QuadricFilter& filter = quadric_filter(map.whole_rings, map.lanes);
      plain_->fit(map.middle_row(), map.lanes, filter, a);
      fast_->fit(map.middle_row(), map.lanes, filter, b);
      ASSERT_EQ(a, b);
      if (map.whole_rings < ns) continue;
      const int level = map.at(0, 0);
      const ColumnQuadric surface = column_quadric(
          quadric_of(a, level, level, map.sign, filter.solution), filter.answers, 1.0f);
      ResidualCubes p, q;
      const float largest2 = plain_->map_residuals(rows_of(map), surface, p);
      ASSERT_EQ(largest2, fast_->map_residuals(rows_of(map), surface, q));
      ASSERT_EQ(p, q);
      // The second way: column by column.
      double most = 0.0, cubes = 0.0, across = 0.0;
      const WindowWeight window_weight = window_weight_of(ns);
      for (int j = -ns; j <= ns; ++j) {
        for (int i = -ns; i <= ns; ++i) {
          const double x = i, y = j;
          const auto& c = surface.c;
          const double z2 = c[3] * x * x + c[4] * x * y + c[5] * y * y;
          const double z =
              c[0] + c[1] * x + c[2] * y + z2 * (1 + surface.t_x * x + surface.t_y * y);
          const double r = sign * map.at(i, j) + 0.5 - z;
          const double weight = window_weight.centre - window_weight.fall * (i * i + j * j);
          most = std::max(most, std::abs(r));
          cubes += weight * r * r * r;
          across += weight * i * j * r * r * r;
        }
      }
      ASSERT_NEAR(std::sqrt(largest2), most, 1e-4 * (1.0 + most));
      ASSERT_NEAR(p[0], cubes, 1e-3 * (100.0 + std::abs(cubes)));
      ASSERT_NEAR(p[4], across, 1e-2 * (1000.0 + std::abs(across)));
    }
  });
}

TEST_P(MapKernelsTest, CoarseSumsAreThoseOfTheSolidVoxelsAround) {
  for (const Workpiece& workpiece : shapes()) {
    const std::vector<Cell> cells = test::surface_cells(workpiece);
    for (std::size_t k = 0; k < cells.size(); k += 3) {
      const Cell& c = cells[k];
      const ColumnBits::Windows rows = workpiece.columns().around(0, c.y(), c.z(), c.x() - 2);
      std::array<std::int32_t, 3> expected{}, plain, fast;
      for (int n = 0; n < 125; ++n) {
        const Cell d(n % 5 - 2, n / 5 % 5 - 2, n / 25 - 2);
        if (d.squaredNorm() > 6 || !workpiece.solid(c + d)) continue;
        for (int a = 0; a < 3; ++a) {
          expected[a] +=
              d[a] *
              (d.isZero() ? 0 : static_cast<int>(std::lround(120.0 / d.cast<double>().norm())));
        }
      }
      plain_->coarse(&rows, 1, &plain);
      fast_->coarse(&rows, 1, &fast);
      ASSERT_EQ(plain, expected);
      ASSERT_EQ(fast, expected);
    }
  }
}

TEST_P(MapKernelsTest, MapsCutOutOfATileAreTheTracedOnesBitForBit) {
  int cut = 0, all = 0;
  for (const Workpiece& workpiece : shapes()) {
    for (const Cell& c : test::surface_cells(workpiece)) {
      const Cell origin = c.array() / kLeafEdge * kLeafEdge;
      for (int n = 0; n < 6; ++n) {
        const MapAxes axes{n / 2, n % 2 == 0 ? 1 : -1};
        const int u = c[axes.first()] % kLeafEdge, v = c[axes.second()] % kLeafEdge,
                  w = c[axes.axis] % kLeafEdge;
        // Each ns at a third of the voxels.
        const int ns = 6 - static_cast<int>(c.sum() % 4), trace = n % 3 == 0 ? 5 : kMaxTrace;
        const ColumnBits::Windows about_leaf =
            workpiece.columns().around(axes.axis, origin[axes.first()], origin[axes.second()],
                                       origin[axes.axis] - HeightTile::kBelow);
        HeightTile plain, fast;
        plain.ns = fast.ns = ns;
        plain.sign = fast.sign = axes.sign;
        plain_->tile(about_leaf, plain);
        fast_->tile(about_leaf, fast);
        for (int j = 0; j < HeightTile::kEdge; ++j) {
          ASSERT_EQ(plain.sound[j], fast.sound[j]);
          for (int i = 0; i < HeightTile::kEdge; ++i) {
            for (std::size_t f = 0; plain.is_sound(i, j) && f < kQuadric; ++f) {
              ASSERT_EQ(plain.sums[j][f][i], fast.sums[j][f][i]) << ns << " " << f;
            }
          }
        }
        // In whatever order.
        HeightMap traced = ask(ns, 1, axes.sign);
        traced.order = kOrders[all / 2 % 3];
        trace_one(*plain_, windows(workpiece, c, axes.axis), trace, traced);
        for (const MapKernels* kernels : {plain_, fast_}) {
          ++all;
          HeightMap map = ask(ns, 1, axes.sign);
          const bool is_cut = kernels->cut(plain, u, v, w, trace, map);
          for (const HeightTile* tile : {&plain, &fast}) {
            const HeightTile::Column& column = tile->columns[v * HeightTile::kEdge + u];
            const int reach = std::min(trace, HeightTile::kReach);
            const bool has_map = std::abs(column.height - w) <= kMaxStep &&
                                 column.highest - w <= reach && column.lowest - w >= -reach;
            ASSERT_EQ(has_map, is_cut) << kernels->name;
            if (!is_cut) continue;
            ASSERT_EQ(column.even_rings, map.even_rings);
          }
          if (!is_cut) continue;
          ++cut;
          ASSERT_EQ(map.whole_rings, traced.whole_rings) << kernels->name;
          ASSERT_EQ(map.even_rings, traced.even_rings) << kernels->name;
          ASSERT_EQ(map.lanes, traced.lanes);
          for (int k = 0; k < (2 * ns + 1) * map.lanes; ++k) {
            ASSERT_EQ(map.height[k], traced.height[k]) << kernels->name << " place " << k;
          }
          // And the sums, about the centre's height.
          const QuadricFilter& filter = quadric_filter(ns, map.lanes);
          QuadricSums sums, tile_sums;
          plain_->fit(traced.middle_row(), traced.lanes, filter, sums);
          for (std::size_t f = 0; f < kQuadric; ++f) tile_sums[f] = plain.sums[v][f][u];
          const int level = traced.at(0, 0), height = plain.at(u, v);
          ASSERT_EQ(quadric_of(sums, level, level, axes.sign, filter.solution),
                    quadric_of(tile_sums, height, level, axes.sign, filter.solution));
        }
      }
    }
  }
  EXPECT_GT(cut, all / 10);
  EXPECT_LT(cut, all * 9 / 10);
}

TEST_P(MapKernelsTest, HalfDiscsAreThePixelsOnOneSideAndTheSameBitForBit) {
  for_maps([&](const ColumnBits::Windows& columns, int sign) {
    for (const int ns : {4, 6, 12}) {
      HeightMap map = ask(ns, 1, sign);
      trace_one(*plain_, columns, 12, map);
      std::array<PlaneSums, kHalves> a, b;
      plain_->halves(map, a);
      fast_->halves(map, b);
      HeightPlane plane{0.4f, 0.3f, -0.2f, 0.94f, 0.87f}, other{0.3f, 0.25f, -0.2f, 0.95f, 0.87f};
      for (int d = 0; d < kHalves; ++d) {
        // The second way: from the angle.
        PlaneSums half, on;
        const double angle = d * std::numbers::pi / 4.0;
        for (int j = -std::min(ns, kDiscReach); j <= std::min(ns, kDiscReach); ++j) {
          for (int i = -std::min(ns, kDiscReach); i <= std::min(ns, kDiscReach); ++i) {
            const int h = map.at(i, j);
            if (h == HeightMap::kNone || i * i + j * j > 6.8 * 6.8) continue;
            if (i * std::cos(angle) + j * std::sin(angle) < -1e-9) continue;
            const auto x = static_cast<float>(i), y = static_cast<float>(j),
                       z2 = static_cast<float>(2 * sign * h + 1);
            const auto add = [&](PlaneSums& s) {
              s.n += 1, s.i += x, s.j += y, s.ii += x * x, s.ij += x * y, s.jj += y * y;
              s.z += z2, s.iz += x * z2, s.jz += y * z2;
            };
            add(half);
            if (std::abs((z2 * 0.5f - (plane.c0 + plane.c2 * y) - plane.c1 * x) * plane.cosine) <=
                plane.slack) {
              add(on);
            }
          }
        }
        ASSERT_TRUE(same_sums(a[d], half)) << ns << " " << d;
        ASSERT_TRUE(same_sums(b[d], half)) << ns << " " << d;
        for (const MapKernels* kernels : {plain_, fast_}) {
          PlaneSums found;
          kernels->on_plane(map, d, plane, found);
          ASSERT_TRUE(same_sums(found, on)) << kernels->name;
        }
        Residuals r, s;
        plain_->plane_residuals(map, d, plane, other, r);
        fast_->plane_residuals(map, d, plane, other, s);
        ASSERT_EQ(r.largest, s.largest);
        ASSERT_EQ(r.sum_squares, s.sum_squares);
      }
    }
  });
}

TEST_P(MapKernelsTest, StepsOfAPlaneAreTheColumnsOnItAndTheSameBitForBit) {
  for_maps([&](const ColumnBits::Windows& columns, int sign) {
    for (const int ns : {4, 6, 12}) {
      HeightMap map = ask(ns, 1, sign);
      trace_one(*plain_, columns, 12, map);
      const HeightPlane plane{0.4f, 0.3f, -0.2f, 0.94f, 0.57f};
      constexpr float kBound = 0.6f;
      PlaneLook look, same_look;
      plain_->look_at_plane(map, plane, look);
      fast_->look_at_plane(map, plane, same_look);
      ASSERT_EQ(look.count, same_look.count);
      ASSERT_EQ(look.residuals.largest, same_look.residuals.largest);
      ASSERT_EQ(look.residuals.sum_squares, same_look.residuals.sum_squares);
      for (const PlaneWeight kind :
           {PlaneWeight::kWindow, PlaneWeight::kQuartic, PlaneWeight::kInterior}) {
        PlaneSums a, b;
        plain_->plane_step(map, plane, kind, kBound, a);
        fast_->plane_step(map, plane, kind, kBound, b);
        ASSERT_TRUE(same_sums(a, b));
        // The second way: column by column.
        int count = 0;
        double weights = 0.0, crossed = 0.0, right = 0.0;
        for (int j = -ns; j <= ns; ++j) {
          for (int i = -ns; i <= ns; ++i) {
            const double r = (sign * map.at(i, j) + 0.5 - 0.4 - 0.3 * i + 0.2 * j) * 0.94;
            if (map.at(i, j) == HeightMap::kNone || std::abs(r) > plane.slack) continue;
            ++count;
            const double window_weight = 1.0 - (i * i + j * j) / (2.5 * ns * ns);
            const double inside = kBound * kBound - r * r;
            const double weight = kind == PlaneWeight::kWindow ? window_weight
                                  : kind == PlaneWeight::kQuartic
                                      ? window_weight * r * r
                                      : (kBound * kBound + r * r) / (inside * inside);
            weights += weight;
            crossed += weight * i * j;
            right += j * (kind == PlaneWeight::kInterior ? r / inside : weight * r);
          }
        }
        ASSERT_EQ(look.count, count);
        ASSERT_NEAR(a.n, weights, 1e-3 * (1.0 + weights));
        ASSERT_NEAR(a.ij, crossed, 1e-3 * (10.0 + 30.0 * weights));
        ASSERT_NEAR(a.jz, right, 1e-3 * (10.0 + 6.0 * weights));
      }
    }
  });
}

TEST_P(MapKernelsTest, ClosePointsAreThoseOfTheBallAndTheSameBitForBit) {
  for_maps([&](const ColumnBits::Windows& columns, int sign) {
    for (const int ns : {2, 6, 12}) {
      HeightMap map = ask(ns, 1, sign);
      trace_one(*plain_, columns, 12, map);
      PlaneSums a, b;
      plain_->close_sums(map, a);
      fast_->close_sums(map, b);
      ASSERT_TRUE(same_sums(a, b));
      PlaneSums sums;
      for (int j = -std::min(ns, 3); j <= std::min(ns, 3); ++j) {
        for (int i = -std::min(ns, 3); i <= std::min(ns, 3); ++i) {
          const auto x = static_cast<float>(i), y = static_cast<float>(j),
                     z2 = static_cast<float>(2 * sign * map.at(i, j) + 1);
          if (x * x + y * y + 0.25f * z2 * z2 > 3.6f * 3.6f) continue;
          sums.n += 1, sums.i += x, sums.j += y, sums.ii += x * x, sums.ij += x * y;
          sums.jj += y * y, sums.z += z2, sums.iz += x * z2, sums.jz += y * z2;
        }
      }
      ASSERT_TRUE(same_sums(a, sums));
    }
  });
}

}  // namespace
}  // namespace sulcus::map_kernels_test
