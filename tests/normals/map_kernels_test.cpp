#include "engine/normals/map_kernels.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>

#include "engine/normals/coarse_normal.hpp"
#include "engine/normals/leaf_tiles.hpp"
#include "engine/normals/map_group.hpp"
#include "engine/normals/tilted_fit.hpp"
#include "tests/support/instruction_sets.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

/// The kernels of each instruction set against the plain ones.
class MapKernelsTest : public ::testing::TestWithParam<InstructionSet> {
 protected:
  void SetUp() override {
    fast_ = map_kernels_of(GetParam());
    if (!fast_) GTEST_SKIP() << "this processor has no " << test::set_name(GetParam());
  }

  ColumnBits::Windows windows(const Workpiece& workpiece, const Cell& c, int axis) const {
    return workpiece.columns().around(axis, c[(axis + 1) % 3], c[(axis + 2) % 3], c[axis] - kLevel);
  }

  static HeightMap ask(int ns, int stride, int sign) {
    HeightMap map;
    map.ns = ns;
    map.stride = stride;
    map.sign = sign;
    map.height.fill(77);  // what a trace leaves unset shows
    return map;
  }

  /// Smooth, ragged, thin and tilted surroundings.
  static std::vector<Workpiece> shapes() {
    std::vector<Workpiece> all;
    all.emplace_back(test::two_balls());
    all.emplace_back(test::random_blobs({40, 32, 48}, 5));
    all.emplace_back(test::half_space({48, 48, 48}, 1e-4, {0.4, -0.3, 0.86}, {23, 24, 25}));
    all.emplace_back(test::make_model({48, 48, 48}, 1e-4, [](const Cell& c) {
      const double side = 0.5 * c.x() + 0.2 * c.y() + 0.84 * c.z() - 36.0;
      return std::abs(side) < 1.1;
    }));
    return all;
  }

  static bool same_sums(const PlaneSums& a, const PlaneSums& b) {
    return a.n == b.n && a.i == b.i && a.j == b.j && a.ii == b.ii && a.ij == b.ij && a.jj == b.jj &&
           a.z == b.z && a.iz == b.iz && a.jz == b.jz;
  }

  template <class Each>
  void for_maps(const Each& each) const {
    for (const Workpiece& workpiece : shapes()) {
      const std::vector<Cell> cells = test::surface_cells(workpiece);
      for (std::size_t k = 0; k < cells.size(); k += 7) {
        for (int axis = 0; axis < 3; ++axis) {
          for (const int sign : {-1, 1}) each(windows(workpiece, cells[k], axis), sign);
        }
      }
    }
  }

  /// Of a surface across itself, a column out.
  static float bend_of(const ColumnQuadric& surface) {
    return (std::abs(surface.c[3]) + std::abs(surface.c[4]) + std::abs(surface.c[5])) *
           foot_of(surface).normal_z;
  }

  const MapKernels* const plain_ = map_kernels_of(InstructionSet::kPlain);
  const MapKernels* fast_ = nullptr;
};
INSTANTIATE_TEST_SUITE_P(Sets, MapKernelsTest, test::fast_sets(), test::set_of);

