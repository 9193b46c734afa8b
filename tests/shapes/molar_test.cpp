#include "engine/shapes/molar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/shapes/voxelise_implicit.hpp"

namespace sulcus::molar_test {
namespace {

using Eigen::Vector3d;

constexpr std::array<std::uint8_t, 4> kLabels{0, 1, 2, 3};
constexpr double kCoarse = 0.15 * kMillimetre;

Part part_at(const Molar& molar, const Vector3d& p) {
  return molar.parts_within(p, 0.0, PartSet::all()).first();
}

/// The whole tooth, its labels being its parts.
VoxelModel coarse_molar(double caries_radius_m = 0.0) {
  return voxelise_implicit(Molar(caries_radius_m), VoxelGrid{{96, 80, 168}, kCoarse}, &kLabels);
}

template <class Visit>
void for_each_solid(const VoxelModel& model, Visit visit) {
  Cell c;
  for (c.z() = 0; c.z() < model.grid.cells.z(); ++c.z()) {
    for (c.y() = 0; c.y() < model.grid.cells.y(); ++c.y()) {
      for (c.x() = 0; c.x() < model.grid.cells.x(); ++c.x()) {
        if (model.solid(c)) visit(c);
      }
    }
  }
}

std::array<double, 4> part_volumes_mm3(const VoxelModel& model) {
  std::array<double, 4> volumes{};
  for_each_solid(model, [&](const Cell& c) { volumes[model.tissue(c)] += 0.15 * 0.15 * 0.15; });
  return volumes;
}

/// Points in and about the tooth, metres.
std::vector<Vector3d> scattered_points(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(-6.5, 6.5), y(-6.0, 6.0), z(-12.6, 9.0);
  std::vector<Vector3d> points;
  for (int n = 0; n < count; ++n) {
    points.push_back(kMillimetre * Vector3d(x(random), y(random), z(random)));
  }
  return points;
}

/// Height of the tooth over (x, y), metres; below -1 m where there is none.
double top(const Molar& molar, double x, double y) {
  double z = 8.6 * kMillimetre;
  while (z > -13.0 * kMillimetre) {
    const double value = molar.value({x, y, z});
    if (value < 1e-7) return z;
    z -= value / molar.lipschitz();
  }
  return -2.0;
}

/// Number of 4-connected parts of a horizontal slice.
int slice_components(const VoxelModel& model, double z_world) {
  const int k =
      static_cast<int>(std::lround(model.grid.index_from_world(Vector3d(0.0, 0.0, z_world)).z()));
  const int nx = model.grid.cells.x(), ny = model.grid.cells.y();
  std::vector<bool> seen(static_cast<std::size_t>(nx * ny));
  int components = 0;
  for (int start = 0; start < nx * ny; ++start) {
    std::vector<int> open{start};
    bool found = false;
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      const int i = at % nx, j = at / nx;
      if (seen[static_cast<std::size_t>(at)] || !model.solid({i, j, k})) continue;
      seen[static_cast<std::size_t>(at)] = found = true;
      if (i > 0) open.push_back(at - 1);
      if (i + 1 < nx) open.push_back(at + 1);
      if (j > 0) open.push_back(at - nx);
      if (j + 1 < ny) open.push_back(at + nx);
    }
    components += found ? 1 : 0;
  }
  return components;
}

TEST(Molar, GradientIsThatOfTheValue) {
  const Molar molar;
  constexpr double kStep = 1e-8;  // m
  for (const Vector3d& p : scattered_points(4000)) {
    if ((p.cwiseAbs().array() > Vector3d(5.85e-3, 5.3e-3, 12.0e-3).array()).any()) continue;
    if (p.z() > 8.55e-3) continue;
    const Vector3d gradient = molar.gradient(p);
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d step = kStep * Vector3d::Unit(axis);
      const double difference = (molar.value(p + step) - molar.value(p - step)) / (2.0 * kStep);
      ASSERT_NEAR(gradient[axis], difference, 2e-5) << p.transpose() << " axis " << axis;
    }
  }
}

TEST(Molar, LipschitzBoundHoldsBetweenPointsAndAtThem) {
  const Molar molar;
  const std::vector<Vector3d> points = scattered_points(20000);
  for (std::size_t n = 1; n < points.size(); ++n) {
    const Vector3d near = points[n] + 0.02 * (points[n - 1] - points[n]);
    const double value = molar.value(points[n]);
    EXPECT_LE(std::abs(molar.value(near) - value), molar.lipschitz() * (near - points[n]).norm());
    EXPECT_LE(std::abs(molar.value(points[n - 1]) - value),
              molar.lipschitz() * (points[n - 1] - points[n]).norm());
    EXPECT_LE(molar.gradient(points[n]).norm(), molar.lipschitz());
  }
}

