#include "engine/graphics/camera.hpp"

#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace sulcus::camera_test {
namespace {

TEST(MakeView, OtherBodiesDoNotChangeTheFrameAndAreNotCutOffInDepth) {
  const Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  auto boxes = [](double x) {
    const Eigen::Vector3d p(x, 0, 0);
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(1e-3);
    return std::vector<Eigen::AlignedBox3d>{{p - half, p + half}};
  };
  auto depth = [](const View& view, const Eigen::Vector3d& p) {  // within -1 to 1: seen
    const Eigen::Vector4f clip = view.clip_from_world * p.cast<float>().homogeneous().eval();
    return clip.z() / clip.w();
  };
  const View alone = make_view(Camera::kMesial, {}, tip, 1e-3, 320, 180);
  const double eye_x = alone.eye_world.x();
  const Eigen::Vector3d far(-0.2, 0, 0);
  const Eigen::Vector3d near(eye_x - 1.1e-3, 0, 0);
  EXPECT_GT(depth(alone, far), 1.0f);
  EXPECT_LT(depth(alone, near), -1.0f);
  const View with_far = make_view(Camera::kMesial, {}, tip, 1e-3, 320, 180, boxes(far.x()));
  EXPECT_LT(depth(with_far, far), 1.0f);
  const View with_near =
      make_view(Camera::kMesial, {}, tip, 1e-3, 320, 180, boxes(near.x() - 1e-3));
  EXPECT_GT(depth(with_near, near), -1.0f);
  for (const View* view : {&with_far, &with_near}) {
    EXPECT_EQ(view->eye_world, alone.eye_world);
    EXPECT_EQ(view->metres_per_pixel, alone.metres_per_pixel);
    EXPECT_EQ(view->clip_from_world.topRows<2>(), alone.clip_from_world.topRows<2>());
  }
  // The eye is in the midst of it: what is left of it is drawn all the same.
  const View within = make_view(Camera::kMesial, {}, tip, 1e-3, 320, 180, boxes(eye_x));
  EXPECT_GT(depth(within, near), -1.0f);
  EXPECT_TRUE(within.clip_from_world.allFinite());
}

TEST(MayBeInFrame, OnlyWhatIsWhollyBeyondASideIsNot) {
  // 2 cm wide and 1 cm high at the origin, seen along -x with +y to the right.
  const View view = make_view(Camera::kMesial, {}, Eigen::Vector3d::Zero(), 1e-3, 400, 200);
  const double half_m = 100.0 * view.metres_per_pixel;  // of the height
  auto shown = [&](double x, double y, double z, double radius) {
    const Eigen::Vector3f p = Eigen::Vector3d(x, y, z).cast<float>();
    const Eigen::Vector3f r = Eigen::Vector3f::Constant(static_cast<float>(radius));
    return may_be_in_frame(view, {p - r, p + r});
  };
  EXPECT_TRUE(shown(0, 0, 0, 1e-3));
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(shown(0, sign * 1.9 * half_m, 0, 1e-4));
    EXPECT_FALSE(shown(0, sign * 2.1 * half_m, 0, 1e-4));
    EXPECT_TRUE(shown(0, sign * 2.1 * half_m, 0, 0.2 * half_m));
    EXPECT_TRUE(shown(0, 0, sign * 0.9 * half_m, 1e-4));
    EXPECT_FALSE(shown(0, 0, sign * 1.1 * half_m, 1e-4));
    EXPECT_TRUE(shown(0, 0, sign * 1.1 * half_m, 0.2 * half_m));
  }
  const double eye_x = view.eye_world.x();
  EXPECT_FALSE(shown(eye_x + 5e-3, 0, 0, 1e-3));  // behind
  EXPECT_TRUE(shown(eye_x, 0, 0, 1e-3));          // round the eye
  EXPECT_TRUE(shown(0, 0, 0, 1.0));
}

