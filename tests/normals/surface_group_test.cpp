#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/normals/coarse_normal.hpp"
#include "engine/normals/map_batch.hpp"
#include "tests/support/map_kernels_fixture.hpp"

namespace sulcus::surface_group_test {
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
  SurfaceGroup b = a;
  plain_->surfaces(&a, 1, SurfaceParts::kAll);
  fast_->surfaces(&b, 1, SurfaceParts::kAll);
  std::vector<ResidualCubes> cubes(SurfaceGroup::kSize);
  std::vector<ColumnQuadric> before;
  for (int k = 0; k < SurfaceGroup::kSize; ++k) {
    const QuadricFilter& filter = filter_of(k);
    const ColumnQuadric one =
        column_quadric(quadric_of(sums[k], k - 3, 2 * k - 5, k % 2 == 0 ? 1 : -1, filter.solution),
                       filter.answers, 1.0f);
    const ClosestPoint closest = closest_point_of(one);
    for (const SurfaceGroup* group : {&a, &b}) {
      EXPECT_EQ(group->surface(k).c, one.c);
      EXPECT_EQ(group->surface(k).t_x, one.t_x);
      EXPECT_EQ(group->surface(k).t_y, one.t_y);
      EXPECT_EQ(group->surface(k).quartic, one.quartic);
      EXPECT_EQ(group->closest_point(k).normal_x, closest.normal_x);
      EXPECT_EQ(group->closest_point(k).normal_y, closest.normal_y);
      EXPECT_EQ(group->closest_point(k).normal_z, closest.normal_z);
      EXPECT_EQ(group->closest_point(k).offset, closest.offset);
    }
    before.push_back(one);
    for (std::size_t f = 0; f < kQuadric; ++f) {
      cubes[k][f] = static_cast<float>(std::sin(static_cast<double>(7 * k + 5 * f)));
      a.cubes[f][k] = b.cubes[f][k] = cubes[k][f];
    }
  }
  plain_->sharpen_group(a);
  fast_->sharpen_group(b);
  for (int k = 0; k < SurfaceGroup::kSize; ++k) {
    ColumnQuadric one = before[k];
    sharpen(filter_of(k).solution, cubes[k], 1.0f, one);
    for (const SurfaceGroup* group : {&a, &b}) {
      EXPECT_EQ(group->surface(k).c, one.c);
      EXPECT_EQ(group->closest_point(k).normal_x, closest_point_of(one).normal_x);
      EXPECT_EQ(group->closest_point(k).offset, closest_point_of(one).offset);
      EXPECT_EQ(group->curvature[k], curvature_of(one));
    }
  }
}

