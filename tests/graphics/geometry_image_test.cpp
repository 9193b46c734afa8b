#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "engine/graphics/pinhole.hpp"
#include "engine/graphics/shown_voxel.hpp"
#include "tests/graphics/renderer_fixtures.hpp"

namespace sulcus::geometry_image_test {
namespace {

constexpr int kWidth = 320, kHeight = 180;
constexpr double kVoxel = 1e-4;

/// A ray of a pixel, from the eye; depth along the optical axis is its parameter.
struct Ray {
  Eigen::Vector3d eye, to;  // to: at a depth of 1 m
  Ray(const Pinhole& camera, double u, double v)
      : eye(camera.world_from_camera.topRightCorner<3, 1>()),
        to(camera.point_world(u, v, 1.0) - eye) {}
  Eigen::Vector3d at(double depth_m) const { return eye + depth_m * to; }
};

/// By a plain walk in steps of a fiftieth of a voxel: the first solid voxel, and where the ray
/// enters it.
struct Hit {
  Cell cell;
  double depth_m;
};
std::optional<Hit> first_voxel(const VoxelModel& model, const Ray& ray, double from_m,
                               double to_m) {
  const double step = 0.02 * model.grid.voxel_m / ray.to.norm();
  for (double depth = from_m; depth < to_m; depth += step) {
    const Eigen::Vector3d p = model.grid.index_from_world(ray.at(depth));
    const Cell c = (p.array() + 0.5).floor().cast<int>();
    if (model.grid.contains(c) && model.solid(c)) return Hit{c, depth};
  }
  return {};
}

/// The nearest triangle of the drawn surface that a ray meets from outside.
class Triangles {
 public:
  explicit Triangles(const VoxelModel& model) {
    DrawnSurface surface(model, {{"red", {0.8f, 0.05f, 0.05f}}});
    DrawnSurface::Scratch scratch;
    DrawnMesh mesh;
    for (int brick = 0; brick < surface.brick_count(); ++brick) {
      surface.mesh(brick, scratch, mesh);
      for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        const auto& p = mesh.vertices[mesh.indices[i]].position_m;
        corners_.emplace_back(p[0], p[1], p[2]);
      }
    }
  }
  std::optional<double> depth_m(const Ray& ray) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < corners_.size(); i += 3) {
      const Eigen::Vector3d a = corners_[i + 1] - corners_[i], b = corners_[i + 2] - corners_[i];
      Eigen::Matrix3d m;
      m << a, b, -ray.to;
      if (-a.cross(b).dot(ray.to) <= 0.0) continue;
      const Eigen::Vector3d x = m.inverse() * (ray.eye - corners_[i]);
      if (x.x() < 0.0 || x.y() < 0.0 || x.x() + x.y() > 1.0) continue;
      least = std::min(least, x.z());
    }
    if (std::isinf(least)) return {};
    return least;
  }

 private:
  std::vector<Eigen::Vector3d> corners_;
};

/// The ball with a slot that a burr has cut; two tissues, one above the other.
VoxelModel cut_ball() {
  VoxelModel model = ball();
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LabelBlock labels{};
    for (int place = 0; place < 512; ++place) {
      const Cell c = model.grid.leaf_origin(leaf) + cell_in_leaf(place);
      labels[static_cast<std::size_t>(place)] = c.z() < 37 ? 1 : 0;
      if (std::abs(c.x() - 32) < 5 && c.z() > 34 && model.solid(c)) model.set(c, false);
    }
    tissues->set_block(leaf, labels, model.leaves[leaf]);
  }
  model.tissues = tissues;
  return model;
}

std::unique_ptr<Renderer> renderer_of(const VoxelModel& model,
                                      std::optional<Section> section = {}) {
  RenderSettings settings = small(false);
  settings.section = section;
  std::vector<RenderedBody> bodies;
  bodies.push_back({model, {{"red", {0.8f, 0.05f, 0.05f}}, {"white", {0.9f, 0.9f, 0.9f}}}, {}});
  return std::make_unique<Renderer>(settings, std::move(bodies), tetrahedron(), 1e-3);
}

