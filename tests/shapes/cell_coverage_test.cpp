#include "engine/shapes/cell_coverage.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "engine/shapes/basic_shapes.hpp"
#include "engine/shapes/molar.hpp"
#include "engine/shapes/voxelise_implicit.hpp"
#include "tests/support/fills.hpp"

namespace sulcus::cell_coverage_test {
namespace {

using Eigen::Vector3d;
using test::filled_m3;
using test::share;

/// By points: exact along x, 256 x 256 lines across.
double share_by_lines(const Vector3d& n, double distance) {
  constexpr int kLines = 256;
  double sum = 0.0;
  for (int k = 0; k < kLines; ++k) {
    for (int j = 0; j < kLines; ++j) {
      const double rest =
          -distance - n.y() * ((j + 0.5) / kLines - 0.5) - n.z() * ((k + 0.5) / kLines - 0.5);
      if (std::abs(n.x()) < 1e-12) {
        sum += rest >= 0.0 ? 1.0 : 0.0;
      } else {
        sum += std::clamp(0.5 + rest / std::abs(n.x()), 0.0, 1.0);
      }
    }
  }
  return sum / (kLines * kLines);
}

TEST(ShareBehindPlane, IsWhatLinesCount) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> offset(-0.9, 0.9);
  for (int n = 0; n < 100; ++n) {
    const Vector3d way = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const double distance = offset(random);
    EXPECT_NEAR(share_behind_plane(way, distance), share_by_lines(way, distance), 1e-4)
        << way.transpose() << " at " << distance;
  }
}

TEST(ShareBehindPlane, AlongTheAxesAndNearlySo) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double distance : {-0.6, -0.5, -0.2, 0.0, 0.3, 0.5, 0.7}) {
      const double exact = std::clamp(0.5 - distance, 0.0, 1.0);
      EXPECT_NEAR(share_behind_plane(Vector3d::Unit(axis), distance), exact, 1e-12);
      EXPECT_NEAR(share_behind_plane(-Vector3d::Unit(axis), distance), exact, 1e-12);
      // One and two components that nearly vanish, on either side of what counts as none.
      for (const double small : {1e-7, 0.9e-5, 1.1e-5, 1e-4, 1e-3}) {
        for (const double other : {0.0, 1e-6, 1.5e-5, 1e-3, 0.7}) {
          Vector3d n;
          n[axis] = 1.0;
          n[(axis + 1) % 3] = small;
          n[(axis + 2) % 3] = -other;
          n.normalize();
          Vector3d along = n;  // the lines of the truth along its greatest component
          std::swap(along[0], along[axis]);
          EXPECT_NEAR(share_behind_plane(n, distance), share_by_lines(along, distance), 5e-5)
              << n.transpose() << " at " << distance;
        }
      }
    }
  }
}

TEST(ShareBehindPlane, TheOtherSideIsTheRest) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int n = 0; n < 200; ++n) {
    const Vector3d way = Vector3d(number(random), number(random), number(random)).normalized();
    const double distance = 0.8 * number(random);
    EXPECT_NEAR(share_behind_plane(way, distance) + share_behind_plane(-way, -distance), 1.0, 1e-9);
  }
}

template <class S>
VoxelModel filled(const S& shape, const VoxelGrid& grid, const Pose& pose = {}) {
  return voxelise_implicit(shape, grid, nullptr, pose, SurfaceKind::kFractions);
}

Pose oblique() {
  return {Vector3d(0.03e-3, -0.02e-3, 0.01e-3),
          Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vector3d(1.0, 2.0, -1.0).normalized()))};
}

