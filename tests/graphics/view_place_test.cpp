#include "engine/graphics/view_place.hpp"

#include <cmath>
#include <map>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "engine/core/units.hpp"
#include "engine/graphics/mirror.hpp"
#include "engine/graphics/overlay.hpp"

namespace sulcus::view_place_test {
namespace {

constexpr int kWidth = 640, kHeight = 360;
constexpr double kAspect = static_cast<double>(kWidth) / kHeight;

View view_from(const Viewpoint& from) {
  return make_view(from, {}, Eigen::Vector3d::Zero(), 1e-3, kWidth, kHeight);
}

/// As OpenGL has it: the matrix that the pictures are drawn with.
Eigen::Vector2d drawn_at(const View& view, const Eigen::Vector3d& p) {
  const Eigen::Vector4d clip = view.clip_from_world.cast<double>() * p.homogeneous().eval();
  return {kAspect * clip.x() / clip.w(), clip.y() / clip.w()};
}

TEST(ViewPlace, APlaceAndItsLineOfSightAreWhatTheMatrixOfThePictureSays) {
  for (const Viewpoint& from : {Viewpoint(Camera::kReview), Viewpoint(33.0, -20.0)}) {
    const View view = view_from(from);
    for (const Eigen::Vector2d& place :
         {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.7, -0.4), Eigen::Vector2d(-1.6, 0.9)}) {
      const SightLine line = sight_line(view, place);
      EXPECT_NEAR(line.way_world.norm(), 1.0, 1e-12);
      for (const double away : {0.01, 0.05}) {
        const Eigen::Vector3d p = line.from_world + away * line.way_world;
        EXPECT_LT((drawn_at(view, p) - place).norm(), 1e-4);
        ASSERT_TRUE(place_of(view, p));
        EXPECT_LT((*place_of(view, p) - place).norm(), 1e-6);
      }
      EXPECT_FALSE(place_of(view, line.from_world - 0.01 * line.way_world)) << "behind the eye";
    }
  }
}

TEST(ViewPlace, ACameraLooksAtWhatItIsToldFromAsFarAsItIsTold) {
  Viewpoint from(40.0, 25.0);
  from.look_at = LookAt{{1e-3, -2e-3, 3e-3}, 8e-3};
  const View view = view_from(from);
  EXPECT_LT(drawn_at(view, from.look_at->point_world).norm(), 1e-5);
  EXPECT_NEAR((view.eye_world.cast<double>() - from.look_at->point_world).norm(), 8e-3, 1e-8);
  // And says so.
  const LookAt again = look_at_of(view, kHeight);
  EXPECT_LT((again.point_world - from.look_at->point_world).norm(), 1e-8);
  EXPECT_NEAR(again.distance_m, 8e-3, 1e-8);
}

TEST(Mirror, ShowsWhatAPlaneMirrorBehindTheToothShows) {
  const double azimuth = 25.0, elevation = 15.0;
  Viewpoint from(azimuth, elevation);
  from.look_at = LookAt{{0.5e-3, 1e-3, 2e-3}, 40e-3};
  const View direct = view_from(from);
  const View in_mirror = mirrored(view_from(mirror_viewpoint(from, azimuth, elevation)));
  // The plane through what is looked at, across the level part of the line of sight.
  const Eigen::Vector3d normal(std::cos(azimuth * kDegree), std::sin(azimuth * kDegree), 0.0);
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(3e-3, 0, 0), Eigen::Vector3d(0, -4e-3, 5e-3),
                                   Eigen::Vector3d(-2e-3, 2e-3, -3e-3)}) {
    const Eigen::Vector3d image = p - 2.0 * normal.dot(p - from.look_at->point_world) * normal;
    EXPECT_LT((drawn_at(in_mirror, p) - drawn_at(direct, image)).norm(), 1e-4);
  }
}

std::map<std::string, Eigen::Vector2d> letters_from(const Viewpoint& from) {
  std::map<std::string, Eigen::Vector2d> places;
  const WindowMargins margins{.left = 36.0f, .right = 18.0f, .top = 9.0f, .bottom = 27.0f};
  for (const Overlay::Words& letter : side_letters(view_from(from), kAspect, kHeight, margins)) {
    places[letter.words] = letter.place;
  }
  return places;
}

TEST(SideLetters, StandAtTheEdgesOnTheirSidesOfTheTooth) {
  // From above, lingual is up: mesial is to the right then.
  const auto above = letters_from(Camera::kOcclusal);
  ASSERT_EQ(above.size(), 4u);
  EXPECT_LT((above.at("M") - Eigen::Vector2d(kAspect - 0.1, 0.0)).norm(), 1e-6);
  EXPECT_LT((above.at("D") - Eigen::Vector2d(-kAspect + 0.2, 0.0)).norm(), 1e-6);
  EXPECT_LT((above.at("L") - Eigen::Vector2d(0.0, 1.0 - 0.05)).norm(), 1e-6);
  EXPECT_LT((above.at("B") - Eigen::Vector2d(0.0, -1.0 + 0.15)).norm(), 1e-6);
  // From a side its own letter and the opposite one have no place.
  const auto buccal = letters_from(Camera::kBuccal);
  EXPECT_EQ(buccal.size(), 2u);
  EXPECT_GT(buccal.at("M").x(), 0.0);
  const auto lingual = letters_from(Viewpoint(90.0, 0.0));
  EXPECT_LT(lingual.at("M").x(), 0.0);
  const auto mesial = letters_from(Camera::kMesial);
  EXPECT_GT(mesial.at("L").x(), 0.0);
  EXPECT_LT(mesial.at("B").x(), 0.0);
}

}  // namespace
}  // namespace sulcus::view_place_test