TEST(GeometryImage, DepthIsThatOfARayThroughTheDrawnSurface) {
  const VoxelModel model = cut_ball();
  const auto renderer = renderer_of(model);
  renderer->set_viewpoint(Viewpoint(-80.0, 50.0));
  const GeometryImage image = renderer->draw_geometry(burr_out_of_sight());
  const Pinhole camera = pinhole_of(renderer->view(), kWidth, kHeight);
  const Triangles triangles(model);
  int met = 0, missed = 0, other = 0;
  for (int v = 3; v < kHeight; v += 7) {
    for (int u = 3; u < kWidth; u += 7) {
      const std::optional<double> depth = triangles.depth_m(Ray(camera, u, v));
      const auto pixel = static_cast<std::size_t>(v * kWidth + u);
      const double drawn = static_cast<double>(image.depth_m[pixel]);
      EXPECT_EQ(drawn == 0.0, image.objects[pixel] == 0);
      if (depth.has_value() != (drawn > 0.0)) {
        ++other;  // within a rounding of an edge
      } else if (depth) {
        EXPECT_NEAR(drawn, *depth, 0.05 * kVoxel) << u << ' ' << v;
        ++met;
      } else {
        ++missed;
      }
    }
  }
  EXPECT_GT(met, 250);
  EXPECT_GT(missed, 300);
  EXPECT_LE(other, 2);
}

/// From a point of index space to the nearest face between a solid voxel and an empty one, in
/// voxels, by a search through all faces near it.
double to_faces(const VoxelModel& model, const Eigen::Vector3d& p) {
  constexpr int kNear = 4;
  const Cell here = (p.array() + 0.5).floor().cast<int>();
  double least = std::numeric_limits<double>::infinity();
  for_each_cell(here - Cell::Constant(kNear), here + Cell::Constant(kNear + 1), [&](const Cell& c) {
    if (!model.grid.contains(c) || !model.solid(c)) return;
    for (int side = 0; side < 6; ++side) {
      Cell beside = c;
      beside[side / 2] += side % 2 == 0 ? -1 : 1;
      if (model.grid.contains(beside) && model.solid(beside)) continue;
      Eigen::Vector3d on_face = p.cwiseMax(c.cast<double>() - Eigen::Vector3d::Constant(0.5))
                                    .cwiseMin(c.cast<double>() + Eigen::Vector3d::Constant(0.5));
      on_face[side / 2] = 0.5 * (c[side / 2] + beside[side / 2]);
      least = std::min(least, (p - on_face).norm());
    }
  });
  return least;
}

TEST(GeometryImage, WhatIsSeenLiesHalfAVoxelFromTheVoxelsFaces) {
  const VoxelModel model = cut_ball();
  const auto renderer = renderer_of(model);
  renderer->set_viewpoint(Viewpoint(-80.0, 50.0));
  const GeometryImage image = renderer->draw_geometry(burr_out_of_sight());
  const Pinhole camera = pinhole_of(renderer->view(), kWidth, kHeight);
  int met = 0, off = 0;
  double farthest = 0.0;
  for (int v = 1; v < kHeight; v += 3) {
    for (int u = 1; u < kWidth; u += 3) {
      const auto pixel = static_cast<std::size_t>(v * kWidth + u);
      if (image.objects[pixel] == 0) continue;
      ++met;
      const Eigen::Vector3d p = camera.point_world(u, v, static_cast<double>(image.depth_m[pixel]));
      const double away = to_faces(model, model.grid.index_from_world(p));
      if (away > 0.5) ++off;
      farthest = std::max(farthest, away);
    }
  }
  EXPECT_GT(met, 1000);
  // Sharp rims of the slot are rounded a little more.
  EXPECT_LE(off, met / 200) << "of " << met;
  EXPECT_LE(farthest, 0.6) << "voxels";
}

TEST(GeometryImage, DepthIsThatOfTheBallToHalfAVoxel) {
  constexpr double kRadius = 2.6e-3;  // of what the voxels are made of
  const VoxelModel model = ball();
  const auto renderer = renderer_of(model);
  renderer->set_viewpoint(Viewpoint(-80.0, 50.0));
  const GeometryImage image = renderer->draw_geometry(burr_out_of_sight());
  const Pinhole camera = pinhole_of(renderer->view(), kWidth, kHeight);
  int met = 0, stepped = 0;
  for (int v = 1; v < kHeight; v += 3) {
    for (int u = 1; u < kWidth; u += 3) {
      const auto pixel = static_cast<std::size_t>(v * kWidth + u);
      const Ray ray(camera, u, v);
      const double a = ray.to.squaredNorm(), b = ray.to.dot(ray.eye);
      const double root = b * b - a * (ray.eye.squaredNorm() - kRadius * kRadius);
      if (root <= 0.0 || image.objects[pixel] == 0) continue;
      const double depth = (-b - std::sqrt(root)) / a;
      const double facing = ray.to.normalized().dot(-ray.at(depth).normalized());
      if (facing < 0.4) continue;  // near the outline a depth says little of the surface
      ++met;
      const double drawn = static_cast<double>(image.depth_m[pixel]);
      const double along = kVoxel / ray.to.norm() / facing;
      EXPECT_LE(std::abs(drawn - depth), 0.5 * along) << u << ' ' << v;
      // The staircase of voxels round it goes out and in by half the diagonal of one.
      const auto hit = first_voxel(model, ray, drawn - 20 * kVoxel, drawn + 20 * kVoxel);
      ASSERT_TRUE(hit);
      EXPECT_LE(std::abs(hit->depth_m - drawn), std::sqrt(0.75) * along + 0.02 * kVoxel);
      if (std::abs(hit->depth_m - drawn) > 0.5 * along) ++stepped;
    }
  }
  EXPECT_GT(met, 1000);
  EXPECT_LE(stepped, met / 20) << "of " << met;
}