TEST(Molar, NoOtherPartsAreWithinARadiusThanItSays) {
  const Molar molar(0.8 * kMillimetre);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> any(0.0, 1.0);
  int used = 0, settled = 0;
  for (const Vector3d& p : scattered_points(20000)) {
    if (molar.value(p) > 0.0) continue;
    ++used;
    const double radius = kMillimetre * any(random);
    const PartSet within = molar.parts_within(p, radius, PartSet::all());
    settled += within == PartSet::only(within.first()) ? 1 : 0;
    for (int n = 0; n < 4; ++n) {
      const Vector3d way(normal(random), normal(random), normal(random));
      const Vector3d q = p + 0.999 * radius * std::cbrt(any(random)) * way.normalized();
      if (molar.value(q) > 0.0) continue;
      EXPECT_TRUE(within.has(part_at(molar, q))) << p.transpose();
      // Of what it leaves the answer is the same.
      EXPECT_EQ(molar.parts_within(q, 0.0, within), PartSet::only(part_at(molar, q)));
    }
  }
  EXPECT_GT(used, 4000);
  EXPECT_GT(settled, used / 5);
  EXPECT_LT(settled, used * 9 / 10);
}

TEST(Molar, HasTheSizeOfALowerFirstMolar) {
  const Molar molar;
  Eigen::AlignedBox3d box;
  constexpr double kStep = 0.04;  // mm
  double highest = -1.0;
  for (double y = -5.4; y < 5.4; y += kStep) {
    for (double x = -6.0; x < 6.0; x += kStep) {
      highest = std::max(highest, top(molar, x * kMillimetre, y * kMillimetre));
    }
  }
  EXPECT_NEAR(highest, 8.4 * kMillimetre, 0.02 * kMillimetre);

  const VoxelModel model = coarse_molar();
  EXPECT_FALSE(model.clipped);
  for_each_solid(model, [&](const Cell& c) { box.extend(model.grid.centre_world(c)); });
  const Vector3d size = box.sizes() + Vector3d::Constant(kCoarse);
  EXPECT_NEAR(size.x(), 11.5 * kMillimetre, 0.3 * kMillimetre);
  EXPECT_NEAR(size.y(), 10.3 * kMillimetre, 0.3 * kMillimetre);
  EXPECT_NEAR(size.z(), 20.3 * kMillimetre, 0.3 * kMillimetre);
  EXPECT_TRUE(molar.bounds().contains(box));
  // And the bounds are hardly looser.
  EXPECT_LT((molar.bounds().sizes() - box.sizes()).maxCoeff(), 2.0 * kCoarse);
}

TEST(Molar, HasTheVolumeAndTheShareOfEnamelOfARealOne) {
  const std::array<double, 4> volume = part_volumes_mm3(coarse_molar());
  const double whole = volume[0] + volume[1] + volume[2] + volume[3];
  EXPECT_NEAR(whole, 870.0, 0.15 * 870.0);
  EXPECT_GT(volume[0] / whole, 0.22);
  EXPECT_LT(volume[0] / whole, 0.28);
  EXPECT_GT(volume[2], 25.0);  // pulp
  EXPECT_LT(volume[2], 80.0);
}

TEST(Molar, FiveCuspsStandAboutASulcus) {
  const Molar molar;
  // A cusp: no lower than everything within 0.8 mm.
  constexpr double kStep = 0.1;  // mm
  constexpr int kReach = 8;
  constexpr int kHalfX = 60, kHalfY = 56;
  std::vector<double> heights;
  for (int j = -kHalfY; j <= kHalfY; ++j) {
    for (int i = -kHalfX; i <= kHalfX; ++i) {
      heights.push_back(top(molar, i * kStep * kMillimetre, j * kStep * kMillimetre));
    }
  }
  const auto height = [&](int i, int j) {
    return heights[static_cast<std::size_t>((j + kHalfY) * (2 * kHalfX + 1) + i + kHalfX)];
  };
  std::vector<Vector3d> cusps;
  for (int j = -kHalfY + kReach; j <= kHalfY - kReach; ++j) {
    for (int i = -kHalfX + kReach; i <= kHalfX - kReach; ++i) {
      bool greatest = height(i, j) > 6.5 * kMillimetre;
      for (int v = -kReach; greatest && v <= kReach; ++v) {
        for (int u = -kReach; greatest && u <= kReach; ++u) {
          greatest = (u == 0 && v == 0) || height(i + u, j + v) < height(i, j);
        }
      }
      if (greatest) cusps.emplace_back(i * kStep, j * kStep, height(i, j) / kMillimetre);
    }
  }
  ASSERT_EQ(cusps.size(), 5u);
  std::sort(cusps.begin(), cusps.end(),
            [](const Vector3d& a, const Vector3d& b) { return a.z() > b.z(); });
  EXPECT_GT(cusps[0].y(), 2.0);  // the lingual cusps are the highest
  EXPECT_GT(cusps[1].y(), 2.0);
  EXPECT_LT(cusps[2].y(), -1.0);
  EXPECT_LT(cusps[3].y(), -1.0);
  EXPECT_LT(cusps[4].x(), -3.0);  // the distal one is the lowest

  double sum = 0.0;
  int count = 0;
  for (int i = -30; i <= 35; ++i, ++count) sum += height(i, 0) / kMillimetre;
  EXPECT_NEAR(8.4 - sum / count, 2.4, 0.4);

  const Vector3d pit = molar.central_pit();
  EXPECT_NEAR(molar.value(pit), 0.0, 1e-9);
  EXPECT_LT(pit.z() / kMillimetre, sum / count);
}

