#include "engine/normals/tilted_fit.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "tests/support/map_kernels_fixture.hpp"

namespace sulcus::tilted_fit_test {
namespace {

using Eigen::Vector3f;
using Vector6d = Eigen::Matrix<double, kQuadric, 1>;

/// Points in frames tilted, and fits to them, eight side by side.
class TiltedFitTest : public test::MapKernelsFixture {};
INSTANTIATE_TEST_SUITE_P(Sets, TiltedFitTest, test::fast_sets(), test::set_of);

TEST_P(TiltedFitTest, PointsAndTheirSumsAreTheSameBitForBit) {
  for_maps([&](const ColumnBits::Windows& columns, int sign) {
    HeightMap map = ask(6, 1, sign);
    trace_one(*plain_, columns, 12, map);
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

/// A frame whose third axis leans by `lean` from the columns', turned by `turn`.
TiltedFrame frame_at(float lean, float turn, float radius) {
  const Eigen::Matrix3f axes = (Eigen::AngleAxisf(turn, Vector3f::UnitZ()) *
                                Eigen::AngleAxisf(lean, Vector3f(0.6f, 0.8f, 0.0f)))
                                   .toRotationMatrix();
  const auto column = [&](int c) { return std::array{axes(0, c), axes(1, c), axes(2, c)}; };
  return {column(0), column(1), column(2), radius, {}};
}

/// Moments of points spread over a disc whose heights are those of `quadric`; `aside` shrinks them
/// to a line.
TiltedMoments moments_of(const Quadric& quadric, double aside) {
  TiltedMoments moments{};
  for (int k = 0; k < 150; ++k) {
    const double radius = std::sqrt((k + 0.5) / 150.0), turn = 2.4 * k;
    const double u = radius * std::cos(turn), w = aside * radius * std::sin(turn);
    const double n = quadric[0] + quadric[1] * u + quadric[2] * w + quadric[3] * u * u +
                     quadric[4] * u * w + quadric[5] * w * w;
    const double weight = 1.0 - 0.95 * radius * radius;
    for (int a = 0; a <= 4; ++a) {
      for (int b = 0; a + b <= 4; ++b) {
        const double m = weight * std::pow(u, a) * std::pow(w, b);
        moments.m[a][b] += static_cast<float>(m);
        if (a + b <= 2) moments.z[a][b] += static_cast<float>(m * n);
      }
    }
  }
  return moments;
}

Quadric quadric_number(int k) {
  const auto f = [&](int n) { return static_cast<float>(0.3 * std::sin(7.0 * k + 3.0 * n)); };
  return {f(0), f(1), f(2), f(3), f(4), f(5)};
}

TEST_P(TiltedFitTest, EightAreSolvedSideBySideAndTheSameBitForBit) {
  TiltedGroup group;
  constexpr int kLine = 3, kNothing = 5;  // the fits whose points determine no surface
  for (int k = 0; k < TiltedGroup::kSize; ++k) {
    const auto turn = static_cast<float>(k);
    group.put_frame(k, frame_at(0.1f * turn, turn, 2.6f + turn));
    if (k != kNothing) group.put_moments(k, moments_of(quadric_number(k), k == kLine ? 0.0 : 1.0));
  }
  TiltedGroup same = group;
  plain_->solve_sharpened(group);
  fast_->solve_sharpened(same);
  for (int k = 0; k < TiltedGroup::kSize; ++k) {
    const bool is_determined = k != kLine && k != kNothing;
    ASSERT_EQ(group.has_quadric[k], is_determined ? -1 : 0) << k;
    ASSERT_EQ(same.has_quadric[k], group.has_quadric[k]) << k;
    if (!is_determined) continue;
    ASSERT_EQ(group.quadric_at(k), same.quadric_at(k)) << k;
    // As they lie on it, what is found is what the points were made of.
    for (int f = 0; f < kQuadric; ++f) {
      ASSERT_NEAR(group.quadric[f][k], quadric_number(k)[static_cast<std::size_t>(f)], 2e-5);
    }
  }

  plain_->solve_quantised(group);
  fast_->solve_quantised(same);
  plain_->tilted_closest_points(group);
  fast_->tilted_closest_points(same);
  for (int k = 0; k < TiltedGroup::kSize; ++k) {
    ASSERT_EQ(same.has_plane[k], group.has_plane[k]) << k;
    if (k == kLine || k == kNothing) continue;
    ASSERT_EQ(group.has_plane[k], -1);
    ASSERT_EQ(group.quadric_at(k), same.quadric_at(k)) << k;
    for (int f = 0; f < 3; ++f) ASSERT_EQ(group.plane[f][k], same.plane[f][k]) << k;
    for (int a = 0; a < 3; ++a) ASSERT_EQ(group.normal[a][k], same.normal[a][k]) << k;
    ASSERT_EQ(group.offset[k], same.offset[k]) << k;
    // The second way: the surface's own moments from the definition, by second differences of the
    // powers along the columns, and Eigen's solution of their normal equations, in doubles.
    const double radius = group.radius[k], eu = group.u[2][k], ew = group.w[2][k],
                 en = group.n[2][k], half_variance = 1.0 / (24.0 * radius * radius);
    const auto moment = [&](int a, int b, int c) -> double {
      if (a < 0 || b < 0 || c < 0) return 0.0;
      return c == 0 ? group.m[a][b][k] : group.z[a][b][k];
    };
    const auto own = [&](int a, int b, int c) {
      const double second = eu * eu * a * (a - 1) * moment(a - 2, b, c) +
                            ew * ew * b * (b - 1) * moment(a, b - 2, c) +
                            2.0 * eu * ew * a * b * moment(a - 1, b - 1, c) +
                            2.0 * en * eu * c * a * moment(a - 1, b, c - 1) +
                            2.0 * en * ew * c * b * moment(a, b - 1, c - 1);
      return moment(a, b, c) - half_variance * second;
    };
    constexpr int kPowers[kQuadric][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
    Eigen::Matrix<double, kQuadric, kQuadric> matrix;
    Vector6d right;
    for (int i = 0; i < kQuadric; ++i) {
      for (int j = 0; j < kQuadric; ++j) {
        matrix(i, j) = own(kPowers[i][0] + kPowers[j][0], kPowers[i][1] + kPowers[j][1], 0);
      }
      right[i] = own(kPowers[i][0], kPowers[i][1], 1);
    }
    const Vector6d quadric = matrix.ldlt().solve(right);
    const Eigen::Vector3d plane = matrix.topLeftCorner<3, 3>().ldlt().solve(right.head<3>());
    for (int f = 0; f < kQuadric; ++f) ASSERT_NEAR(group.quadric[f][k], quadric[f], 2e-5) << k;
    for (int f = 0; f < 3; ++f) ASSERT_NEAR(group.plane[f][k], plane[f], 2e-5) << k;
    // And the closest point on it, turned by the frame.
    ColumnQuadric surface;
    surface.c = group.quadric_at(k);
    const ClosestPoint tilted = closest_point_of(surface);
    for (int a = 0; a < 3; ++a) {
      ASSERT_NEAR(group.normal[a][k],
                  tilted.normal_x * group.u[a][k] + tilted.normal_y * group.w[a][k] +
                      tilted.normal_z * group.n[a][k],
                  1e-6);
    }
    ASSERT_NEAR(group.offset[k], tilted.offset * radius, 1e-5);
  }
}

TEST_P(TiltedFitTest, FitsAskedForTogetherAreThoseAskedForOneByOne) {
  // What the fitter did before, and what stands beside, changes nothing.
  TiltedFitter fitter;
  int found = 0, nothing = 0;
  for_maps([&](const ColumnBits::Windows& columns, int sign) {
    HeightMap map = ask(6, 1, sign);
    map_kernels().trace(&columns, 1, 12, &map);
    std::array<TiltedFit, TiltedGroup::kSize> fits;
    for (std::size_t k = 0; k < fits.size(); ++k) {
      const auto turn = static_cast<float>(k);
      const Vector3f normal =
          Vector3f(0.2f * std::sin(turn), 0.15f * std::cos(3.0f * turn), 1.0f).normalized();
      fits[k] = {&map, normal, 7.6f - 0.7f * turn, {}, {}};
      if (k % 3 == 2) fits[k].side = {0.6f, -0.8f, 1.5f};
    }
    fitter.fit(fits);
    // And fewer than before.
    std::array<TiltedFit, 3> fewer{fits[5], fits[0], fits[2]};
    fitter.fit(fewer);
    const auto expect_alone = [&](const TiltedFit& fit) {
      TiltedFit one = fit;
      one.closest.reset();
      TiltedFitter().fit({&one, 1});
      ASSERT_EQ(one.closest.has_value(), fit.closest.has_value());
      (one.closest ? found : nothing) += 1;
      if (!one.closest) {
        ASSERT_EQ(one.scatter, fit.scatter);
        if (!std::isfinite(one.scatter)) return;
        ASSERT_EQ(one.sagitta, fit.sagitta);
        ASSERT_EQ(one.unexplained.normal_z, fit.unexplained.normal_z);
        ASSERT_EQ(one.unexplained.offset, fit.unexplained.offset);
        return;
      }
      ASSERT_EQ(one.closest->normal_x, fit.closest->normal_x);
      ASSERT_EQ(one.closest->normal_y, fit.closest->normal_y);
      ASSERT_EQ(one.closest->normal_z, fit.closest->normal_z);
      ASSERT_EQ(one.closest->offset, fit.closest->offset);
    };
    for (const TiltedFit& fit : fits) expect_alone(fit);
    for (const TiltedFit& fit : fewer) expect_alone(fit);
  });
  EXPECT_GT(found, 500);
  EXPECT_GT(nothing, 500);
}

/// The map of the voxel below the origin, over a surface of so high above it.
template <class Height>
HeightMap map_over(const Height& height) {
  HeightMap map;
  map.ns = 6;
  map.lanes = lanes_of(map.ns);
  map.height.fill(HeightMap::kNone);
  for (int j = -map.ns; j <= map.ns; ++j) {
    for (int i = -map.ns; i <= map.ns; ++i) {
      map.height[static_cast<std::size_t>(map.place(i, j))] =
          static_cast<signed char>(std::floor(height(i, j)));
    }
  }
  return map;
}

TEST(TiltedFitter, FindsTheBallAndThePlaneThatHeightsAreOf) {
  TiltedFitter fitter;
  double ball_deg = 0.0, plane_deg = 0.0;
  constexpr int kTimes = 60;
  for (int k = 0; k < kTimes; ++k) {
    // 35 degrees down a ball of 20 voxels, about as high as the voxel.
    const double turn = 2.4 * k, radius = 20.0;
    const Eigen::Vector3d normal(0.57 * std::cos(turn), 0.57 * std::sin(turn), 0.82);
    const Eigen::Vector3d closest = Eigen::Vector3d(0.0, 0.0, 0.1 + 0.013 * k);
    const Eigen::Vector3d centre = closest - radius * normal.normalized();
    const HeightMap on_ball = map_over([&](double x, double y) {
      const double across2 = std::pow(x - centre.x(), 2) + std::pow(y - centre.y(), 2);
      return across2 < radius * radius ? centre.z() + std::sqrt(radius * radius - across2) : -30.0;
    });
    const HeightMap on_plane = map_over([&](double x, double y) {
      return closest.z() - (x * normal.x() + y * normal.y()) / normal.z();
    });
    const Vector3f tilt = (normal + Eigen::Vector3d(0.1, -0.05, 0.0)).normalized().cast<float>();
    std::array<TiltedFit, 2> fits{TiltedFit{&on_ball, tilt, 5.8f, {}, {}},
                                  TiltedFit{&on_plane, tilt, 7.6f, {}, {}}};
    fitter.fit(fits);
    for (const TiltedFit& fit : fits) {
      ASSERT_TRUE(fit.closest) << k;
      const Eigen::Vector3d found(fit.closest->normal_x, fit.closest->normal_y,
                                  fit.closest->normal_z);
      EXPECT_NEAR(found.norm(), 1.0, 1e-5);
      const Eigen::Vector3d truth =
          &fit == &fits[0] ? Eigen::Vector3d(-centre) : Eigen::Vector3d(normal);
      (&fit == &fits[0] ? ball_deg : plane_deg) += test::angle_deg(found, truth.normalized());
      const double distance =
          &fit == &fits[0] ? radius - centre.norm() : closest.dot(normal.normalized());
      EXPECT_NEAR(fit.closest->offset, distance, 0.25) << k;
    }
  }
  std::printf("fits in tilted frames: ball %.3f deg, plane %.3f\n", ball_deg / kTimes,
              plane_deg / kTimes);
  EXPECT_LT(ball_deg / kTimes, 1.2);
  EXPECT_LT(plane_deg / kTimes, 0.3);
}

TEST(TiltedFitter, TellsHowWhatItDoesNotExplainScattersAndBends) {
  // A ball of 20 voxels under heights that are up to 0.8 off, evenly: a variance of 0.8^2 / 3 and
  // of the rounding 1 / 12, along the columns.
  constexpr double kRadius = 20.0, kNoise = 0.8;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> off(-kNoise, kNoise);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.2, 0.9).normalized();
  TiltedFitter fitter;
  double scatter = 0.0, sagitta = 0.0, away_deg = 0.0;
  int count = 0;
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d centre = Eigen::Vector3d(0, 0, 0.002 * k) - kRadius * normal;
    const HeightMap map = map_over([&](double x, double y) {
      const double across2 = std::pow(x - centre.x(), 2) + std::pow(y - centre.y(), 2);
      return centre.z() + std::sqrt(kRadius * kRadius - across2) + off(random);
    });
    TiltedFit fit{&map, normal.cast<float>(), 7.6f, {}, {}};
    fitter.fit({&fit, 1});
    if (fit.closest) continue;
    scatter += fit.scatter;
    sagitta += fit.sagitta;
    const ClosestPoint& at = fit.unexplained;
    away_deg += test::angle_deg(Eigen::Vector3d(at.normal_x, at.normal_y, at.normal_z), normal);
    ++count;
  }
  ASSERT_GT(count, 190);
  const double along = (kNoise * kNoise / 3.0 + 1.0 / 12.0) * normal.z() * normal.z();
  EXPECT_NEAR(scatter / count, along, 0.1 * along);
  EXPECT_NEAR(sagitta / count, 7.6 * 7.6 / (2.0 * kRadius), 0.25);  // and what the noise bends
  EXPECT_LT(away_deg / count, 2.0);
}

}  // namespace
}  // namespace sulcus::tilted_fit_test