TEST(ViewOfMoved, ShowsTheOldPlaceWhereTheBodyIsNow) {
  const View view = make_view(Camera::kReview, {}, Eigen::Vector3d::Zero(), 1e-3, 320, 180);
  Pose moved;
  moved.position = {1e-3, -2e-3, 0.5e-3};
  moved.orientation = Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, -1).normalized());
  const View seen = view_of_moved(view, moved);
  const Eigen::Vector3d start(2e-3, 1e-3, -3e-3);
  const Eigen::Vector3f now = moved.point(start).cast<float>();
  const Eigen::Vector4f clip_start =
      seen.clip_from_world * start.cast<float>().homogeneous().eval();
  const Eigen::Vector4f clip_now = view.clip_from_world * now.homogeneous().eval();
  EXPECT_LT((clip_start - clip_now).norm(), 1e-6f);
  EXPECT_NEAR((seen.eye_world - start.cast<float>()).norm(), (view.eye_world - now).norm(), 1e-7f);
  const Eigen::Vector3f up = moved.direction(seen.up_world.cast<double>()).cast<float>();
  EXPECT_LT((up - view.up_world).norm(), 1e-6f);

  const View same = view_of_moved(view, {});
  EXPECT_EQ(same.clip_from_world, view.clip_from_world);
  EXPECT_EQ(same.eye_world, view.eye_world);
  EXPECT_EQ(same.right_world, view.right_world);
}

TEST(Viewpoint, AnglesGoFromMesialToLingualAndUp) {
  const auto expect_same = [](const Viewpoint& a, const Viewpoint& b) {
    EXPECT_TRUE(a.back_world.isApprox(b.back_world, 1e-12)) << a.back_world.transpose();
    EXPECT_TRUE(a.upright_world.isApprox(b.upright_world, 1e-12)) << a.upright_world.transpose();
  };
  expect_same(Viewpoint(0, 0), Camera::kMesial);
  expect_same(Viewpoint(-90, 0), Camera::kBuccal);
  expect_same(Viewpoint(-90, 90), Camera::kOcclusal);
}

TEST(Viewpoint, ZoomAndPanMoveTheEyeAndNothingElse) {
  const Eigen::Vector3d tip(0, 0, 1);
  const View plain = make_view(Camera::kMesial, {}, tip, 1e-3, 320, 180);
  Viewpoint near(Camera::kMesial);
  near.zoom = 2.0;
  const View zoomed = make_view(near, {}, tip, 1e-3, 320, 180);
  EXPECT_NEAR(zoomed.metres_per_pixel, plain.metres_per_pixel / 2, 1e-12);
  EXPECT_NEAR(zoomed.eye_world.x(), plain.eye_world.x() / 2, 1e-7);
  Viewpoint aside(Camera::kMesial);
  aside.pan = {0.5, 0.0};
  const View panned = make_view(aside, {}, tip, 1e-3, 320, 180);
  // Half of half the frame's height to the right, which from mesial is +y.
  EXPECT_NEAR(panned.eye_world.y(), 0.5 * 90 * plain.metres_per_pixel, 1e-7);
  EXPECT_NEAR(panned.eye_world.x(), plain.eye_world.x(), 1e-7);
}

TEST(Viewpoint, ThePointThatIsAskedForStandsInTheMiddle) {
  const std::vector<Eigen::AlignedBox3d> solid{
      {Eigen::Vector3d(-4e-3, -3e-3, -8e-3), Eigen::Vector3d(4e-3, 3e-3, 4e-3)}};
  const Eigen::Vector3d asked(1.5e-3, -2e-3, 3e-3);
  for (const double zoom : {1.0, 2.0, 30.0}) {
    for (const auto& [azimuth_deg, elevation_deg] :
         {std::pair{-80.0, 20.0}, std::pair{0.0, 90.0}, std::pair{200.0, -35.0}}) {
      Viewpoint from(azimuth_deg, elevation_deg);
      from.zoom = zoom;
      const View about_the_solid = make_view(from, solid, {}, 1e-3, 320, 180);
      from.middle_world = asked;
      const View view = make_view(from, solid, {}, 1e-3, 320, 180);
      const Eigen::Vector4f clip =
          view.clip_from_world * Eigen::Vector3d(asked).cast<float>().homogeneous();
      EXPECT_NEAR(clip.x() / clip.w(), 0.0, 1e-4);
      EXPECT_NEAR(clip.y() / clip.w(), 0.0, 1e-4);
      EXPECT_EQ(view.metres_per_pixel, about_the_solid.metres_per_pixel) << "as large as before";
    }
  }
}

}  // namespace
}  // namespace sulcus::camera_test