TEST(CellCoverage, VolumesInClosedForm) {
  const VoxelGrid grid{{48, 48, 48}, 1e-4};
  const double radius = 1.83e-3;
  EXPECT_NEAR(filled_m3(filled(SphereShape(radius), grid)) /
                  (4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3)),
              1.0, 1e-4);
  const double major = 1.4e-3, minor = 0.53e-3;
  EXPECT_NEAR(filled_m3(filled(TorusShape(major, minor), grid, oblique())) /
                  (2.0 * std::numbers::pi * std::numbers::pi * major * minor * minor),
              1.0, 2e-4);
  // Its edges are those of parts of voxels.
  EXPECT_NEAR(filled_m3(filled(BoxShape({2.43e-3, 1.71e-3, 0.92e-3}), grid, oblique())) /
                  (2.43e-3 * 1.71e-3 * 0.92e-3),
              1.0, 4e-4);
}

TEST(CellCoverage, ATiltedPlateHasItsThicknessInEveryColumn) {
  const VoxelGrid grid{{32, 32, 32}, 1e-4};
  for (const double tilt : {0.0, 0.01, 0.05, 0.2, 0.35}) {
    const VoxelModel model = filled(PlateShape(0.47e-3, tilt), grid);
    const double exact = 4.7 / std::cos(tilt);
    for (int j = 0; j < 32; ++j) {
      for (int i = 0; i < 32; ++i) {
        double column = 0.0;
        for (int k = 0; k < 32; ++k) column += share(model, {i, j, k});
        ASSERT_NEAR(column, exact, 4 * 0.5 / 255.0) << tilt << ": " << i << ' ' << j;
      }
    }
  }
}

/// Every voxel against 12^3 points of it.
template <class S>
void expect_as_sampled(const S& shape, const VoxelGrid& grid, const Pose& pose, double rms) {
  const VoxelModel model = filled(shape, grid, pose);
  const Eigen::Matrix3d turn = pose.orientation.conjugate().toRotationMatrix();
  constexpr int kParts = 12;
  double squares = 0.0, sum = 0.0, exact = 0.0;
  int partly = 0;
  for_each_cell(Cell::Zero(), grid.cells, [&](const Cell& c) {
    const Vector3d centre = turn * (grid.centre_world(c) - pose.position);
    const double clear = shape.lipschitz() * grid.voxel_m;
    int in = 0;
    if (const double value = shape.value(centre); std::abs(value) > clear) {
      in = value < 0.0 ? kParts * kParts * kParts : 0;
    } else {
      for_each_cell(Cell::Zero(), Cell::Constant(kParts), [&](const Cell& part) {
        const Vector3d to = (part.cast<double>().array() + 0.5) / kParts - 0.5;
        in += shape.value(centre + turn * to * grid.voxel_m) <= 0.0 ? 1 : 0;
      });
    }
    const double truth = in / double(kParts * kParts * kParts);
    sum += share(model, c);
    exact += truth;
    if (in == 0 || in == kParts * kParts * kParts) {
      ASSERT_NEAR(share(model, c), truth, 0.02) << c.transpose();
      return;
    }
    squares += (share(model, c) - truth) * (share(model, c) - truth);
    ++partly;
  });
  EXPECT_GT(partly, 300);
  EXPECT_LT(std::sqrt(squares / partly), rms);
  EXPECT_NEAR(sum / exact, 1.0, 3e-4);
}

TEST(CellCoverage, VoxelByVoxelAsSampled) {
  const VoxelGrid grid{{32, 32, 32}, 1e-4};
  expect_as_sampled(SphereShape(1.3e-3), grid, oblique(), 0.008);
  expect_as_sampled(BoxShape({2.1e-3, 1.6e-3, 1.1e-3}), grid, oblique(), 0.015);
  expect_as_sampled(GrooveShape(1.0, 1e-3), grid, oblique(), 0.015);
}

TEST(CellCoverage, TheMolarAsSampled) {
  // Of the crown, from its grooves to its side.
  expect_as_sampled(Molar(), {{40, 40, 24}, 1e-4}, {Vector3d(-1.5e-3, 0, -6.8e-3), {1, 0, 0, 0}},
                    0.01);
}

}  // namespace
}  // namespace sulcus::cell_coverage_test
