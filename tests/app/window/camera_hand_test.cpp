#include "app/window/camera_hand.hpp"

#include <gtest/gtest.h>

#include "engine/graphics/view_place.hpp"

namespace sulcus::camera_hand_test {
namespace {

constexpr int kWidth = 640, kHeight = 360;
const Eigen::Vector3d kTip(1e-3, 2e-3, 4e-3);

View view_of(const CameraHand& camera) {
  return make_view(camera.from(), {}, kTip, 0.6e-3, kWidth, kHeight);
}

TEST(CameraHand, WhatIsUnderThePointerStaysThereWhileItComesNearer) {
  const Eigen::Vector2d pointer(0.55, -0.35);
  for (const Camera start : {Camera::kReview, Camera::kOcclusal, Camera::kBurr}) {
    CameraHand camera(start);
    const SightLine line = sight_line(view_of(camera), pointer);
    const Eigen::Vector3d point = line.from_world + 0.7 * line.from_world.norm() * line.way_world;
    double depth = depth_of(view_of(camera), point);
    for (const double notches : {1.0, 2.0, -1.0, 3.0}) {
      camera.zoom(notches, pointer, view_of(camera), kHeight, point);
      const View view = view_of(camera);
      ASSERT_TRUE(place_of(view, point));
      EXPECT_LT((*place_of(view, point) - pointer).norm(), 1e-4);
      EXPECT_EQ(depth_of(view, point) < depth, notches > 0.0);
      depth = depth_of(view, point);
    }
  }
}

TEST(CameraHand, NeverGoesThroughThePointThatItComesNearerTo) {
  CameraHand camera(Camera::kReview);
  const Eigen::Vector3d point(1e-3, -3e-3, 4e-3);
  const Eigen::Vector2d pointer = *place_of(view_of(camera), point);
  for (int notch = 0; notch < 60; ++notch) {
    camera.zoom(1.0, pointer, view_of(camera), kHeight, point);
  }
  const View view = view_of(camera);
  EXPECT_GT(depth_of(view, point), 1e-3);
  EXPECT_LT(depth_of(view, point), 3e-3);
  EXPECT_LT((*place_of(view, point) - pointer).norm(), 1e-3);
}

TEST(CameraHand, OverNothingAPlaceAsDeepAsTheMiddleStays) {
  CameraHand camera(Camera::kBuccal);
  const Eigen::Vector2d pointer(-0.8, 0.6);
  const View before = view_of(camera);
  const LookAt looked = look_at_of(before, kHeight);
  const SightLine line = sight_line(before, pointer);
  const Eigen::Vector3d p =
      line.from_world -
      looked.distance_m / line.way_world.dot(before.back_world.cast<double>()) * line.way_world;
  camera.zoom(4.0, pointer, before, kHeight, {});
  EXPECT_LT((*place_of(view_of(camera), p) - pointer).norm(), 1e-4);
}

TEST(CameraHand, WhatWasGrabbedFollowsThePointer) {
  CameraHand camera(Camera::kReview);
  const Eigen::Vector3d point(2e-3, -3e-3, 4e-3);
  const Eigen::Vector2d before = *place_of(view_of(camera), point), drag(0.3, -0.2);
  for (int part = 0; part < 3; ++part) camera.move(drag / 3.0, view_of(camera), kHeight, point);
  EXPECT_LT((*place_of(view_of(camera), point) - before - drag).norm(), 1e-4);
}

TEST(CameraHand, TurnsAboutWhatItLooksAtAsFarAsItWas) {
  CameraHand camera(Camera::kReview);
  const Eigen::Vector3d point(2e-3, -3e-3, 4e-3);
  for (int notch = 0; notch < 30; ++notch) {
    camera.zoom(1.0, *place_of(view_of(camera), point), view_of(camera), kHeight, point);
  }
  const LookAt before = look_at_of(view_of(camera), kHeight);
  camera.turn({0.4, 0.2});
  const LookAt after = look_at_of(view_of(camera), kHeight);
  EXPECT_LT((after.point_world - before.point_world).norm(), 1e-8);
  EXPECT_NEAR(after.distance_m, before.distance_m, 1e-8);
}

TEST(CameraHand, ANamedCameraIsTakenAnew) {
  CameraHand camera(Camera::kReview);
  camera.zoom(5.0, {0.2, 0.2}, view_of(camera), kHeight, kTip);
  camera.turn({0.4, 0.2});
  camera.take(Camera::kOcclusal);
  const View view = view_of(camera),
             named = make_view(Camera::kOcclusal, {}, kTip, 0.6e-3, kWidth, kHeight);
  EXPECT_LT((view.clip_from_world - named.clip_from_world).norm(),
            1e-5f * named.clip_from_world.norm());
}

}  // namespace
}  // namespace sulcus::camera_hand_test
