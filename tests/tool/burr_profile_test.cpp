#include "engine/tool/burr_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"

namespace sulcus::burr_profile_test {
namespace {

using Eigen::Vector2d;

constexpr BurrShape kShapes[] = {BurrShape::kRound, BurrShape::kPear, BurrShape::kFissure,
                                 BurrShape::kInvertedCone, BurrShape::kFlame};

BurrSettings settings_of(BurrShape shape, double diameter_mm = 1.4) {
  BurrSettings settings;
  settings.shape = shape;
  settings.diameter_m = diameter_mm * kMillimetre;
  return settings;
}

std::string error_of(const BurrSettings& settings) {
  try {
    make_burr_profile(settings, "scene.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// Points along the whole outline, independent of the distance code.
std::vector<Vector2d> dense_outline(const BurrProfile& profile, int per_piece) {
  std::vector<Vector2d> points;
  for (const ProfilePiece& piece : profile.pieces()) {
    for (int s = 0; s <= per_piece; ++s) {
      Vector2d p = piece.start + (piece.end - piece.start) * (static_cast<double>(s) / per_piece);
      // The chord's point seen from the centre, out to the arc.
      if (piece.radius > 0.0) {
        p = piece.centre + (p - piece.centre).normalized() * piece.radius;
      }
      points.push_back(p);
    }
  }
  return points;
}

void expect_well_formed(const BurrProfile& profile, double diameter) {
  Vector2d at = Vector2d::Zero();
  double head_radius = 0.0;
  for (const ProfilePiece& piece : profile.pieces()) {
    EXPECT_LT((piece.start - at).norm(), 1e-12) << "pieces join";
    EXPECT_GE(piece.end.y(), piece.start.y() - 1e-12) << "y never falls";
    EXPECT_GE(piece.end.x(), 0.0);
    if (piece.radius > 0.0) {
      EXPECT_NEAR((piece.start - piece.centre).norm(), piece.radius, 1e-12);
      EXPECT_NEAR((piece.end - piece.centre).norm(), piece.radius, 1e-12);
    }
    at = piece.end;
  }
  EXPECT_NEAR(at.x(), 0.0, 1e-12) << "ends on the axis";
  for (int s = 0; s <= 1000; ++s) {
    head_radius = std::max(head_radius, profile.radius_at(profile.head_length_m() * s / 1000.0));
  }
  EXPECT_NEAR(head_radius, 0.5 * diameter, 1e-3 * diameter);
  EXPECT_NEAR(profile.radius_at(0.999 * profile.length_m()), 0.5 * kShankDiameter, 1e-12);
  EXPECT_GT(profile.length_m(), profile.head_length_m() + 2e-3);
}

TEST(BurrProfile, EveryShapeIsWellFormedAtEverySize) {
  for (const BurrShape shape : kShapes) {
    for (const double mm : {0.3, 0.8, 1.4, 1.6, 2.3, 5.0}) {
      SCOPED_TRACE(testing::Message() << "shape " << static_cast<int>(shape) << ", " << mm);
      expect_well_formed(make_burr_profile(settings_of(shape, mm)), mm * kMillimetre);
    }
  }
}

TEST(BurrProfile, LengthOverridesTheRatio) {
  const double ratios[][2] = {{0.75, 0.98}, {1.1, 5.0}, {0.5, 8.0}, {0.5, 3.0}, {1.5, 10.0}};
  for (const BurrShape shape : kShapes) {
    for (const double mm : {0.3, 1.4, 5.0}) {
      for (const double ratio : ratios[static_cast<int>(shape)]) {
        SCOPED_TRACE(testing::Message() << "shape " << static_cast<int>(shape) << ", " << mm
                                        << " mm, ratio " << ratio);
        BurrSettings settings = settings_of(shape, mm);
        settings.length_m = ratio * settings.diameter_m;
        const BurrProfile profile = make_burr_profile(settings);
        EXPECT_DOUBLE_EQ(profile.head_length_m(), *settings.length_m);
        expect_well_formed(profile, settings.diameter_m);
      }
    }
  }
}

TEST(BurrProfile, DefaultFillsItsSamplesEvenly) {
  for (const BurrShape shape : kShapes) {
    const BurrProfile profile = make_burr_profile(settings_of(shape));
    EXPECT_GE(profile.length_m(), 6e-3);
    EXPECT_LE(profile.length_m(), 8e-3);
  }
}

TEST(BurrProfile, RoundHeadIsASphere) {
  const double radius = 0.7e-3;
  const BurrProfile profile = make_burr_profile(settings_of(BurrShape::kRound));
  for (double angle = 0.0; angle < 2.0; angle += 0.1) {  // from the tip to above the equator
    for (const double from_centre : {0.3e-3, 0.69e-3, 0.7e-3, 0.9e-3}) {
      const Vector2d out(std::sin(angle), -std::cos(angle));
      const Vector2d p = Vector2d(0.0, radius) + from_centre * out;
      const ProfileDistance d = profile.distance_and_normal(p.x(), p.y());
      EXPECT_NEAR(d.distance, from_centre - radius, 1e-12);
      EXPECT_DOUBLE_EQ(profile.distance(p.x(), p.y()), d.distance);
      EXPECT_LT((d.normal - out).norm(), 1e-9);
    }
  }
}

TEST(BurrProfile, DistanceAndSignAgreeWithADenseOutline) {
  for (const BurrShape shape : kShapes) {
    const BurrProfile profile = make_burr_profile(settings_of(shape));
    const std::vector<Vector2d> outline = dense_outline(profile, 400);
    const double step = profile.length_m() / 400;
    for (double y = -0.5e-3; y < profile.length_m() + 0.5e-3; y += 0.217e-3) {
      for (double r = 0.0; r < 1.4e-3; r += 0.0613e-3) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Vector2d& q : outline) nearest = std::min(nearest, (q - Vector2d(r, y)).norm());
        const double d = profile.distance(r, y);
        EXPECT_LE(std::abs(d), nearest + 1e-12);
        EXPECT_GE(std::abs(d), nearest - 0.5 * step);
        EXPECT_EQ(d < 0.0, r < profile.radius_at(y)) << r << ", " << y;
      }
    }
  }
}

TEST(BurrProfile, NormalIsTheGradientOfTheDistance) {
  for (const BurrShape shape : kShapes) {
    const BurrProfile profile = make_burr_profile(settings_of(shape));
    const double h = 1e-8;
    int compared = 0;
    for (double y = -0.4e-3; y < profile.length_m() + 0.4e-3; y += 0.0917e-3) {
      for (double r = 0.01e-3; r < 1.2e-3; r += 0.0413e-3) {
        const Vector2d n = profile.distance_and_normal(r, y).normal;
        const Vector2d g((profile.distance(r + h, y) - profile.distance(r - h, y)) / (2 * h),
                         (profile.distance(r, y + h) - profile.distance(r, y - h)) / (2 * h));
        if (std::abs(g.norm() - 1.0) > 1e-4) continue;  // across the medial curve
        EXPECT_LT((n - g).norm(), 1e-3)
            << "shape " << static_cast<int>(shape) << " at " << r << ", " << y;
        ++compared;
      }
    }
    EXPECT_GT(compared, 1500);
  }
}

TEST(BurrProfile, NormalsOnTheOutlinePointOut) {
  for (const BurrShape shape : kShapes) {
    const BurrProfile profile = make_burr_profile(settings_of(shape));
    for (const Vector2d& p : dense_outline(profile, 37)) {
      const Vector2d n = profile.distance_and_normal(p.x(), p.y()).normal;
      EXPECT_NEAR(n.norm(), 1.0, 1e-9);
      const Vector2d out = p + 1e-7 * n;
      if (out.x() >= 0.0) {
        EXPECT_GT(profile.distance(out.x(), out.y()), 0.0);
      }
    }
  }
}

TEST(BurrProfile, VolumeIsTheIntegralOfItsRadius) {
  for (const BurrShape shape : kShapes) {
    const BurrProfile profile = make_burr_profile(settings_of(shape));
    constexpr int kSteps = 20000;
    double sum = 0.0;
    for (int s = 0; s < kSteps; ++s) {
      const double r = profile.radius_at(profile.length_m() * (s + 0.5) / kSteps);
      sum += std::numbers::pi * r * r * profile.length_m() / kSteps;
    }
    EXPECT_NEAR(profile.volume_m3() / sum, 1.0, 1e-4);
  }
}

TEST(BurrProfile, RefusesSizesThatAreNotABurrs) {
  for (const double mm : {0.29, 5.1, -1.0, std::numeric_limits<double>::quiet_NaN(),
                          std::numeric_limits<double>::infinity()}) {
    const std::string error = error_of(settings_of(BurrShape::kRound, mm));
    EXPECT_NE(error.find("scene.toml: burr.diameter_mm: found "), std::string::npos) << error;
    EXPECT_NE(error.find("expected 0.3 mm to 5 mm"), std::string::npos) << error;
  }
  for (const BurrShape shape : kShapes) {
    for (const double mm : {0.1, 40.0, std::numeric_limits<double>::quiet_NaN()}) {
      BurrSettings settings = settings_of(shape);
      settings.length_m = mm * kMillimetre;
      const std::string error = error_of(settings);
      EXPECT_NE(error.find("scene.toml: burr.length_mm: found "), std::string::npos) << error;
    }
  }
}

}  // namespace
}  // namespace sulcus::burr_profile_test
