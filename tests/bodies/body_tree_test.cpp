#include "engine/bodies/body_tree.hpp"

#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/allocation_count.hpp"

namespace sulcus {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

Vector3d random_point(std::mt19937& random) {
  Vector3d p;
  for (int a = 0; a < 3; ++a) p[a] = static_cast<double>(random() % 2001) * 1e-5 - 0.01;  // +-10 mm
  return p;
}

AlignedBox3d random_box(std::mt19937& random, double half_m) {
  const Vector3d centre = random_point(random), half = Vector3d::Constant(half_m);
  return {centre - half, centre + half};
}

std::vector<AlignedBox3d> random_boxes(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<AlignedBox3d> boxes;
  for (std::size_t i = 0; i < count; ++i) boxes.push_back(random_box(random, 3e-3));
  return boxes;
}

std::vector<std::uint16_t> meeting(std::span<const AlignedBox3d> boxes, const AlignedBox3d& query) {
  std::vector<std::uint16_t> found;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].intersects(query)) found.push_back(static_cast<std::uint16_t>(i));
  }
  return found;
}

TEST(BodyTree, FindsExactlyTheBodiesThatABoxMeetsInOrder) {
  const std::vector<AlignedBox3d> boxes = random_boxes(16, 1);
  const BodyTree tree(boxes);
  std::mt19937 random(2);
  std::array<std::size_t, 17> sizes{};
  for (int q = 0; q < 2000; ++q) {
    const AlignedBox3d query = random_box(random, 2e-3);
    std::array<std::uint16_t, 16> found{};
    const std::size_t count = tree.find(query, found);
    const std::vector<std::uint16_t> expected = meeting(boxes, query);
    ASSERT_EQ(std::vector(found.begin(), found.begin() + count), expected);
    ++sizes[count];
  }
  EXPECT_GT(sizes[0], 0u);
  EXPECT_GT(sizes[1], 0u);
  EXPECT_GT(sizes[2], 0u);
}

TEST(BodyTree, BoxesThatTouchMeet) {
  const AlignedBox3d body(Vector3d(0, 0, 0), Vector3d(1, 1, 1));
  const BodyTree tree(std::span(&body, 1));
  std::array<std::uint16_t, 1> found{};
  EXPECT_EQ(tree.find({Vector3d(1, 0, 0), Vector3d(2, 1, 1)}, found), 1u);
  EXPECT_EQ(tree.find({Vector3d(1.0000001, 0, 0), Vector3d(2, 1, 1)}, found), 0u);
}

TEST(BodyTree, WithoutBodiesFindsNone) {
  const BodyTree tree({});
  std::array<std::uint16_t, 4> found{};
  EXPECT_EQ(tree.find({Vector3d(-1, -1, -1), Vector3d(1, 1, 1)}, found), 0u);
}

TEST(BodyTree, WritesNoMoreThanThereIsRoomFor) {
  const std::vector<AlignedBox3d> boxes(16, AlignedBox3d(Vector3d(0, 0, 0), Vector3d(1, 1, 1)));
  const BodyTree tree(boxes);
  std::array<std::uint16_t, 5> found{};
  found[4] = 999;
  EXPECT_EQ(tree.find(boxes[0], std::span(found).first(4)), 4u);
  EXPECT_EQ(found[4], 999);
}

TEST(BodyTree, QueryGoesThroughToFind) {
  const std::vector<AlignedBox3d> boxes = random_boxes(16, 3);
  const BodyTree tree(boxes);
  const BodyQuery query = tree.query();
  std::array<std::uint16_t, 16> found{};
  const AlignedBox3d all(Vector3d::Constant(-1), Vector3d::Constant(1));
  ASSERT_EQ(query.find(query.bodies, all, found), 16u);
  for (std::size_t i = 0; i < 16; ++i) EXPECT_EQ(found[i], i);
}

TEST(BodyTree, FindAllocatesNothing) {
  const std::vector<AlignedBox3d> boxes = random_boxes(64, 4);
  const BodyTree tree(boxes);
  std::array<std::uint16_t, 64> found{};
  std::size_t total = 0;
  const std::uint64_t before = test::allocation_count();
  for (const AlignedBox3d& box : boxes) total += tree.find(box, found);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_GE(total, 64u);
}

}  // namespace
}  // namespace sulcus
