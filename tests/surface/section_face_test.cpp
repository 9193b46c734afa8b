#include "engine/surface/section_face.hpp"

#include <gtest/gtest.h>

namespace sulcus::section_face_test {
namespace {

/// A box of 24 x 32 x 40 voxels, centred in its grid, of two tissues that meet at z = 0.
DrawnSurface box() {
  VoxelModel model;
  model.grid = {{48, 48, 48}, 1e-4};
  model.leaves.resize(model.grid.leaf_count());
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LabelBlock labels{};
    for (int v = 0; v < 512; ++v) {
      const Cell c = model.grid.leaf_origin(leaf) + Cell(v & 7, v >> 3 & 7, v >> 6);
      const Cell from_middle = (2 * c - Cell::Constant(47)).cwiseAbs();
      if ((from_middle.array() < Cell(24, 32, 40).array()).all()) model.set(c, true);
      labels[v] = c.z() >= 24 ? 1 : 0;
    }
    tissues->set_block(leaf, labels, model.leaves[leaf]);
  }
  model.tissues = tissues;
  return {std::move(model), {{"red", {1, 0, 0}}, {"blue", {0, 0, 1}}}};
}

std::size_t solid_pixels(const SectionFace& face) {
  std::size_t count = 0;
  for (const auto& pixel : face.pixels) count += pixel[3] >= 128 ? 1u : 0u;
  return count;
}

constexpr std::size_t kCorners = 4;  // that the smoothing takes off a rectangle

TEST(SectionFace, IsAsLargeAsTheBodyThereAndHasItsTissues) {
  const SectionFace face = section_face(box(), {}, {1, 0.4e-3});
  ASSERT_EQ(face.width, 48);  // along z, across x: the axes after y
  ASSERT_EQ(face.height, 48);
  EXPECT_EQ(solid_pixels(face), 24u * 40 - kCorners);
  EXPECT_NEAR(face.corner_world.y(), 0.4e-3, 1e-12);
  EXPECT_NEAR(face.along_world.z(), 4.8e-3, 1e-9);
  const auto at = [&](int z, int x) { return face.pixels[static_cast<std::size_t>(48 * x + z)]; };
  EXPECT_EQ(at(12, 24), (std::array<std::uint8_t, 4>{255, 0, 0, 255}));
  EXPECT_EQ(at(36, 24), (std::array<std::uint8_t, 4>{0, 0, 255, 255}));
  EXPECT_EQ(at(1, 24)[3], 0);
}

TEST(SectionFace, FollowsWhatIsCutAndWhereTheBodyStands) {
  DrawnSurface body = box();
  std::vector<std::uint32_t> slab;
  for (int x = 0; x < 48; ++x) {
    for (int y = 0; y < 48; ++y) {
      for (int z = 24; z < 48; ++z) slab.push_back(body.model().grid.linear({x, y, z}));
    }
  }
  body.remove(slab);
  EXPECT_EQ(solid_pixels(section_face(body, {}, {1, 0.0})), 24u * 20 - kCorners);
  Pose moved;
  moved.position.y() = 10e-3;
  EXPECT_TRUE(section_face(body, moved, {1, 0.0}).pixels.empty());
  EXPECT_EQ(solid_pixels(section_face(body, moved, {1, 10e-3})), 24u * 20 - kCorners);
  // Turned by a quarter about x its z points along -y.
  Pose turned;
  turned.orientation = Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX());
  EXPECT_EQ(solid_pixels(section_face(body, turned, {2, 0.0})), 24u * 20 - kCorners);
}

}  // namespace
}  // namespace sulcus::section_face_test
