#include "engine/tool/distance_field.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "engine/core/hash.hpp"

namespace sulcus::distance_field_test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr BurrShape kShapes[] = {BurrShape::kRound, BurrShape::kPear, BurrShape::kFissure,
                                 BurrShape::kInvertedCone, BurrShape::kFlame};

FieldGrid grid_of(const BurrProfile& profile, const Vector3i& samples) {
  const double r = profile.max_radius_m();
  BurrSettings settings;
  settings.field_samples = samples;
  return plan_field(settings, {Vector3d(-r, 0, -r), Vector3d(r, profile.length_m(), r)},
                    profile.head_diameter_m(), 35e-6);
}

BurrProfile profile_of(BurrShape shape) {
  BurrSettings settings;
  settings.shape = shape;
  return make_burr_profile(settings);
}

DistanceField field_of(const BurrProfile& profile, const Vector3i& samples) {
  return field_from_profile(profile, grid_of(profile, samples));
}

double exact(const BurrProfile& profile, const Vector3d& p_tool) {
  return profile.distance(std::hypot(p_tool.x(), p_tool.z()), p_tool.y());
}

TEST(DistanceField, SamplesAreExact) {
  for (const BurrShape shape : kShapes) {
    const BurrProfile profile = profile_of(shape);
    for (const Vector3i& n : {Vector3i(37, 96, 40), Vector3i(40, 50, 40), Vector3i(39, 50, 39)}) {
      const DistanceField field = field_of(profile, n);
      for (int k = 0; k < n.z(); ++k) {
        for (int j = 0; j < n.y(); ++j) {
          for (int i = 0; i < n.x(); ++i) {
            const double d = exact(profile, field.grid().tool_from_field(Vector3d(i, j, k)));
            ASSERT_NEAR(field.at(i, j, k), d, 1e-9);
            ASSERT_EQ(field.sample(Vector3f(Vector3i(i, j, k).cast<float>())), field.at(i, j, k));
          }
        }
      }
    }
  }
}

TEST(DistanceField, FollowsTheSphereOfARoundHead) {
  const BurrProfile profile = profile_of(BurrShape::kRound);
  const DistanceField field = field_of(profile, {64, 256, 64});
  const Vector3d centre(0, 0.7e-3, 0);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int n = 0; n < 20000; ++n) {
    Vector3d out(uniform(random), uniform(random) - 0.5, uniform(random));
    if (out.norm() < 0.1 || out.normalized().y() > 0.3) continue;
    out.normalize();
    const double depth = 0.1e-3 * uniform(random);
    const Vector3d p_tool = centre + (0.7e-3 + depth) * out;
    Vector3f gradient;
    const Vector3f p_field = field.field_from_tool(p_tool).cast<float>();
    const double d = field.sample_with_gradient(p_field, gradient);
    // Trilinear interpolation of a sphere is off by up to h^2 / (4 R) in its two curved directions.
    ASSERT_NEAR(d, depth, 2.0 * field.spacing_m() * field.spacing_m() / (4.0 * 0.6e-3));
    if (std::abs(depth) > 3e-6) {
      ASSERT_EQ(d < 0.0, depth < 0.0);
    }
    ASSERT_NEAR(gradient.norm(), 1.0, 0.03);
    ASSERT_GT(gradient.cast<double>().normalized().dot(out), std::cos(0.05));
  }
}

TEST(DistanceField, SignIsThatOfTheShape) {
  for (const BurrShape shape : kShapes) {
    const BurrProfile profile = profile_of(shape);
    const DistanceField field = field_of(profile, {48, 192, 48});
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    int inside = 0;
    for (int n = 0; n < 20000; ++n) {
      const Vector3d p_field = Vector3d(uniform(random), uniform(random), uniform(random))
                                   .cwiseProduct(field.samples().cast<double>() - Vector3d::Ones());
      const double d = exact(profile, field.grid().tool_from_field(p_field));
      const float sampled = field.sample(p_field.cast<float>());
      // Samples are exact and distances change by no more than the way: interpolation stays within
      // the cell's own size.
      ASSERT_NEAR(sampled, d, field.spacing_m());
      if (std::abs(d) > 0.5 * field.spacing_m()) {
        ASSERT_EQ(sampled < 0.0f, d < 0.0);
      }
      inside += d < 0.0;
    }
    EXPECT_GT(inside, 2000);
  }
}

TEST(DistanceField, GradientIsAboutAUnitNearTheSurface) {
  for (const BurrShape shape : kShapes) {
    const BurrProfile profile = profile_of(shape);
    const DistanceField field = field_of(profile, {64, 256, 64});
    std::vector<double> lengths;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (int n = 0; n < 40000; ++n) {
      const Vector3d p_field = Vector3d(uniform(random), uniform(random), uniform(random))
                                   .cwiseProduct(field.samples().cast<double>() - Vector3d::Ones());
      Vector3f gradient;
      const float d = field.sample_with_gradient(p_field.cast<float>(), gradient);
      if (std::abs(d) < 2.0 * field.spacing_m()) lengths.push_back(gradient.norm());
    }
    ASSERT_GT(lengths.size(), 1000u);
    std::sort(lengths.begin(), lengths.end());
    // All but the edges of the outline. There a component is still the slope between two exact
    // distances, so none is more than 1.
    EXPECT_GT(lengths[lengths.size() / 20], 0.95);
    EXPECT_LT(lengths[lengths.size() * 19 / 20], 1.01);
    EXPECT_LT(lengths.back(), std::sqrt(3.0));
  }
}

