#include "engine/graphics/camera.hpp"

#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace sulcus {
namespace {

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

}  // namespace
}  // namespace sulcus