TEST(Molar, EnamelIsThickOverTheCuspsAndEndsAtTheNeck) {
  const Molar molar;
  for (const auto& [x, y] : {std::pair{2.6, -2.7}, {-1.0, -2.85}, {2.45, 2.85}, {-2.0, 2.85}}) {
    const double surface = top(molar, x * kMillimetre, y * kMillimetre);
    double z = surface - 1e-6;
    while (part_at(molar, kMillimetre * Vector3d(x, y, z / kMillimetre)) == Part::kEnamel)
      z -= 1e-5;
    EXPECT_GT(surface - z, 2.0 * kMillimetre);
    EXPECT_LT(surface - z, 2.5 * kMillimetre);
  }
  // Thickness along the buccal face, going down; the mesial neck is higher than the buccal.
  const auto thickness = [&](const Vector3d& inward, double z) {
    Vector3d p = -7.0 * kMillimetre * inward + Vector3d(0.0, 0.0, z);
    while (molar.value(p) > 0.0) p += 1e-5 * inward;
    const Vector3d surface = p;
    while (part_at(molar, p) == Part::kEnamel) p += 1e-5 * inward;
    return (p - surface).norm();
  };
  double above = 10.0;
  for (double z = 3.0; z > 0.6; z -= 0.3) {
    const double here = thickness(Vector3d::UnitY(), z * kMillimetre);
    EXPECT_LT(here, above);
    above = here;
  }
  EXPECT_LT(above, 0.25 * kMillimetre);
  EXPECT_EQ(thickness(Vector3d::UnitY(), 0.0), 0.0);
  EXPECT_EQ(thickness(-Vector3d::UnitX(), 1.0 * kMillimetre), 0.0);
  EXPECT_GT(thickness(Vector3d::UnitY(), 1.0 * kMillimetre), 0.0);
}

TEST(Molar, PulpLiesInDentineAndRunsIntoBothRoots) {
  const VoxelModel model = coarse_molar();
  double lowest_mesial = 0.0, lowest_distal = 0.0, highest = -1.0;
  for_each_solid(model, [&](const Cell& c) {
    if (model.tissue(c) != 2) return;
    const Vector3d p = model.grid.centre_world(c);
    (p.x() > 0.0 ? lowest_mesial : lowest_distal) =
        std::min(p.x() > 0.0 ? lowest_mesial : lowest_distal, p.z());
    highest = std::max(highest, p.z());
    for (int axis = 0; axis < 3; ++axis) {
      for (int step : {-1, 1}) {
        const Cell q = c + step * Cell::Unit(axis);
        ASSERT_TRUE(model.solid(q));
        ASSERT_NE(model.tissue(q), 0);
      }
    }
  });
  EXPECT_LT(lowest_mesial, -9.0 * kMillimetre);
  EXPECT_LT(lowest_distal, -9.0 * kMillimetre);
  EXPECT_GT(highest, 3.5 * kMillimetre);  // the horns
}

TEST(Molar, RootsPartBelowTheNeck) {
  const VoxelModel model = coarse_molar();
  EXPECT_EQ(slice_components(model, 0.5 * kMillimetre), 1);
  EXPECT_EQ(slice_components(model, -1.5 * kMillimetre), 1);
  EXPECT_EQ(slice_components(model, -4.0 * kMillimetre), 2);
  EXPECT_EQ(slice_components(model, -10.5 * kMillimetre), 2);
}

TEST(Molar, CariesOnlyWhereAskedFor) {
  EXPECT_EQ(part_volumes_mm3(coarse_molar())[3], 0.0);
  const std::array<double, 4> small = part_volumes_mm3(coarse_molar(0.5 * kMillimetre));
  const std::array<double, 4> large = part_volumes_mm3(coarse_molar(1.0 * kMillimetre));
  EXPECT_GT(small[3], 0.2);
  EXPECT_GT(large[3], 2.0 * small[3]);

  const Molar molar(0.8 * kMillimetre);
  const Vector3d pit = molar.central_pit();
  EXPECT_EQ(part_at(molar, pit - Vector3d(0.0, 0.0, 1e-5)), Part::kCaries);  // the way in
  // Undermining: wide in the dentine, narrow in the enamel above.
  const Vector3d aside(0.5 * kMillimetre, 0.0, 0.0);
  EXPECT_EQ(part_at(molar, pit + aside - Vector3d(0.0, 0.0, 0.7 * kMillimetre)), Part::kEnamel);
  EXPECT_EQ(part_at(molar, pit + aside - Vector3d(0.0, 0.0, 1.85 * kMillimetre)), Part::kCaries);
}

TEST(Molar, RefusesALesionLargerThanItsPlace) {
  EXPECT_THROW(Molar(-1e-4), InputError);
  EXPECT_THROW(Molar(2.6e-3), InputError);
  EXPECT_THROW(Molar(std::nan("")), InputError);
}

}  // namespace
}  // namespace sulcus::molar_test