FieldGrid plain_grid() { return {{9, 12, 10}, Vector3d(-4e-5, -5e-5, -4.5e-5), 1e-5}; }

DistanceField random_field() {
  DistanceField field(plain_grid());
  std::mt19937 random(4);
  std::uniform_real_distribution<float> uniform(1e-5f, 3e-5f);
  for (int k = 0; k < 10; ++k) {
    for (int j = 0; j < 12; ++j) {
      for (int i = 0; i < 9; ++i) field.kept_at(i, j, k) = uniform(random);
    }
  }
  return field;
}

TEST(DistanceField, ReproducesATrilinearFunction) {
  DistanceField field(plain_grid());
  const auto f = [](const Vector3d& p) {
    return 1e-5 * (1.0 + 0.5 * p.x() - 0.25 * p.y() + 0.125 * p.x() * p.z());
  };
  for (int k = 0; k < 10; ++k) {
    for (int j = 0; j < 12; ++j) {
      for (int i = 0; i < 9; ++i) field.kept_at(i, j, k) = static_cast<float>(f(Vector3d(i, j, k)));
    }
  }
  for (const Vector3d& p : {Vector3d(0.25, 3.5, 8.75), Vector3d(7.99, 0.01, 0.5),
                            Vector3d(8, 11, 9), Vector3d(0, 0, 0), Vector3d(4, 5.5, 6)}) {
    Vector3f gradient;
    EXPECT_NEAR(field.sample_with_gradient(p.cast<float>(), gradient), f(p), 1e-11);
    EXPECT_NEAR(gradient.x(), 0.5 + 0.125 * p.z(), 1e-5);
    EXPECT_NEAR(gradient.y(), -0.25, 1e-5);
    EXPECT_NEAR(gradient.z(), 0.125 * p.x(), 1e-5);
  }
}

TEST(DistanceField, IsContinuousWithTheGradientOfItself) {
  const DistanceField field = random_field();
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-4.0f, 16.0f);
  const float h = 1.0f / 256.0f;
  for (int n = 0; n < 20000; ++n) {
    Vector3f p(uniform(random), uniform(random), uniform(random));
    if (n % 4 == 0) p[n % 3] = std::round(p[n % 3]);  // on faces of cells and of the box
    Vector3f gradient, unused;
    const float value = field.sample_with_gradient(p, gradient);
    const float plain = field.sample(p);
    ASSERT_EQ(std::memcmp(&value, &plain, sizeof value), 0);
    ASSERT_GT(value, 0.0f);
    for (int a = 0; a < 3; ++a) {
      const Vector3f step = h * Vector3f::Unit(a);
      const float up = field.sample_with_gradient(p + step, unused);
      const float down = field.sample(p - step);
      // Values differ by up to 2e-5 m per cell and 1e-5 m per sample outside.
      ASSERT_NEAR(up, value, 3.1e-5 * h);
      ASSERT_NEAR(down, value, 3.1e-5 * h);
      const bool same_cell = std::floor(p[a] - h) == std::floor(p[a] + h);
      if (same_cell) {
        ASSERT_NEAR((up - down) / (2.0f * h * 1e-5f), gradient[a], 0.02f);
      }
    }
  }
}

/// A field with mirrors of values at random, and all of its samples in one without.
std::pair<DistanceField, DistanceField> mirrored_and_whole(const Vector3i& samples) {
  const FieldGrid grid{samples, Vector3d(-4e-5, -5e-5, -4.5e-5), 1e-5};
  DistanceField mirrored(grid, FieldMirrors::kXAndZ), whole(grid);
  std::mt19937 random(6);
  std::uniform_real_distribution<float> uniform(-1e-5f, 3e-5f);
  for (int k = 0; k < samples.z(); ++k) {
    for (int j = 0; j < samples.y(); ++j) {
      for (int i = 0; i < samples.x(); ++i) {
        // Those that come later are images of what is there.
        const int i2 = samples.x() - 1 - i, k2 = samples.z() - 1 - k;
        const bool is_image = i2 < i || k2 < k;
        const float d = is_image ? whole.at(std::min(i, i2), j, std::min(k, k2)) : uniform(random);
        whole.kept_at(i, j, k) = d;
        const Vector3i& kept = mirrored.kept();
        if (i < kept.x() && k < kept.z()) mirrored.kept_at(i, j, k) = d;
      }
    }
  }
  return {std::move(mirrored), std::move(whole)};
}