TEST(GeometryImage, APixelShowsTheVoxelThatARayMeets) {
  const VoxelModel model = cut_ball();
  const auto renderer = renderer_of(model);
  renderer->set_viewpoint(Viewpoint(-80.0, 50.0));
  const GeometryImage image = renderer->draw_geometry(burr_out_of_sight());
  const std::vector<std::uint32_t> voxels = shown_voxels(*renderer, image, {});
  const Pinhole camera = pinhole_of(renderer->view(), kWidth, kHeight);
  int met = 0, other_tissue = 0, near_border = 0, rims = 0;
  for (int v = 1; v < kHeight; v += 3) {
    for (int u = 1; u < kWidth; u += 3) {
      const auto pixel = static_cast<std::size_t>(v * kWidth + u);
      EXPECT_EQ(voxels[pixel] == kNoVoxel, image.objects[pixel] == 0) << u << ' ' << v;
      if (voxels[pixel] == kNoVoxel) continue;
      const double drawn = static_cast<double>(image.depth_m[pixel]);
      const auto hit =
          first_voxel(model, Ray(camera, u, v), drawn - 20 * kVoxel, drawn + 20 * kVoxel);
      // The rim of the slot, which is rounded, stops a ray that passes over it as it is drawn.
      if (!hit || std::abs(hit->depth_m - drawn) > 2.0 * kVoxel) {
        ++rims;
        continue;
      }
      ++met;
      const Cell shown = model.grid.cell_of_linear(voxels[pixel]);
      EXPECT_TRUE(model.solid(shown));
      // Tissues meet between z of 36 and 37.
      if (std::abs(hit->cell.z() - 36.5) < 2.0) {
        ++near_border;
      } else if (model.tissue(shown) != model.tissue(hit->cell)) {
        ++other_tissue;
      }
    }
  }
  EXPECT_GT(met, 1200);
  EXPECT_LT(near_border, met / 4);
  EXPECT_LE(rims, met / 20);
  EXPECT_EQ(other_tissue, 0) << "of " << met;
}

TEST(GeometryImage, OfAPairDisparityIsFocalLengthTimesBaselineByDepth) {
  const auto renderer = renderer_of(cut_ball());
  const FrameState state = burr_out_of_sight();
  constexpr double kBaseline = 1.5e-3;
  const GeometryImage left = renderer->draw_geometry(state);
  const Pinhole camera = pinhole_of(renderer->view(), kWidth, kHeight);
  renderer->set_eye_offset(kBaseline);
  const GeometryImage right = renderer->draw_geometry(state);
  const Pinhole other = pinhole_of(renderer->view(), kWidth, kHeight);
  const Eigen::Matrix4d apart = other.world_from_camera - camera.world_from_camera;
  EXPECT_NEAR(apart.col(3).norm(), kBaseline, 1e-8);
  EXPECT_EQ(other.focal_pixels, camera.focal_pixels);
  int matched = 0, seen = 0;
  for (int v = 0; v < kHeight; v += 2) {
    for (int u = 0; u < kWidth; u += 2) {
      const auto pixel = static_cast<std::size_t>(v * kWidth + u);
      if (left.objects[pixel] == 0) continue;
      const double depth = static_cast<double>(left.depth_m[pixel]);
      const double at = u - camera.focal_pixels * kBaseline / depth;
      const int low = static_cast<int>(std::floor(at));
      if (low < 0 || low + 1 >= kWidth) continue;
      const auto there = static_cast<std::size_t>(v * kWidth + low);
      if (right.objects[there] == 0 || right.objects[there + 1] == 0) continue;
      ++seen;
      // The same row and the same depth, between two pixels: the same point, unless it is hidden.
      const double part = at - low;
      const double depth_there = (1 - part) * static_cast<double>(right.depth_m[there]) +
                                 part * static_cast<double>(right.depth_m[there + 1]);
      if (std::abs(depth_there - depth) < 0.25 * kVoxel) ++matched;
    }
  }
  EXPECT_GT(seen, 1500);
  EXPECT_GT(matched, seen * 9 / 10);
}

