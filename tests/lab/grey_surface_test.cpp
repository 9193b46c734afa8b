#include "tools/sulcus_lab/truth/grey_surface.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/lab/grey_volumes.hpp"
#include "tools/sulcus_lab/truth/grey_spline.hpp"

// The truth of grey values, by closed forms and by looking everywhere.

namespace sulcus::lab::grey_surface_test {
namespace {

using Eigen::Vector3d;
using namespace test;

MedicalVolume noise(const Eigen::Vector3i& sizes) {
  MedicalVolume volume;
  volume.sizes = sizes;
  std::mt19937 random(5);
  std::normal_distribution<float> normal(600.0f, 100.0f);
  for (int v = 0; v < sizes.prod(); ++v) volume.values.push_back(normal(random));
  return volume;
}

TEST(GreySpline, GoesThroughTheValues) {
  for (const Eigen::Vector3i& sizes : {Eigen::Vector3i(9, 12, 7), Eigen::Vector3i(5, 2, 3)}) {
    const MedicalVolume volume = noise(sizes);
    const GreySpline spline(volume, GreyTruth::kThrough);
    for_each_cell(Cell::Zero(), sizes, [&](const Cell& c) {
      EXPECT_NEAR(spline.value(c.cast<double>()), volume.at(c.x(), c.y(), c.z()), 1e-9);
    });
  }
}

/// A polynomial of which no cubic spline through its values differs: in the middle of a lattice,
/// where its mirrored ends are no longer felt.
double cubic(const Vector3d& p) {
  const Vector3d x = (p - Vector3d(21.3, 20.1, 19.7)) / 10.0;
  return 3.0 * x.x() * x.x() * x.x() - 2.0 * x.y() * x.z() * x.x() + x.y() * x.y() - 4.0 * x.z();
}

TEST(GreySpline, KeepsCubicsWithTheirDerivatives) {
  MedicalVolume volume;
  volume.sizes = Eigen::Vector3i::Constant(42);
  for_each_cell(Cell::Zero(), volume.sizes, [&](const Cell& c) {
    volume.values.push_back(static_cast<float>(cubic(c.cast<double>())));
  });
  const GreySpline spline(volume, GreyTruth::kThrough);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> middle(19.0, 22.0);
  for (int n = 0; n < 50; ++n) {
    const Vector3d p(middle(random), middle(random), middle(random));
    const GreySpline::Sample at = spline.sample(p);
    EXPECT_NEAR(at.value, cubic(p), 2e-6);  // the values are floats
    EXPECT_DOUBLE_EQ(at.value, spline.value(p));
    const double h = 1e-3;
    for (int a = 0; a < 3; ++a) {
      const Vector3d da = h * Vector3d::Unit(a);
      EXPECT_NEAR(at.gradient[a], (cubic(p + da) - cubic(p - da)) / (2 * h), 1e-5);
      for (int b = 0; b < 3; ++b) {
        const Vector3d db = h * Vector3d::Unit(b);
        const double mixed =
            (cubic(p + da + db) - cubic(p + da - db) - cubic(p - da + db) + cubic(p - da - db)) /
            (4 * h * h);
        EXPECT_NEAR(at.hessian(a, b), mixed, 1e-5);
      }
    }
  }
}

/// The kernel has a variance of a third along each axis.
TEST(GreySpline, SmoothedAddsItsVarianceToAParabola) {
  MedicalVolume volume;
  volume.sizes = Eigen::Vector3i::Constant(12);
  for_each_cell(Cell::Zero(), volume.sizes, [&](const Cell& c) {
    volume.values.push_back(static_cast<float>(c.squaredNorm()));
  });
  const GreySpline spline(volume, GreyTruth::kSmoothed);
  for (const Vector3d& p : {Vector3d(5.0, 6.0, 5.0), Vector3d(4.3, 6.9, 5.5)}) {
    EXPECT_NEAR(spline.value(p), p.squaredNorm() + 1.0, 1e-9);
  }
}

/// Largest errors of offset (lattice steps) and normal (degrees) at random places near a surface.
struct Largest {
  double offset = 0.0, normal_deg = 0.0;
  int count = 0;
};
template <class Surface, class Scanner>
Largest largest_errors(const Surface& surface, const Scanner& scanner) {
  const GreySpline spline(scanned(Eigen::Vector3i(40, 38, 41), surface, scanner),
                          GreyTruth::kThrough);
  const GreySurface found(spline, kHalfGrey);
  Largest largest;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(12.0, 26.0);
  while (largest.count < 400) {
    Vector3d p;
    for (double& x : p) x = anywhere(random);  // in this order under every compiler
    const KnownGreySurface known = surface(p);
    if (std::abs(known.distance) > 1.2) continue;
    const auto at = found.closest_point(p);
    if (!at) ADD_FAILURE() << "none at " << p.transpose();
    if (!at) break;
    ++largest.count;
    largest.offset = std::max(largest.offset, std::abs(at->offset + known.distance));
    largest.normal_deg = std::max(
        largest.normal_deg,
        std::atan2(at->normal.cross(known.normal).norm(), at->normal.dot(known.normal)) * 57.2958);
  }
  return largest;
}

const GreyBall kBall{Vector3d(19.3, 18.9, 20.2), 9.4};
const GreyPlane kTilted{Vector3d(19.3, 18.9, 20.2), Vector3d(0.3, -0.2, 0.9).normalized()};
const GreyPlane kNearlyUpright{Vector3d(19.3, 18.9, 20.2), Vector3d(0.02, 0.01, 1.0).normalized()};

TEST(GreySurface, OfASmearedStepIsWhereTheStepIs) {
  const auto expect = [](const auto& surface) {
    const Largest largest = largest_errors(surface, Smeared());
    EXPECT_LT(largest.offset, 5e-3);
    EXPECT_LT(largest.normal_deg, 0.6);
  };
  expect(kTilted);
  expect(kNearlyUpright);
  expect(kBall);
}

/// As sharp as a scan can be: no smooth curve through such values is the step itself.
TEST(GreySurface, OfSharpVoxelsIsWithinAFewHundredths) {
  const auto expect = [](const auto& surface) {
    const Largest largest = largest_errors(surface, Averaged());
    // Over 20,000 places of each 0.0811 at most.
    EXPECT_LT(largest.offset, 0.082);
    EXPECT_LT(largest.normal_deg, 18.0);
  };
  expect(kTilted);
  expect(kNearlyUpright);
  expect(kBall);
}

TEST(GreySurface, CurvatureAndSlopeAreThoseOfTheBall) {
  const GreySpline spline(scanned(Eigen::Vector3i::Constant(40), kBall, Smeared()),
                          GreyTruth::kThrough);
  const auto at = GreySurface(spline, kHalfGrey).closest_point(kBall.centre + Vector3d(6, 5, 5));
  ASSERT_TRUE(at);
  EXPECT_NEAR(at->curvature, 1.0 / kBall.radius, 0.01);
  EXPECT_NEAR(at->slope, 0.5 * (kSolidGrey - kAirGrey) / Smeared().width, 0.5);
}

/// In noise the surface bends within a voxel: looked for by brute force, on a lattice as fine as
/// is drawn from the same spline, no point beyond the surface is nearer than the closest point.
TEST(GreySurface, NoPointOfADenseLatticeIsNearer) {
  const MedicalVolume volume = noise(Eigen::Vector3i::Constant(14));
  const GreySpline spline(volume, GreyTruth::kSmoothed);
  const GreySurface surface(spline, 600.0);
  int count = 0, nearer = 0;
  for_each_cell(Cell::Constant(4), Cell::Constant(10), [&](const Cell& c) {
    const Vector3d p = c.cast<double>();
    const auto at = surface.closest_point(p);
    if (!at) return;
    ++count;
    EXPECT_NEAR(spline.value(at->point), 600.0, 1e-5);
    EXPECT_EQ(at->offset > 0.0, surface.solid(p));
    EXPECT_NEAR((at->point - p - at->offset * at->normal).norm(), 0.0, 1e-6);
    constexpr int kReach = 10;
    nearer += any_cell(Cell::Constant(-kReach), Cell::Constant(kReach + 1), [&](const Cell& to) {
      const Vector3d q = p + 0.25 * to.cast<double>();
      return (q - p).norm() < std::abs(at->offset) - 0.02 && surface.solid(q) != surface.solid(p);
    });
  });
  EXPECT_GT(count, 180);
  EXPECT_LE(nearer, count / 50);
}

TEST(GreySurface, WallsAndGapsAreThin) {
  for (const double thickness : {1.6, 5.0}) {
    for (const bool wall : {true, false}) {
      const auto slab = [&](const Vector3d& p) -> KnownGreySurface {
        const double z = p.z() - 20.2, outside = std::abs(z) - 0.5 * thickness;
        return {wall ? outside : -outside,
                (z < 0.0) == wall ? -Vector3d::UnitZ().eval() : Vector3d::UnitZ().eval()};
      };
      const GreySpline spline(scanned(Eigen::Vector3i(12, 12, 41), slab, Smeared{0.6}),
                              GreyTruth::kThrough);
      const GreySurface surface(spline, kHalfGrey);
      const auto at = surface.closest_point(Vector3d(6.0, 6.0, 20.2 + 0.5 * thickness));
      ASSERT_TRUE(at);
      EXPECT_EQ(surface.is_thin(*at, 3.0), thickness < 3.0) << thickness << wall;
    }
  }
}

TEST(GreySurface, FarFromItThereIsNone) {
  const GreySpline spline(scanned(Eigen::Vector3i::Constant(40), kBall, Smeared()),
                          GreyTruth::kThrough);
  const GreySurface surface(spline, kHalfGrey);
  EXPECT_FALSE(surface.closest_point(kBall.centre));
  EXPECT_FALSE(surface.closest_point(kBall.centre + Vector3d(0.0, 14.0, 0.0)));
}

}  // namespace
}  // namespace sulcus::lab::grey_surface_test