TEST(DistanceField, WithMirrorsItHasTheBitsOfTheWhole) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(-3.0f, 14.0f);
  // Even and odd, and the fewest that plan_field gives.
  for (const Vector3i& n : {Vector3i(9, 12, 10), Vector3i(10, 8, 9), Vector3i(8, 8, 8)}) {
    const auto [mirrored, whole] = mirrored_and_whole(n);
    EXPECT_EQ(mirrored.kept(), Vector3i(n.x() / 2 + 1, n.y(), n.z() / 2 + 1));
    EXPECT_EQ(whole.kept(), n);
    for (int t = 0; t < 50000; ++t) {
      Vector3f p(uniform(random), uniform(random), uniform(random));
      if (t % 4 == 0) p[t % 3] = std::round(p[t % 3]);  // on faces of cells and of the box
      if (t % 16 == 0) p = p.array().round();
      std::array<Vector3f, 2> gradients;
      const std::array values{mirrored.sample_with_gradient(p, gradients[0]),
                              whole.sample_with_gradient(p, gradients[1]), mirrored.sample(p)};
      ASSERT_EQ(std::bit_cast<std::uint32_t>(values[0]), std::bit_cast<std::uint32_t>(values[1]));
      ASSERT_EQ(std::bit_cast<std::uint32_t>(values[0]), std::bit_cast<std::uint32_t>(values[2]));
      ASSERT_EQ(std::memcmp(gradients[0].data(), gradients[1].data(), sizeof gradients[0]), 0);
    }
    for (int k = 0; k < n.z(); ++k) {
      for (int i = 0; i < n.x(); ++i) ASSERT_EQ(mirrored.at(i, 3, k), whole.at(i, 3, k));
    }
  }
}

TEST(DistanceField, OfAGeneratedBurrItKeepsAQuarter) {
  const DistanceField field = field_of(profile_of(BurrShape::kRound), {128, 512, 128});
  EXPECT_LT(field.memory_bytes(), 0.33 * sizeof(float) * 128 * 512 * 128);
}

TEST(DistanceField, OutsideAddsTheWayToTheBox) {
  const DistanceField field = random_field();
  Vector3f gradient;
  EXPECT_NEAR(field.sample({-3.0f, 4.0f, 5.0f}), field.at(0, 4, 5) + 3e-5, 1e-10);
  EXPECT_NEAR(field.sample_with_gradient({11.0f, 15.0f, 5.0f}, gradient), field.at(8, 11, 5) + 5e-5,
              1e-10);
  EXPECT_NEAR(gradient.x(), 0.6, 1e-6);
  EXPECT_NEAR(gradient.y(), 0.8, 1e-6);
  EXPECT_NEAR(field.sample({4.0f, 5.0f, 1e6f}), 10.0, 1e-3);
}

TEST(DistanceField, WhatIsNotFiniteStaysInBoundsAndNotFinite) {
  const DistanceField field = random_field();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  Vector3f gradient;
  for (const float bad : {nan, inf, -inf}) {
    for (int a = 0; a < 3; ++a) {
      Vector3f p(1.0f, 2.0f, 3.0f);
      p[a] = bad;
      EXPECT_FALSE(std::isfinite(field.sample(p)));
      EXPECT_FALSE(std::isfinite(field.sample_with_gradient(p, gradient)));
    }
  }
}

TEST(DistanceField, NeighbouringRowsFallIntoDifferentCacheSets) {
  const DistanceField field(FieldGrid{{128, 16, 128}, Vector3d::Zero(), 1e-5});
  EXPECT_GE(field.row_pitch(), 128);
  EXPECT_GE(field.slice_pitch(), 16 * field.row_pitch());
  EXPECT_EQ(field.row_pitch() * sizeof(float) % 128, 64u);
  EXPECT_EQ(field.slice_pitch() * sizeof(float) % 128, 64u);
  EXPECT_EQ(field.values().size(), static_cast<std::size_t>(128 * field.slice_pitch()));
}

TEST(DistanceField, HasTheSameBitsOnOneThreadAndEverywhere) {
  std::uint64_t hash[2];
  for (const int threads : {1, 2}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const DistanceField field = field_of(profile_of(BurrShape::kPear), {32, 128, 32});
    std::vector<float> results;
    for (int n = 0; n < 4000; ++n) {
      // Products of small integers and powers of two: exact, so the points are the same everywhere.
      const Vector3f p(static_cast<float>(n % 37) - 2.5f + 0.125f * static_cast<float>(n % 7),
                       static_cast<float>(n % 131) + 0.25f, static_cast<float>(n % 29) + 0.375f);
      Vector3f gradient;
      results.push_back(field.sample_with_gradient(p, gradient));
      results.insert(results.end(), {gradient.x(), gradient.y(), gradient.z()});
    }
    hash[threads - 1] = hash_bytes(results.data(), results.size() * sizeof(float));
  }
  EXPECT_EQ(hash[0], hash[1]);
  EXPECT_EQ(hash[0], 0x121530d1ca3736e8u) << "if the profile was changed on purpose: " << hash[0];
}

}  // namespace
}  // namespace sulcus::distance_field_test