TEST_P(SurfaceGroupTest, ClosestPointsOfGroupsAreThoseOfTheirSurfaces) {
  std::array<SurfaceGroup, 3> a;
  std::array<ColumnQuadric, 24> quadrics;
  for (int n = 0; n < 24; ++n) {
    SurfaceGroup& group = a[static_cast<std::size_t>(n / 8)];
    const int sign = n % 2 == 0 ? 1 : -1;
    const QuadricFilter& filter = quadric_filter(2 + n % 5, 16);
    QuadricSums sums;
    for (std::size_t f = 0; f < kQuadric; ++f)
      sums[f] = 37 * (n + 3) % 91 * (f == 0 ? 40 : 9) - 300;
    group.put(n % 8, sums, n % 5, n % 7 - 3, sign, filter);
    quadrics[static_cast<std::size_t>(n)] = column_quadric(
        quadric_of(sums, n % 5, n % 7 - 3, sign, filter.solution), filter.answers, 1.0f);
    group.axis[n % 8] = n % 3;
    for (int axis = 0; axis < 3; ++axis) {
      group.coarse[axis][n % 8] = static_cast<float>(std::sin(2 * n + axis));
      group.tool[axis][n % 8] = static_cast<float>(std::cos(5 * n + 3 * axis));
    }
  }
  std::array<SurfaceGroup, 3> b = a;
  const std::uint64_t consistent =
      plain_->surfaces(a.data(), a.size(), SurfaceParts::kClosestPoints);
  ASSERT_EQ(fast_->surfaces(b.data(), b.size(), SurfaceParts::kClosestPoints), consistent);
  int count = 0;
  for (int n = 0; n < 24; ++n) {
    const auto e = static_cast<std::size_t>(n / 8);
    const int k = n % 8;
    const ColumnQuadric& quadric = quadrics[static_cast<std::size_t>(n)];
    const MapAxes axes{n % 3, n % 2 == 0 ? 1 : -1};
    const Vector3f normal = to_index_space(closest_point_of(quadric), axes).normal;
    const Vector3f coarse(a[e].coarse[0][k], a[e].coarse[1][k], a[e].coarse[2][k]);
    const Vector3f tool(a[e].tool[0][k], a[e].tool[1][k], a[e].tool[2][k]);
    // No hint beyond 120 degrees from the coarse normal; away from neither that nor the hint.
    const bool has_hint = test::angle_deg(coarse.cast<double>(), tool.cast<double>()) <= 120.0;
    const bool is_one = normal.dot(coarse) > 0.0f && !(has_hint && normal.dot(tool) < 0.0f);
    EXPECT_EQ((consistent >> n & 1) != 0, is_one) << n;
    count += is_one ? 1 : 0;
    for (const auto* groups : {&a, &b}) {
      EXPECT_EQ((*groups)[e].normal(k), normal) << n;
      EXPECT_EQ((*groups)[e].offset[k], closest_point_of(quadric).offset) << n;
      EXPECT_EQ((*groups)[e].curvature[k], curvature_of(quadric)) << n;
    }
  }
  EXPECT_GT(count, 3);
  EXPECT_LT(count, 21);
}