TEST(GeometryImage, TheFaceOfASectionLiesInItsPlaneAndLooksOut) {
  constexpr double kAt = 0.53e-3;
  const auto renderer = renderer_of(cut_ball(), Section{1, kAt});
  renderer->set_viewpoint(Viewpoint(-80.0, 20.0));
  const GeometryImage image = renderer->draw_geometry(burr_out_of_sight());
  const Pinhole camera = pinhole_of(renderer->view(), kWidth, kHeight);
  int faces = 0;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const auto pixel = static_cast<std::size_t>(v * kWidth + u);
      if (image.objects[pixel] == 0) continue;
      const Eigen::Vector3d p = camera.point_world(u, v, static_cast<double>(image.depth_m[pixel]));
      EXPECT_GT(p.y(), kAt - 1e-7);
      if (image.object(pixel) != ShownObject::section_face(0)) continue;
      ++faces;
      ASSERT_NEAR(p.y(), kAt, 1e-8);
      const Eigen::Vector3d n = camera.world_from_camera.topLeftCorner<3, 3>() *
                                Eigen::Vector3f(image.normal_camera[pixel].data()).cast<double>();
      ASSERT_NEAR(n.y(), -1.0, 1e-5);
    }
  }
  EXPECT_GT(faces, 2000);
}

TEST(GeometryImage, NormalsOfABallPointAwayFromItsMiddle) {
  const auto renderer = renderer_of(ball());
  const GeometryImage image = renderer->draw_geometry(burr_out_of_sight());
  const Pinhole camera = pinhole_of(renderer->view(), kWidth, kHeight);
  double sum_deg = 0.0;
  int count = 0;
  for (int v = 0; v < kHeight; v += 3) {
    for (int u = 0; u < kWidth; u += 3) {
      const auto pixel = static_cast<std::size_t>(v * kWidth + u);
      if (image.objects[pixel] == 0) continue;
      const Eigen::Vector3d n = camera.world_from_camera.topLeftCorner<3, 3>() *
                                Eigen::Vector3f(image.normal_camera[pixel].data()).cast<double>();
      const Eigen::Vector3d p = camera.point_world(u, v, static_cast<double>(image.depth_m[pixel]));
      sum_deg += std::acos(std::clamp(n.dot(p.normalized()), -1.0, 1.0)) * 57.29578;
      ++count;
    }
  }
  ASSERT_GT(count, 500);
  EXPECT_LT(sum_deg / count, 2.0);
}

TEST(GeometryImage, TheBurrIsThereOnlyWhereItIsShown) {
  const auto renderer = renderer_of(ball());
  renderer->set_viewpoint(Viewpoint(-80.0, 20.0));
  FrameState state;
  state.world_from_tool.position = {0, -2e-3, 2.7e-3};
  const auto burr_pixels = [&] {
    const GeometryImage image = renderer->draw_geometry(state);
    return std::ranges::count(
        image.objects, static_cast<std::uint32_t>(ShownObject{ShownObject::Kind::kBurr}.code()));
  };
  EXPECT_GT(burr_pixels(), 20);
  state.burr_shown = false;
  EXPECT_EQ(burr_pixels(), 0);
}

TEST(GeometryImage, PicturesAreTheSameWithItBetweenThem) {
  const auto renderer = renderer_of(ball());
  const auto other = renderer_of(ball());
  FrameState state = burr_out_of_sight();
  std::vector<std::uint32_t> cut;
  const VoxelGrid grid = ball().grid;
  for (std::uint32_t v = 0; v < grid.cell_count(); ++v) {
    if (grid.centre_world(grid.cell_of_linear(v)).x() > 1.8e-3) cut.push_back(v);
  }
  (void)renderer->draw(state);
  (void)other->draw(state);
  renderer->remove(0, cut);
  other->remove(0, cut);
  (void)renderer->draw_geometry(state);
  EXPECT_EQ(renderer->draw(state), other->draw(state));
}

}  // namespace
}  // namespace sulcus::geometry_image_test
