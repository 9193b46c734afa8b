#include <bit>
#include <cmath>
#include <numeric>

#include "engine/normals/coarse_normal.hpp"
#include "engine/normals/leaf_tiles.hpp"
#include "engine/normals/map_group.hpp"
#include "tests/support/map_kernels_fixture.hpp"

namespace sulcus {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

/// Loops over voxels and their surfaces, eight side by side.
class SurfaceGroupTest : public test::MapKernelsFixture {};
INSTANTIATE_TEST_SUITE_P(Sets, SurfaceGroupTest, test::fast_sets(), test::set_of);

TEST_P(SurfaceGroupTest, SurfacesOfAGroupAreThoseOfEachOfIts) {
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

TEST_P(SurfaceGroupTest, FeetOfGroupsAreThoseOfTheirSurfaces) {
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

TEST_P(SurfaceGroupTest, ResidualsOfAGroupAreThoseOfEachOfItsMaps) {
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

TEST_P(SurfaceGroupTest, VoxelsAreAimedAndFoundInTheirTilesAsOneByOne) {
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
      // Lanes beyond so many voxels have no side, whatever they hold.
      for (const std::size_t voxels : {std::size_t{1}, std::size_t{13}, std::size_t{64}}) {
        const std::uint64_t of_these = with_side & ~std::uint64_t{0} >> (64 - voxels);
        ASSERT_EQ(plain_->aim(plain, voxels), of_these);
        ASSERT_EQ(fast_->aim(fast, voxels), of_these);
      }
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

}  // namespace
}  // namespace sulcus
