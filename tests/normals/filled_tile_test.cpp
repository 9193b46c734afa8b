#include "engine/normals/filled_tile.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "engine/shapes/basic_shapes.hpp"
#include "engine/shapes/voxelise_implicit.hpp"
#include "tests/support/map_kernels_fixture.hpp"
#include "tests/support/rough_blobs.hpp"

namespace sulcus::filled_tile_test {
namespace {

constexpr int kNs = 6, kReach = FilledTile::kMostReach;

Workpiece ball() {
  VoxelGrid grid;
  grid.cells = Eigen::Vector3i::Constant(48);
  grid.voxel_m = 1.0;
  return Workpiece(
      voxelise_implicit(SphereShape(20.0), grid, nullptr, Pose{}, SurfaceKind::kFractions));
}

FillLevel level(const Workpiece& workpiece, const Cell& c) {
  const bool inside = (c.array() >= 0).all() && (c.array() < workpiece.grid().cells.array()).all();
  return inside && workpiece.model().solid(c) ? workpiece.model().level(c) : FillLevel{0};
}

/// The height of a column over a voxel at `from`, parts, as it is told: voxel by voxel.
std::optional<int> told_height(const Workpiece& workpiece, Cell from, const MapAxes& axes) {
  const auto at = [&](int t) {
    Cell c = from;
    c[axes.axis] += t * axes.sign;
    return static_cast<int>(level(workpiece, c));
  };
  std::optional<int> nearest;
  for (int t = -kReach; t <= kReach + kMostPartFilled; ++t) {
    if (at(t) == 0 || at(t + 1) != 0) continue;
    if (!nearest || std::abs(t) < std::abs(*nearest) || t == -*nearest) nearest = t;
  }
  if (!nearest) return {};
  int lack = 0, fullest = 0, above_fullest = 0;
  for (int n = 0; n < kMostPartFilled; ++n) {
    const int parts = at(*nearest - n);
    if (parts == 255) return 255 * *nearest - lack;
    if (parts == 0) return 255 * *nearest - (above_fullest + (255 - fullest) / 2);
    if (parts > fullest) fullest = parts, above_fullest = lack;
    lack += 255 - parts;
  }
  return {};
}

struct Told {
  double slope_x = 0, slope_y = 0, mean_square = 0;
};
/// Least squares of all columns of a window; none where one has no height within reach.
std::optional<Told> told_fit(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes,
                             int rings, int a, int b) {
  const int columns = (2 * rings + 1) * (2 * rings + 1);
  Eigen::MatrixXd powers(columns, 6);
  Eigen::VectorXd heights(columns);
  int row = 0;
  for (int j = -rings; j <= rings; ++j) {
    for (int i = -rings; i <= rings; ++i, ++row) {
      Cell c = voxel;
      c[axes.first()] += a + i;
      c[axes.second()] += b + j;
      const auto height = told_height(workpiece, c, axes);
      if (!height || std::abs(*height) > 255 * kReach) return {};
      heights[row] = *height / 255.0;
      powers.row(row) << 1, i, j, i * i, i * j, j * j;
    }
  }
  const Eigen::VectorXd c = powers.colPivHouseholderQr().solve(heights);
  const double cosine2 = 1.0 / (1.0 + c[1] * c[1] + c[2] * c[2]);
  return Told{c[1], c[2], (heights - powers * c).squaredNorm() / (columns - 6) * cosine2};
}

struct Window {
  int rings, a, b;
};
constexpr Window kWindows[] = {{6, 0, 0}, {4, 0, 0},  {3, 0, 0}, {2, 0, 0},
                               {3, 3, 0}, {2, -3, 3}, {2, 1, 1}, {3, 0, -2}};

/// Calls `each(voxel, axes, tile of the leaf, tile of the layer, u, v, w outward)`.
template <class Each>
void for_tiles(const Workpiece& workpiece, const Each& each) {
  const std::vector<Cell> cells = test::surface_cells(workpiece);
  for (std::size_t k = 0; k < cells.size(); k += 11) {
    const Cell& voxel = cells[k];
    const Cell origin = voxel.unaryExpr([](int c) { return c & -kLeafEdge; });
    for (int axis = 0; axis < 3; ++axis) {
      for (const int sign : {-1, 1}) {
        const MapAxes axes{axis, sign};
        const int u = voxel[axes.first()] - origin[axes.first()],
                  v = voxel[axes.second()] - origin[axes.second()], w = voxel[axis] - origin[axis];
        FilledTile leaf, layer;
        leaf.begin(workpiece, origin, kLeafEdge, axes, kNs, kReach);
        Cell first = origin;
        first[axis] += w;
        layer.begin(workpiece, first, 1, axes, kNs, kReach);
        leaf.read_about(v);
        layer.read_about(v);
        each(voxel, axes, leaf, layer, u, v, sign > 0 ? w : kLeafEdge - 1 - w);
      }
    }
  }
}

bool is_seen(const FilledTile::Fit& fit, int level) {
  return std::isfinite(fit.mean_square()) && fit.of->lowest[fit.lane] - level >= -255 * kReach &&
         fit.of->highest[fit.lane] - level <= 255 * kReach;
}

TEST(FilledTile, WindowsAreTheLeastSquaresOfTheFillsAsTheyAreTold) {
  int fits = 0, none = 0;
  for (const Workpiece& workpiece : {test::rough_blobs(), ball()}) {
    for_tiles(workpiece, [&](const Cell& voxel, const MapAxes& axes, FilledTile&, FilledTile& layer,
                             int u, int v, int) {
      for (const auto& [rings, a, b] : kWindows) {
        const FilledTile::Fit fit = layer.fit(rings, u + a, v + b);
        const auto told = told_fit(workpiece, voxel, axes, rings, a, b);
        ++(told ? fits : none);
        // What is too steep to fit is none of ours.
        if (told && !std::isfinite(fit.mean_square())) {
          ASSERT_GT(fit.of->highest[fit.lane] - fit.of->lowest[fit.lane], 12 * 255);
          continue;
        }
        ASSERT_EQ(is_seen(fit, 0), told.has_value()) << voxel.transpose() << ' ' << rings;
        if (!told) continue;
        ASSERT_NEAR(fit.mean_square(), told->mean_square, 1e-3 * told->mean_square + 2e-5);
        // Less what the filter makes of the cubic part, of which a ball has little near its top.
        const double steepness = std::abs(told->slope_x) + std::abs(told->slope_y);
        if (rings <= 3 && told->mean_square < 1e-4 && steepness < 0.3) {
          ASSERT_NEAR(fit.of->c[1][fit.lane], told->slope_x, 5e-3);
          ASSERT_NEAR(fit.of->c[2][fit.lane], told->slope_y, 5e-3);
        }
      }
    });
  }
  EXPECT_GT(fits, 1000);
  EXPECT_GT(none, 1000);
}

TEST(FilledTile, ALeafSaysWhatItsLayersSay) {
  int single = 0, several = 0, seen = 0;
  for (const Workpiece& workpiece : {test::rough_blobs(), ball()}) {
    for_tiles(workpiece, [&](const Cell&, const MapAxes&, FilledTile& leaf, FilledTile& layer,
                             int u, int v, int w) {
      ASSERT_TRUE(layer.is_single(u, v));
      if (!leaf.is_single(u, v)) {
        ++several;
        return;
      }
      ++single;
      for (const auto& [rings, a, b] : kWindows) {
        const FilledTile::Fit of_leaf = leaf.fit(rings, u + a, v + b),
                              of_layer = layer.fit(rings, u + a, v + b);
        ASSERT_EQ(is_seen(of_leaf, 255 * w), is_seen(of_layer, 0));
        if (!is_seen(of_layer, 0)) continue;
        ++seen;
        ASSERT_EQ(of_leaf.mean_square(), of_layer.mean_square());
        ASSERT_EQ(of_leaf.of->centre[of_leaf.lane] - 255 * w, of_layer.of->centre[of_layer.lane]);
        for (std::size_t f = 0; f < kQuadric; ++f) {
          ASSERT_EQ(of_leaf.of->c[f][of_leaf.lane], of_layer.of->c[f][of_layer.lane]);
        }
      }
    });
  }
  EXPECT_GT(single, 1000);
  EXPECT_GT(several, 100);
  EXPECT_GT(seen, 1000);
}

class WindowKernels : public test::MapKernelsFixture {};
INSTANTIATE_TEST_SUITE_P(Sets, WindowKernels, test::fast_sets(), test::set_of);

TEST_P(WindowKernels, FitsAreTheSame) {
  constexpr int kPitch = 40, kRows = 15;
  std::mt19937 random(7);
  std::vector<std::int16_t> heights(kPitch * kRows);
  for (int n = 0; n < 60; ++n) {
    const int scatter = n % 3 == 0 ? 1 : n % 3 == 1 ? 200 : 9000;  // too steep at last
    for (std::size_t k = 0; k < heights.size(); ++k) {
      heights[k] = random() % 400 == 0
                       ? kNoHeight
                       : static_cast<std::int16_t>(40 * static_cast<int>(k % kPitch) +
                                                   static_cast<int>(random() % scatter) - 2000);
    }
    for (int rings = 2; rings <= kMostWindowRings; ++rings) {
      const std::int16_t* const centres = heights.data() + 16;
      const auto fit = [&](const MapKernels& kernels) {
        std::array<RowSums, kRows> rows, smaller;
        for (std::size_t row = 0; row < kRows; ++row) {
          const RowOfWindows windows[] = {{1, &smaller[row]}, {rings, &rows[row]}};
          kernels.sum_row(centres + row * kPitch, windows, 2);
        }
        WindowFits fits;
        kernels.fit_windows(centres + 7 * kPitch, &rows[7], window_filter(rings), fits);
        return fits;
      };
      const WindowFits plain = fit(*plain_), fast = fit(*fast_);
      for (std::size_t k = 0; k < WindowFits::kSize; ++k) {
        ASSERT_EQ(plain.mean_square[k], fast.mean_square[k]);
        ASSERT_EQ(plain.centre[k], fast.centre[k]);
        ASSERT_EQ(plain.lowest[k], fast.lowest[k]);
        ASSERT_EQ(plain.highest[k], fast.highest[k]);
        for (std::size_t f = 0; f < kQuadric; ++f) ASSERT_EQ(plain.c[f][k], fast.c[f][k]);
      }
    }
  }
}

}  // namespace
}  // namespace sulcus::filled_tile_test
