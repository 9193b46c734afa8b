#include "engine/volume/leaf_parts.hpp"

#include <random>

#include <gtest/gtest.h>

#include "engine/volume/grid.hpp"

namespace sulcus::leaf_parts_test {
namespace {

bool has(const LeafBits& bits, const Cell& c) {
  return (c.array() >= 0).all() && (c.array() < kLeafEdge).all() && bits.has(leaf_place(c));
}

void set(LeafBits& bits, const Cell& c) { bits.set(leaf_place(c)); }

/// The same voxel by voxel.
std::vector<LeafBits> plain_parts(const LeafBits& bits) {
  std::vector<LeafBits> parts;
  LeafBits seen;
  for (int place = 0; place < 512; ++place) {
    const Cell first(place & 7, place >> 3 & 7, place >> 6);
    if (!has(bits, first) || has(seen, first)) continue;
    LeafBits part;
    std::vector<Cell> todo{first};
    set(seen, first);
    while (!todo.empty()) {
      const Cell c = todo.back();
      todo.pop_back();
      set(part, c);
      for (int axis = 0; axis < 3; ++axis) {
        for (int step : {-1, 1}) {
          const Cell to = c + step * Cell::Unit(axis);
          if (!has(bits, to) || has(seen, to)) continue;
          set(seen, to);
          todo.push_back(to);
        }
      }
    }
    parts.push_back(part);
  }
  return parts;
}

LeafBits random_bits(std::mt19937& random, unsigned solid_in_16) {
  LeafBits bits;
  for (int place = 0; place < 512; ++place) {
    if (random() % 16 < solid_in_16) set(bits, Cell(place & 7, place >> 3 & 7, place >> 6));
  }
  return bits;
}

TEST(LeafParts, AreThoseOfAFloodVoxelByVoxel) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    const LeafBits bits = random_bits(random, static_cast<unsigned>(round % 17));
    std::vector<LeafBits> parts;
    append_parts(bits, parts);
    ASSERT_EQ(parts, plain_parts(bits)) << round;
  }
}

TEST(LeafParts, AWindingWayIsOnePart) {
  // A way of one voxel's width through the whole leaf, to and fro in rows, slices joined at ends.
  LeafBits bits;
  for (int k = 0; k < 8; k += 2) {
    for (int j = 0; j < 8; j += 2) {
      for (int i = 0; i < 8; ++i) set(bits, {i, j, k});
      if (j < 6) set(bits, {j % 4 == 0 ? 7 : 0, j + 1, k});
    }
    if (k < 6) set(bits, k % 4 == 0 ? Cell(0, 6, k + 1) : Cell(0, 0, k + 1));
  }
  std::vector<LeafBits> parts;
  append_parts(bits, parts);
  EXPECT_EQ(parts, std::vector{bits});
}

TEST(LeafParts, AcrossAFaceAreTheVoxelsBeyondIt) {
  std::mt19937 random(4);
  for (int round = 0; round < 50; ++round) {
    const LeafBits bits = random_bits(random, 6);
    for (int face = 0; face < kLeafFaces; ++face) {
      LeafBits expected;
      const Cell step = (face % 2 == 0 ? -1 : 1) * Cell::Unit(face / 2);
      for (int place = 0; place < 512; ++place) {
        const Cell c(place & 7, place >> 3 & 7, place >> 6);
        const Cell beyond = c + step;
        if (!has(bits, c) || ((beyond.array() >= 0).all() && (beyond.array() < 8).all())) continue;
        set(expected, beyond - 8 * step);
      }
      EXPECT_EQ(across(bits, face), expected) << face;
    }
  }
}

TEST(LeafParts, CountAndMeet) {
  LeafBits a, b;
  EXPECT_FALSE(any(a));
  set(a, {1, 2, 3});
  set(a, {7, 7, 7});
  set(b, {1, 2, 4});
  EXPECT_TRUE(any(a));
  EXPECT_EQ(count_voxels(a), 2);
  EXPECT_FALSE(any(a & b));
  set(b, {7, 7, 7});
  EXPECT_TRUE(any(a & b));
}

}  // namespace
}  // namespace sulcus::leaf_parts_test