TEST_P(MapKernelsTest, TracesAreTheSameBitForBit) {
  int whole = 0, broken = 0;
  for_maps([&](const ColumnBits::Windows& columns, int sign) {
    for (const int ns : {1, 4, 6, 7, 12}) {
      for (const int stride : {1, 2}) {
        if (stride == 2 && ns > 7) continue;
        for (const int trace : {5, 12, kMaxTrace}) {
          HeightMap a = ask(ns, stride, sign), b = a;
          plain_->trace(columns, trace, a);
          fast_->trace(columns, trace, b);
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
        fast_->trace_all(columns.data(), count, 12, maps.data());
        for (std::size_t k = 0; k < count; ++k) {
          HeightMap one = ask(ns, 1, signs[k]);
          plain_->trace(columns[k], 12, one);
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
    kernels->trace(windows(workpiece, {24, 24, 20}, 2), 12, map);
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
      plain_->trace(columns, 12, map);
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
      const Taper taper = taper_of(ns);
      for (int j = -ns; j <= ns; ++j) {
        for (int i = -ns; i <= ns; ++i) {
          const double x = i, y = j;
          const auto& c = surface.c;
          const double z2 = c[3] * x * x + c[4] * x * y + c[5] * y * y;
          const double z =
              c[0] + c[1] * x + c[2] * y + z2 * (1 + surface.t_x * x + surface.t_y * y);
          const double r = sign * map.at(i, j) + 0.5 - z;
          const double weight = taper.centre - taper.fall * (i * i + j * j);
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

TEST_P(MapKernelsTest, SurfacesOfAGroupAreThoseOfEachOfIts) {
  // Whatever the numbers, sane or not.
  SurfaceGroup a;
  std::vector<QuadricSums> sums(SurfaceGroup::kSize);
  const auto filter_of = [](int k) -> const QuadricFilter& {
    return quadric_filter(1 + k % 6, 16);
  };
  for (int k = 0; k < SurfaceGroup::kSize; ++k) {
    for (std::size_t f = 0; f < kQuadric; ++f) {
      sums[k][f] = static_cast<int>(20000.0 * std::sin(static_cast<double>(11 * k + 3 * f)));
    }
    a.put(k, sums[k], k - 3, 2 * k - 5, k % 2 == 0 ? 1 : -1, filter_of(k));
  }
  for (const int stride : {1, 2}) {
    SurfaceGroup b = a;
    plain_->surfaces(a, stride);
    fast_->surfaces(b, stride);
    for (int k = 0; k < SurfaceGroup::kSize; ++k) {
      const QuadricFilter& filter = filter_of(k);
      const ColumnQuadric one = column_quadric(
          quadric_of(sums[k], k - 3, 2 * k - 5, k % 2 == 0 ? 1 : -1, filter.solution),
          filter.answers, static_cast<float>(stride));
      const Foot foot = foot_of(one);
      for (const SurfaceGroup* group : {&a, &b}) {
        EXPECT_EQ(group->surface(k).c, one.c);
        EXPECT_EQ(group->surface(k).t_x, one.t_x);
        EXPECT_EQ(group->surface(k).t_y, one.t_y);
        EXPECT_EQ(group->surface(k).quartic, one.quartic);
        EXPECT_EQ(group->foot(k).normal_x, foot.normal_x);
        EXPECT_EQ(group->foot(k).normal_y, foot.normal_y);
        EXPECT_EQ(group->foot(k).normal_z, foot.normal_z);
        EXPECT_EQ(group->foot(k).offset, foot.offset);
      }
    }
    if (stride != 1) continue;
    std::vector<ResidualCubes> cubes(SurfaceGroup::kSize);
    std::vector<ColumnQuadric> before;
    for (int k = 0; k < SurfaceGroup::kSize; ++k) {
      for (std::size_t f = 0; f < kQuadric; ++f) {
        cubes[k][f] = static_cast<float>(std::sin(static_cast<double>(7 * k + 5 * f)));
      }
      before.push_back(a.surface(k));
      for (std::size_t f = 0; f < kQuadric; ++f) a.cubes[f][k] = b.cubes[f][k] = cubes[k][f];
    }
    plain_->sharpen_group(a);
    fast_->sharpen_group(b);
    for (int k = 0; k < SurfaceGroup::kSize; ++k) {
      ColumnQuadric one = before[k];
      sharpen(filter_of(k).solution, cubes[k], 1.0f, one);
      for (const SurfaceGroup* group : {&a, &b}) {
        EXPECT_EQ(group->surface(k).c, one.c);
        EXPECT_EQ(group->foot(k).normal_x, foot_of(one).normal_x);
        EXPECT_EQ(group->foot(k).offset, foot_of(one).offset);
        EXPECT_EQ(group->bend[k], bend_of(one));
      }
    }
  }
}

TEST_P(MapKernelsTest, FeetOfGroupsAreThoseOfTheirSurfaces) {
  std::array<SurfaceGroup, 3> a;
  for (int n = 0; n < 24; ++n) {
    SurfaceGroup& group = a[static_cast<std::size_t>(n / 8)];
    QuadricSums sums;
    for (std::size_t f = 0; f < kQuadric; ++f)
      sums[f] = 37 * (n + 3) % 91 * (f == 0 ? 40 : 9) - 300;
    group.put(n % 8, sums, n % 5, n % 7 - 3, n % 2 == 0 ? 1 : -1, quadric_filter(2 + n % 5, 16));
    group.axis[n % 8] = n % 3;
    for (int axis = 0; axis < 3; ++axis) {
      group.coarse[axis][n % 8] = static_cast<float>(std::sin(2 * n + axis));
      group.tool[axis][n % 8] = static_cast<float>(std::cos(5 * n + 3 * axis));
    }
  }
  std::array<SurfaceGroup, 3> b = a, surfaces = a;
  const std::uint64_t stand = plain_->feet(a.data(), a.size());
  ASSERT_EQ(fast_->feet(b.data(), b.size()), stand);
  int standing = 0;
  for (int n = 0; n < 24; ++n) {
    const auto e = static_cast<std::size_t>(n / 8);
    const int k = n % 8;
    if (k == 0) plain_->surfaces(surfaces[e], 1);
    const SurfaceGroup& group = surfaces[e];
    const MapAxes axes{group.axis[k], n % 2 == 0 ? 1 : -1};
    const Vector3f normal = to_index_space(group.foot(k), axes).normal;
    const Vector3f coarse(group.coarse[0][k], group.coarse[1][k], group.coarse[2][k]);
    const Vector3f tool(group.tool[0][k], group.tool[1][k], group.tool[2][k]);
    const bool stands_alone = stands(normal, coarse, heard(tool, coarse));
    EXPECT_EQ((stand >> n & 1) != 0, stands_alone) << n;
    standing += stands_alone ? 1 : 0;
    for (const auto* groups : {&a, &b}) {
      EXPECT_EQ((*groups)[e].normal(k), normal) << n;
      EXPECT_EQ((*groups)[e].offset[k], group.offset[k]) << n;
      EXPECT_EQ((*groups)[e].bend[k], bend_of(group.surface(k))) << n;
    }
  }
  EXPECT_GT(standing, 3);
  EXPECT_LT(standing, 21);
}

TEST_P(MapKernelsTest, ResidualsOfAGroupAreThoseOfEachOfItsMaps) {
  int groups = 0;
  for_maps([&](const ColumnBits::Windows& columns, int sign) {
    HeightMap map = ask(6, 1, sign);
    plain_->trace(columns, 12, map);
    if (map.whole_rings < map.ns) return;
    SurfaceGroup a, b;
    std::array<MapRows, SurfaceGroup::kSize> rows;
    constexpr unsigned kWhich = 0x9b;
    for (int k = 0; k < SurfaceGroup::kSize; ++k) {
      const QuadricFilter& filter = quadric_filter(1 + k % 6, map.lanes);
      QuadricSums sums;
      plain_->fit(map.middle_row(), map.lanes, filter, sums);
      a.put(k, sums, map.at(0, 0), map.at(0, 0), sign, filter);
      rows[static_cast<std::size_t>(k)] = rows_of(map);
    }
    plain_->surfaces(a, 1);
    b = a;
    plain_->group_residuals(rows.data(), kWhich, a);
    fast_->group_residuals(rows.data(), kWhich, b);
    for (int k = 0; k < SurfaceGroup::kSize; ++k) {
      ResidualCubes one{};
      const float largest2 =
          (kWhich >> k & 1u) != 0 ? plain_->map_residuals(rows_of(map), a.surface(k), one) : 0.0f;
      for (const SurfaceGroup* group : {&a, &b}) {
        EXPECT_EQ(group->largest2[k], largest2);
        for (std::size_t f = 0; f < kQuadric; ++f) EXPECT_EQ(group->cubes[f][k], one[f]);
      }
    }
    ++groups;
  });
  EXPECT_GT(groups, 100);
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

TEST_P(MapKernelsTest, VoxelsAreAimedAndFoundInTheirTilesAsOneByOne) {
  constexpr int kNs = 5, kTrace = 9, kLeastRings = 3;
  int sided = 0, even = 0, partly = 0, elsewhere = 0;
  for (const Workpiece& workpiece : shapes()) {
    const std::vector<Cell> cells = test::surface_cells(workpiece);
    for (std::size_t first = 0; first + 64 <= cells.size(); first += 64) {
      SurfaceGroup plain[8], fast[8];
      std::array<MapAxes, 64> axes;
      std::array<Vector3f, 64> out;
      std::uint64_t with_side = 0;
      for (std::size_t k = 0; k < 64; ++k) {
        const Cell& c = cells[first + k];
        Vector3i sums = -coarse_normal(workpiece, c);
        if (k % 9 == 0) sums.setZero();  // of the tool, then
        const Vector3f tool = k % 18 == 0 ? Vector3f::Zero() : Vector3f(0.3f, -0.9f, 0.9f);
        for (SurfaceGroup* groups : {plain, fast}) {
          groups[k / 8].put_voxel(static_cast<int>(k % 8), c.data(), tool.data(), sums.data());
        }
        const Vector3f coarse = sums.isZero() ? tool : Vector3f((-sums).cast<float>());
        out[k] = coarse;
        axes[k] = dominant_axes(coarse);
        if (!coarse.isZero()) with_side |= std::uint64_t{1} << k;
      }
      ASSERT_EQ(plain_->aim(plain, 8), with_side);
      ASSERT_EQ(fast_->aim(fast, 8), with_side);
      const Cell origin = cells[first].array() / kLeafEdge * kLeafEdge;
      std::array<HeightTile::Column, 64> columns;
      std::uint64_t of_even = 0, of_partly = 0;
      for (std::size_t k = 0; k < 64; ++k) {
        const Eigen::Vector3i at = in_tile(cells[first + k], axes[k]);
        for (const SurfaceGroup* groups : {plain, fast}) {
          const SurfaceGroup& g = groups[k / 8];
          ASSERT_EQ(Vector3f(g.coarse[0][k % 8], g.coarse[1][k % 8], g.coarse[2][k % 8]), out[k]);
          ASSERT_EQ(g.axis[k % 8], axes[k].axis);
          ASSERT_EQ(g.sign[k % 8], static_cast<float>(axes[k].sign));
          ASSERT_EQ(g.column[k % 8], at.y() * kLeafEdge + at.x());
          ASSERT_EQ(g.layer[k % 8], at.z());
        }
        HeightTile tile;
        tile.ns = kNs;
        tile.sign = axes[k].sign;
        plain_->tile(workpiece.columns().around(axes[k].axis, origin[axes[k].first()],
                                                origin[axes[k].second()],
                                                origin[axes[k].axis] - HeightTile::kBelow),
                     tile);
        columns[k] = tile.column(at.x(), at.y());
        if ((cells[first + k].array() / kLeafEdge * kLeafEdge != origin.array()).any()) {
          ++elsewhere;
          continue;
        }
        if (!tile.has_map(at.x(), at.y(), at.z(), kTrace)) continue;
        if (columns[k].even_rings < kLeastRings) continue;
        (columns[k].even_rings == kNs ? of_even : of_partly) |= std::uint64_t{1} << k;
      }
      const auto look = [&](const MapKernels& kernels, SurfaceGroup* groups) {
        return kernels.look_up(columns.data(), origin.data(), kNs, kTrace, kLeastRings, groups, 8);
      };
      for (const TileMaps& maps : {look(*plain_, plain), look(*fast_, fast)}) {
        ASSERT_EQ(maps.even, of_even);
        ASSERT_EQ(maps.partly, of_partly);
      }
      for (std::size_t k = 0; k < 64; ++k) {
        const int layer = in_tile(cells[first + k], axes[k]).z();
        for (const SurfaceGroup* groups : {plain, fast}) {
          ASSERT_EQ(groups[k / 8].centre[k % 8], columns[k].height);
          ASSERT_EQ(groups[k / 8].level[k % 8], columns[k].height - layer);
        }
      }
      sided += std::popcount(with_side), even += std::popcount(of_even);
      partly += std::popcount(of_partly);
    }
  }
  for (const int count : {sided, even, partly, elsewhere}) EXPECT_GT(count, 20);
}

TEST_P(MapKernelsTest, MapsCutOutOfATileAreTheTracedOnesBitForBit) {
  int cut = 0, all = 0;
  for (const Workpiece& workpiece : shapes()) {
    for (const Cell& c : test::surface_cells(workpiece)) {
      const Cell origin = c.array() / kLeafEdge * kLeafEdge;
      for (int n = 0; n < 6; ++n) {
        const MapAxes axes{n / 2, n % 2 == 0 ? 1 : -1};
        const Eigen::Vector3i at = in_tile(c, axes);
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
        for (int v = 0; v < HeightTile::kEdge; ++v) {
          ASSERT_EQ(plain.sound[v], fast.sound[v]);
          for (int u = 0; u < HeightTile::kEdge; ++u) {
            for (std::size_t f = 0; plain.is_sound(u, v) && f < kQuadric; ++f) {
              ASSERT_EQ(plain.sums[v][f][u], fast.sums[v][f][u]) << ns << " " << f;
            }
          }
        }
        HeightMap traced = ask(ns, 1, axes.sign);
        plain_->trace(windows(workpiece, c, axes.axis), trace, traced);
        for (const MapKernels* kernels : {plain_, fast_}) {
          ++all;
          HeightMap map = ask(ns, 1, axes.sign);
          const bool is_cut = kernels->cut(plain, at.x(), at.y(), at.z(), trace, map);
          for (const HeightTile* tile : {&plain, &fast}) {
            ASSERT_EQ(tile->has_map(at.x(), at.y(), at.z(), trace), is_cut) << kernels->name;
            if (!is_cut) continue;
            ASSERT_EQ(tile->column(at.x(), at.y()).even_rings, map.even_rings);
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
          for (std::size_t f = 0; f < kQuadric; ++f) tile_sums[f] = plain.sums[at.y()][f][at.x()];
          const int level = traced.at(0, 0), height = plain.at(at.x(), at.y());
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
      plain_->trace(columns, 12, map);
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

TEST_P(MapKernelsTest, TiltedPointsAndTheirSumsAreTheSameBitForBit) {
  for_maps([&](const ColumnBits::Windows& columns, int sign) {
    HeightMap map = ask(6, 1, sign);
    plain_->trace(columns, 12, map);
    const float radius = 8.0f;
    TiltedFrame frame{{0.8f, 0.0f, -0.6f}, {0.36f, 0.8f, 0.48f}, {0.48f, -0.6f, 0.64f}, radius, {}};
    TiltedPoints a, b;
    frame.side = {0.6f, -0.8f, 1.3f};
    plain_->gather(map, frame, a);
    fast_->gather(map, frame, b);
    ASSERT_EQ(a.count, b.count);
    ASSERT_EQ(std::memcmp(a.u, b.u, static_cast<std::size_t>(a.count) * sizeof(float)), 0);
    int inside = 0;
    for (int j = -6; j <= 6; ++j) {
      for (int i = -6; i <= 6; ++i) {
        const float z = static_cast<float>(sign * map.at(i, j)) + 0.5f;
        if (0.6 * i - 0.8 * j < -1.3) continue;
        inside += static_cast<float>(i * i + j * j) + z * z <= radius * radius ? 1 : 0;
      }
    }
    ASSERT_EQ(a.count, inside);
    frame.side = {};
    plain_->gather(map, frame, a);
    fast_->gather(map, frame, b);
    ASSERT_EQ(a.count, b.count);
    inside = 0;
    for (int j = -6; j <= 6; ++j) {
      for (int i = -6; i <= 6; ++i) {
        const float z = static_cast<float>(sign * map.at(i, j)) + 0.5f;
        inside += static_cast<float>(i * i + j * j) + z * z <= radius * radius ? 1 : 0;
      }
    }
    ASSERT_EQ(a.count, inside);
    const auto same_points = [&] {
      const std::size_t bytes = static_cast<std::size_t>((a.count + 7) / 8 * 8) * sizeof(float);
      return std::memcmp(a.weight, b.weight, bytes) == 0 && std::memcmp(a.u, b.u, bytes) == 0 &&
             std::memcmp(a.w, b.w, bytes) == 0 && std::memcmp(a.n, b.n, bytes) == 0;
    };
    ASSERT_TRUE(same_points());
    TiltedMoments p, q;
    plain_->moments(a, p);
    fast_->moments(a, q);
    for (int i = 0; i <= 4; ++i) {
      for (int j = 0; i + j <= 4; ++j) ASSERT_EQ(p.m[i][j], q.m[i][j]);
    }
    for (int i = 0; i <= 2; ++i) {
      for (int j = 0; i + j <= 2; ++j) ASSERT_EQ(p.z[i][j], q.z[i][j]);
    }
    Residuals r, s;
    const Quadric c{0.01f, 0.1f, -0.2f, 0.3f, 0.05f, -0.1f};
    plain_->residuals(a, c, r);
    fast_->residuals(a, c, s);
    ASSERT_EQ(r.largest, s.largest);
    ASSERT_EQ(r.sum_squares, s.sum_squares);
    plain_->sharpen_points(c, a);
    fast_->sharpen_points(c, b);
    ASSERT_TRUE(same_points());
  });
}

TEST_P(MapKernelsTest, StepsOfAPlaneAreTheColumnsOnItAndTheSameBitForBit) {
  for_maps([&](const ColumnBits::Windows& columns, int sign) {
    for (const int ns : {4, 6, 12}) {
      HeightMap map = ask(ns, 1, sign);
      plain_->trace(columns, 12, map);
      const HeightPlane plane{0.4f, 0.3f, -0.2f, 0.94f, 0.57f};
      constexpr float kBound = 0.6f;
      PlaneLook look, same_look;
      plain_->look_at_plane(map, plane, look);
      fast_->look_at_plane(map, plane, same_look);
      ASSERT_EQ(look.count, same_look.count);
      ASSERT_EQ(look.residuals.largest, same_look.residuals.largest);
      ASSERT_EQ(look.residuals.sum_squares, same_look.residuals.sum_squares);
      for (const PlaneWeight kind :
           {PlaneWeight::kTaper, PlaneWeight::kQuartic, PlaneWeight::kInterior}) {
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
            const double taper = 1.0 - (i * i + j * j) / (2.5 * ns * ns);
            const double inside = kBound * kBound - r * r;
            const double weight = kind == PlaneWeight::kTaper ? taper
                                  : kind == PlaneWeight::kQuartic
                                      ? taper * r * r
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
      plain_->trace(columns, 12, map);
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

TEST(ColumnQuadric, AQuadricAslantIsRecoveredFromItsHeights) {
  // Heights of a cap of 30 voxels' radius about 35 degrees from the axis, without quantisation:
  // what the filter alone makes of them is off by degrees at the rim's scale, the correction is
  // not.
  const double radius = 30.0, tilt = 0.6;
  const QuadricFilter& filter = quadric_filter(6, 16);
  // Heights in 1/256 voxel, so that their sums are whole numbers.
  constexpr double kFine = 256.0;
  QuadricSums sums{};
  for (std::size_t f = 0; f < kQuadric; ++f) {
    for (int j = -6; j <= 6; ++j) {
      for (int i = -6; i <= 6; ++i) {
        const double x = i + radius * std::sin(tilt);
        const double z = std::sqrt(radius * radius - x * x - j * j) - radius * std::cos(tilt);
        sums[f] +=
            static_cast<int>(std::lround(kFine * z)) * filter.coefficient[f][(6 + j) * 16 + 8 + i];
      }
    }
  }
  Quadric fitted = quadric_of(sums, 0, 0, 1, filter.solution);
  fitted[0] -= 0.5f;  // which a whole voxel's height has and these do not
  for (float& c : fitted) c /= static_cast<float>(kFine);
  const Eigen::Vector3d truth(std::sin(tilt), 0.0, std::cos(tilt));
  ColumnQuadric plain;
  plain.c = fitted;
  const auto error_deg = [&](const Foot& foot) {
    return test::angle_deg({foot.normal_x, foot.normal_y, foot.normal_z}, truth);
  };
  const double before = error_deg(foot_of(plain));
  const double after = error_deg(foot_of(column_quadric(fitted, filter.answers, 1.0f)));
  EXPECT_GT(before, 0.8);
  EXPECT_LT(after, 0.2);
}

TEST(QuadricFilter, GivesTheCoefficientsOfEveryQuadric) {
  for (const int rings : {2, 3, 6, 7, 12}) {
    const QuadricFilter& filter = quadric_filter(rings, lanes_of(rings));
    for (std::size_t term = 0; term < kQuadric; ++term) {
      QuadricSums sums{};
      for (int j = -rings; j <= rings; ++j) {
        for (int i = -rings; i <= rings; ++i) {
          const int power[kQuadric] = {1, i, j, i * i, i * j, j * j};
          for (std::size_t f = 0; f < kQuadric; ++f) {
            sums[f] += power[term] *
                       filter.coefficient[f][(rings + j) * filter.lanes + filter.lanes / 2 + i];
          }
        }
      }
      const int centre = term == 0;
      const Quadric c = quadric_of(sums, centre, centre, 1, filter.solution);
      for (std::size_t f = 0; f < kQuadric; ++f) {
        EXPECT_NEAR(c[f], (f == term) + (f == 0 ? 0.5f : 0.0f), 2e-5f)
            << rings << " " << f << " " << term;
      }
    }
  }
}

}  // namespace
}  // namespace sulcus