TEST_P(SurfaceGroupTest, ResidualsOfAGroupAreThoseOfEachOfItsMaps) {
  int groups = 0;
  for_maps([&](const ColumnBits::Windows& columns, int sign) {
    HeightMap map = ask(6, 1, sign);
    trace_one(*plain_, columns, 12, map);
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
    plain_->surfaces(&a, 1, SurfaceParts::kAll);
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

bool is_solid(const Workpiece& workpiece, const Cell& c) {
  return (c.array() >= 0).all() && (c.array() < workpiece.grid().cells.array()).all() &&
         workpiece.solid(c);
}

/// Away from the solid: minus the sum of unit vectors to its voxels within 2.5.
Eigen::Vector3d away_from_solid(const Workpiece& workpiece, const Cell& voxel) {
  Eigen::Vector3d away = Eigen::Vector3d::Zero();
  for (int z = -2; z <= 2; ++z) {
    for (int y = -2; y <= 2; ++y) {
      for (int x = -2; x <= 2; ++x) {
        const Eigen::Vector3d d(x, y, z);
        if (d.isZero() || d.norm() > 2.5 || !is_solid(workpiece, voxel + Cell(x, y, z))) continue;
        away -= d.normalized();
      }
    }
  }
  return away;
}

TEST_P(SurfaceGroupTest, VoxelsAreAimedAwayFromTheSolidAroundThem) {
  int sided = 0, of_tool = 0, equals = 0;
  const Vector3f tool(0.3f, -0.9f, 0.8f);  // along y, downward
  for (const Workpiece& workpiece : shapes()) {
    const std::vector<Cell> cells = test::surface_cells(workpiece);
    for (std::size_t first = 0; first + 64 <= cells.size(); first += 64) {
      SurfaceGroup plain[8], fast[8];
      for (std::size_t k = 0; k < 64; ++k) {
        const Cell& c = cells[first + k];
        const Vector3i sums =
            k % 9 == 0 ? Vector3i(Vector3i::Zero()) : Vector3i(-coarse_normal(workpiece, c));
        const Vector3f says = k % 18 == 0 ? Vector3f(Vector3f::Zero()) : tool;
        for (SurfaceGroup* groups : {plain, fast}) {
          groups[k / 8].put_voxel(static_cast<int>(k % 8), c.data(), says.data(), sums.data());
        }
      }
      for (const EqualAxes equal : {EqualAxes::kLast, EqualAxes::kMiddle, EqualAxes::kFirst}) {
        const VoxelAxes a = plain_->choose_axes(plain, 64, equal),
                        b = fast_->choose_axes(fast, 64, equal);
        ASSERT_EQ(a.has_direction, b.has_direction);
        ASSERT_EQ(a.two_equal, b.two_equal);
        ASSERT_EQ(a.three_equal, b.three_equal);
        for (int g = 0; g < 8; ++g) {
          for (int k = 0; k < SurfaceGroup::kSize; ++k) {
            ASSERT_EQ(plain[g].axis[k], fast[g].axis[k]);
            ASSERT_EQ(plain[g].sign[k], fast[g].sign[k]);
          }
        }
        for (std::size_t k = 0; k < 64; ++k) {
          const auto& coarse = plain[k / 8].coarse;
          std::vector<int> largest;
          float most = 0.0f;
          for (const auto& c : coarse) most = std::max(most, std::abs(c[k % 8]));
          for (int axis = 0; axis < 3; ++axis) {
            if (std::abs(coarse[axis][k % 8]) == most) largest.push_back(axis);
          }
          if (most == 0.0f) largest.clear();
          ASSERT_EQ((a.two_equal >> k & 1) != 0, largest.size() >= 2);
          ASSERT_EQ((a.three_equal >> k & 1) != 0, largest.size() == 3);
          equals += largest.size() >= 2;
          if (largest.empty() || (equal == EqualAxes::kMiddle && largest.size() < 3)) continue;
          const int expected = equal == EqualAxes::kFirst  ? largest.front()
                               : equal == EqualAxes::kLast ? largest.back()
                                                           : 1;
          ASSERT_EQ(plain[k / 8].axis[k % 8], expected);
        }
      }
      const std::uint64_t with_side =
          plain_->choose_axes(plain, 64, EqualAxes::kFirst).has_direction;
      // Lanes beyond so many voxels have no side, whatever they hold.
      for (const std::size_t voxels : {std::size_t{1}, std::size_t{13}}) {
        const std::uint64_t of_these = with_side & ~std::uint64_t{0} >> (64 - voxels);
        ASSERT_EQ(plain_->choose_axes(plain, voxels, EqualAxes::kFirst).has_direction, of_these);
        ASSERT_EQ(fast_->choose_axes(fast, voxels, EqualAxes::kFirst).has_direction, of_these);
      }
      for (std::size_t k = 0; k < 64; ++k) {
        const Cell& c = cells[first + k];
        Eigen::Vector3d away = away_from_solid(workpiece, c);
        const bool as_tool = k % 9 == 0 || away.norm() < 1e-9;
        if (as_tool)
          away = k % 18 == 0 ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : tool.cast<double>();
        ASSERT_EQ((with_side >> k & 1) != 0, !away.isZero()) << k;
        Eigen::Index axis = 0;
        const double most = away.cwiseAbs().maxCoeff(&axis);
        Eigen::Vector3d others = away;
        others[axis] = 0.0;
        for (const SurfaceGroup* groups : {plain, fast}) {
          const SurfaceGroup& g = groups[k / 8];
          const Vector3f coarse(g.coarse[0][k % 8], g.coarse[1][k % 8], g.coarse[2][k % 8]);
          // In whole parts of 1 / 120: up to 2 x 0.5 / 120 of each of 40 voxels on one side.
          const double scale = as_tool ? 1.0 : 120.0;
          ASSERT_LT((coarse.cast<double>() / scale - away).norm(), 0.3) << k;
          if (most - others.cwiseAbs().maxCoeff() < (as_tool ? 0.01 : 0.6)) {
            continue;  // either, by rounding
          }
          const int u = static_cast<int>((axis + 1) % 3), v = static_cast<int>((axis + 2) % 3);
          ASSERT_EQ(g.axis[k % 8], axis) << k;
          ASSERT_EQ(g.sign[k % 8], away[axis] > 0.0 ? 1.0f : -1.0f) << k;
          ASSERT_EQ(g.column[k % 8], c[u] % 8 + 8 * (c[v] % 8)) << k;
          ASSERT_EQ(g.layer[k % 8], c[axis] % 8) << k;
          (as_tool ? of_tool : sided) += 1;
        }
      }
    }
  }
  EXPECT_GT(sided, 1000);
  EXPECT_GT(of_tool, 100);
  EXPECT_GT(equals, 100);
}

/// The map about a voxel, traced voxel by voxel as MapKernels::trace says. Heights are layers from
/// the voxel's.
class TracedByVoxels {
 public:
  TracedByVoxels(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes, int ns)
      : workpiece_(workpiece),
        voxel_(voxel),
        axes_(axes),
        ns_(ns),
        heights_((2 * ns + 1) * (2 * ns + 1)) {
    at(0, 0) = follow(0, 0, 0);
    for (int i = 1; i <= ns; ++i) {
      at(i, 0) = follow(i, 0, at(i - 1, 0));
      at(-i, 0) = follow(-i, 0, at(1 - i, 0));
    }
    for (int j = 1; j <= ns; ++j) {
      for (int i = -ns; i <= ns; ++i) {
        at(i, j) = follow(i, j, at(i, j - 1));
        at(i, -j) = follow(i, -j, at(i, 1 - j));
      }
    }
  }

  int centre() const { return heights_[index(0, 0)]; }
  /// Whether every column has a height, within so many voxels.
  bool is_whole(int trace) const {
    return std::ranges::all_of(heights_, [&](int h) { return std::abs(h) <= trace; });
  }
  /// Rings in which opposite heights are in line with the centre's by no more than a bound.
  int rings_even_within(int most) const {
    int rings = ns_;
    for (int j = -ns_; j <= ns_; ++j) {
      for (int i = -ns_; i <= ns_; ++i) {
        const int uneven = heights_[index(i, j)] + heights_[index(-i, -j)] - 2 * centre();
        const int ring = std::max(std::abs(i), std::abs(j));
        if (std::abs(uneven) > most) rings = std::min(rings, ring - 1);
      }
    }
    return rings;
  }
  /// Whether each column changes between solid and empty once, and as the surface does, within 12
  /// layers below and 11 above a leaf whose lowest layer is so far from the voxel's, and is no more
  /// than a step from those beside it: there can be no doubt what is meant, in whatever order.
  bool is_certain(int leaf) const {
    for (int j = -ns_; j <= ns_; ++j) {
      for (int i = -ns_; i <= ns_; ++i) {
        const int height = heights_[index(i, j)];
        if (i > -ns_ && std::abs(height - heights_[index(i - 1, j)]) > kMaxStep) return false;
        if (j > -ns_ && std::abs(height - heights_[index(i, j - 1)]) > kMaxStep) return false;
        int changes = 0;
        for (int h = leaf - 12; h < leaf + 19; ++h) {
          changes += is_solid(workpiece_, cell(i, j, h)) != is_solid(workpiece_, cell(i, j, h + 1));
        }
        if (changes != 1) return false;
      }
    }
    return true;
  }

 private:
  static constexpr int kNowhere = 1000;

  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>((j + ns_) * (2 * ns_ + 1) + i + ns_);
  }
  int& at(int i, int j) { return heights_[index(i, j)]; }
  Cell cell(int i, int j, int h) const {
    Cell c = voxel_;
    c[(axes_.axis + 1) % 3] += i;
    c[(axes_.axis + 2) % 3] += j;
    c[axes_.axis] += h;
    return c;
  }
  /// The surface nearest to a height, the outer one of two, at most 2 away.
  int follow(int i, int j, int from) const {
    for (const int step : {0, 1, -1, 2, -2}) {
      const int h = from + axes_.sign * step;
      if (is_solid(workpiece_, cell(i, j, h)) &&
          !is_solid(workpiece_, cell(i, j, h + axes_.sign))) {
        return h;
      }
    }
    return kNowhere;
  }

  const Workpiece& workpiece_;
  Cell voxel_;
  MapAxes axes_;
  int ns_;
  std::vector<int> heights_;
};

TEST_P(SurfaceGroupTest, MapsInTilesAreThoseThatAreTracedVoxelByVoxel) {
  constexpr int kNs = 5, kLeastRings = 3;
  int even = 0, partly = 0, elsewhere = 0, certain = 0;
  for (const Workpiece& workpiece : shapes()) {
    const std::vector<Cell> cells = test::surface_cells(workpiece);
    for (std::size_t first = 0; first + 64 <= cells.size(); first += 64) {
      SurfaceGroup plain[8], fast[8];
      std::array<MapAxes, 64> axes;
      std::array<HeightTile::Column, 64> columns;
      const Cell origin = cells[first].array() / kLeafEdge * kLeafEdge;
      for (std::size_t k = 0; k < 64; ++k) {
        const Cell& c = cells[first + k];
        const Vector3i sums = -coarse_normal(workpiece, c);
        const Vector3f tool = Vector3f::UnitX();
        for (SurfaceGroup* groups : {plain, fast}) {
          groups[k / 8].put_voxel(static_cast<int>(k % 8), c.data(), tool.data(), sums.data());
        }
      }
      plain_->choose_axes(plain, 64, EqualAxes::kFirst);
      fast_->choose_axes(fast, 64, EqualAxes::kFirst);
      for (std::size_t k = 0; k < 64; ++k) {
        const SurfaceGroup& g = plain[k / 8];
        axes[k] = {g.axis[k % 8], g.sign[k % 8] > 0.0f ? 1 : -1};
        HeightTile tile;
        tile.ns = kNs;
        tile.sign = axes[k].sign;
        plain_->tile(workpiece.columns().around(axes[k].axis, origin[axes[k].first()],
                                                origin[axes[k].second()],
                                                origin[axes[k].axis] - HeightTile::kBelow),
                     tile);
        columns[k] = tile.columns[g.column[k % 8]];
      }
      const int trace = first % 128 == 0 ? 9 : 2;
      const auto look = [&](const MapKernels& kernels, SurfaceGroup* groups) {
        return kernels.look_up(columns.data(), origin.data(), kNs, trace, kLeastRings, groups, 8);
      };
      const TileMaps maps = look(*plain_, plain), fast_maps = look(*fast_, fast);
      ASSERT_EQ(fast_maps.even, maps.even);
      ASSERT_EQ(fast_maps.partly, maps.partly);
      ASSERT_EQ(maps.even & maps.partly, 0u);
      for (std::size_t k = 0; k < 64; ++k) {
        const Cell& c = cells[first + k];
        const bool is_even = (maps.even >> k & 1) != 0, is_partly = (maps.partly >> k & 1) != 0;
        if ((c.array() / kLeafEdge != origin.array() / kLeafEdge).any()) {
          ASSERT_FALSE(is_even || is_partly) << k;
          ++elsewhere;
          continue;
        }
        const TracedByVoxels map(workpiece, c, axes[k], kNs);
        const bool whole = map.is_whole(trace);
        // Of many rings more is let pass.
        const int of_many = whole ? map.rings_even_within(kMostUnevenOfMany) : 0;
        const int rings = of_many >= kManyRings
                              ? of_many
                              : std::min(map.rings_even_within(kMostUneven), kManyRings - 1);
        if (is_even || is_partly) {
          ASSERT_TRUE(whole) << k;
          ASSERT_EQ(is_even, rings == kNs) << k;
          ASSERT_GE(rings, kLeastRings) << k;
          for (const SurfaceGroup* groups : {plain, fast}) {
            ASSERT_EQ(groups[k / 8].level[k % 8], map.centre()) << k;
            ASSERT_EQ(groups[k / 8].centre[k % 8], map.centre() + c[axes[k].axis] % 8) << k;
          }
        } else if (whole && rings >= kLeastRings) {
          ASSERT_FALSE(map.is_certain(origin[axes[k].axis] - c[axes[k].axis])) << k;
        }
        certain += whole && map.is_certain(origin[axes[k].axis] - c[axes[k].axis]);
        even += is_even, partly += is_partly;
      }
    }
  }
  for (const int count : {even, partly, elsewhere, certain}) EXPECT_GT(count, 20);
}

}  // namespace
}  // namespace sulcus::surface_group_test
