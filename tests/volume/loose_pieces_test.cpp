#include "engine/volume/loose_pieces.hpp"

#include <algorithm>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::loose_pieces_test {
namespace {

using Voxels = std::vector<std::uint32_t>;
using Pieces = std::vector<Voxels>;

/// Solid voxels of a model in [lower, upper), as files name them.
Voxels voxels_in(const VoxelModel& model, const Cell& lower, const Cell& upper) {
  Voxels voxels;
  for (int k = lower.z(); k < upper.z(); ++k) {
    for (int j = lower.y(); j < upper.y(); ++j) {
      for (int i = lower.x(); i < upper.x(); ++i) {
        if (model.solid({i, j, k})) voxels.push_back(model.grid.linear({i, j, k}));
      }
    }
  }
  return voxels;
}

/// The same rule by flooding the whole grid, voxel by voxel, at every call of take.
class PlainLoosePieces {
 public:
  explicit PlainLoosePieces(VoxelModel model)
      : model_(std::move(model)), component_(model_.grid.cell_count(), -1) {
    int number = 0;
    for (const Voxels& part : parts()) {
      for (std::uint32_t v : part) component_[v] = number;
      ++number;
    }
  }
  void remove(std::span<const std::uint32_t> voxels) {
    for (std::uint32_t v : voxels) model_.set(model_.grid.cell_of_linear(v), false);
  }
  Pieces take() {
    std::map<int, Pieces> of_component;  // by first voxel
    for (Voxels& part : parts()) of_component[component_[part.front()]].push_back(std::move(part));
    Pieces loose;
    for (auto& [component, same] : of_component) {
      const auto stays = std::max_element(
          same.begin(), same.end(),
          [](const Voxels& a, const Voxels& b) { return a.size() < b.size(); });  // first of equals
      same.erase(stays);
      for (Voxels& part : same) loose.push_back(std::move(part));
    }
    std::sort(loose.begin(), loose.end());
    for (const Voxels& part : loose) remove(part);
    return loose;
  }
  const VoxelModel& model() const { return model_; }

 private:
  /// All that hangs together, by first voxel, each sorted.
  Pieces parts() const {
    const VoxelGrid& grid = model_.grid;
    std::vector<char> unseen(grid.cell_count());
    for (std::uint32_t v = 0; v < unseen.size(); ++v) {
      unseen[v] = model_.solid(grid.cell_of_linear(v));
    }
    const std::uint32_t stride[] = {1, grid.linear({0, 1, 0}), grid.linear({0, 0, 1})};
    Pieces all;
    for (std::uint32_t first = 0; first < unseen.size(); ++first) {
      if (!unseen[first]) continue;
      Voxels part{first};
      unseen[first] = false;
      const auto reach = [&](std::uint32_t to) {
        if (!unseen[to]) return;
        unseen[to] = false;
        part.push_back(to);
      };
      for (std::size_t i = 0; i < part.size(); ++i) {
        const std::uint32_t v = part[i];
        const Cell c = grid.cell_of_linear(v);
        for (int axis = 0; axis < 3; ++axis) {
          if (c[axis] > 0) reach(v - stride[axis]);
          if (c[axis] + 1 < grid.cells[axis]) reach(v + stride[axis]);
        }
      }
      std::sort(part.begin(), part.end());
      all.push_back(std::move(part));
    }
    return all;
  }

  VoxelModel model_;
  std::vector<int> component_;
};

/// As files name them; they come leaf by leaf.
Pieces taken(LoosePieces& pieces) {
  const VoxelGrid& grid = pieces.model().grid;
  const auto by_leaf = [&](std::uint32_t v) {
    return std::pair(grid.leaf_of(grid.cell_of_linear(v)), v);
  };
  Pieces voxels;
  for (LoosePiece& piece : pieces.take()) {
    EXPECT_TRUE(std::ranges::is_sorted(piece.voxels, {}, by_leaf));
    std::ranges::sort(piece.voxels);
    voxels.push_back(std::move(piece.voxels));
  }
  return voxels;
}

/// Two blocks of 12 x 12 x 12 and 10 x 10 x 10 voxels, the larger first, joined by a bridge of
/// 2 x 2 voxels' section, across the borders of leaves.
VoxelModel bridged_blocks() {
  return test::make_model({48, 24, 24}, 1e-4, [](const Cell& c) {
    const auto in = [&](const Cell& lower, const Cell& upper) {
      return (c.array() >= lower.array()).all() && (c.array() < upper.array()).all();
    };
    return in({3, 3, 3}, {15, 15, 15}) || in({25, 3, 3}, {35, 13, 13}) ||
           in({15, 7, 7}, {25, 9, 9});
  });
}

TEST(LoosePieces, NothingIsLooseBeforeACut) {
  LoosePieces pieces(bridged_blocks());
  EXPECT_TRUE(pieces.take().empty());
  EXPECT_EQ(pieces.model().leaves, bridged_blocks().leaves);
}

TEST(LoosePieces, ABridgeCutLeavesTheSmallerEndLoose) {
  const VoxelModel start = bridged_blocks();
  LoosePieces pieces(start);
  // All but one voxel of a section: both ends still hang together.
  Voxels cut = voxels_in(start, {19, 7, 7}, {20, 9, 9});
  const std::uint32_t last = cut.back();
  cut.pop_back();
  pieces.remove(cut);
  EXPECT_TRUE(pieces.take().empty());
  pieces.remove(std::span(&last, 1));
  EXPECT_EQ(taken(pieces), Pieces{voxels_in(start, {20, 0, 0}, {48, 24, 24})});
  EXPECT_EQ(voxels_in(pieces.model(), {0, 0, 0}, {48, 24, 24}),
            voxels_in(start, {0, 0, 0}, {19, 24, 24}));
  EXPECT_TRUE(pieces.take().empty()) << "taken once only";
}

TEST(LoosePieces, AnIslandUnderABridge) {
  // A slab, a bridge along x above it, and a cube of 10^3 hanging from the bridge by one voxel.
  const auto in_island = [](const Cell& c) {
    return (c.array() >= Cell(19, 7, 11).array()).all() &&
           (c.array() < Cell(29, 17, 21).array()).all();
  };
  const VoxelModel start = test::make_model({48, 24, 32}, 1e-4, [&](const Cell& c) {
    const bool slab = c.z() < 5;
    const bool pier = (c.x() < 3 || c.x() >= 45) && c.z() < 26;
    const bool deck = c.z() >= 22 && c.z() < 26;
    return slab || pier || deck || in_island(c) || c == Cell(24, 12, 21);
  });
  LoosePieces pieces(start);
  const std::uint32_t thread = start.grid.linear({24, 12, 21});
  pieces.remove(std::span(&thread, 1));
  const Pieces loose = taken(pieces);
  ASSERT_EQ(loose.size(), 1u);
  EXPECT_EQ(loose[0].size(), 1000u);
  for (std::uint32_t v : loose[0]) EXPECT_TRUE(in_island(start.grid.cell_of_linear(v)));
  EXPECT_TRUE(std::is_sorted(loose[0].begin(), loose[0].end()));
}

TEST(LoosePieces, OfACubeCutInTwoTheLargerStays) {
  for (int at : {10, 15, 19}) {
    const VoxelModel start = test::block({32, 32, 32}, 1e-4, {2, 2, 2}, {30, 30, 30});
    LoosePieces pieces(start);
    pieces.remove(voxels_in(start, {at, 0, 0}, {at + 1, 32, 32}));
    const bool lower_is_larger = at - 2 > 30 - at - 1;
    EXPECT_EQ(taken(pieces), Pieces{lower_is_larger ? voxels_in(start, {at + 1, 0, 0}, {32, 32, 32})
                                                    : voxels_in(start, {0, 0, 0}, {at, 32, 32})})
        << at;
  }
}

TEST(LoosePieces, OfEqualPartsTheFirstStays) {
  // Cut across each axis; the half with the lower coordinates has the lower first voxel.
  for (int axis = 0; axis < 3; ++axis) {
    const VoxelModel start = test::block({32, 32, 32}, 1e-4, {3, 3, 3}, {28, 28, 28});
    Cell lower = Cell::Zero(), upper(32, 32, 32);
    lower[axis] = 15;
    upper[axis] = 16;
    LoosePieces pieces(start);
    pieces.remove(voxels_in(start, lower, upper));
    lower[axis] = 16;
    EXPECT_EQ(taken(pieces), Pieces{voxels_in(start, lower, {32, 32, 32})}) << axis;
  }
}

TEST(LoosePieces, DiagonalTouchIsNotHangingTogether) {
  // Two cubes joined by a pair of voxels over the edge at which they touch.
  const VoxelModel start = test::make_model({32, 32, 16}, 1e-4, [](const Cell& c) {
    const bool first = c.x() < 16 && c.y() < 16, second = c.x() >= 16 && c.y() >= 16 && c.y() < 30;
    return first || second || c == Cell(16, 15, 9);
  });
  LoosePieces pieces(start);
  const std::uint32_t joint = start.grid.linear({16, 15, 9});
  pieces.remove(std::span(&joint, 1));
  EXPECT_EQ(taken(pieces), Pieces{voxels_in(start, {16, 16, 0}, {32, 32, 16})});
}

TEST(LoosePieces, EachComponentOfTheStartKeepsItsLargestPart) {
  // A large bar and a small one: the small one's larger half stays though it is small.
  const VoxelModel start = test::make_model({64, 32, 16}, 1e-4, [](const Cell& c) {
    return (c.y() < 10 || (c.y() >= 20 && c.y() < 23 && c.x() < 30)) && c.z() < 8;
  });
  LoosePieces pieces(start);
  EXPECT_TRUE(pieces.take().empty());
  pieces.remove(voxels_in(start, {20, 0, 0}, {21, 32, 16}));
  EXPECT_EQ(taken(pieces), (Pieces{voxels_in(start, {0, 0, 0}, {20, 10, 16}),
                                   voxels_in(start, {21, 20, 0}, {30, 23, 16})}));
  // What stayed of the small bar may go altogether, and takes nothing with it.
  pieces.remove(voxels_in(start, {0, 20, 0}, {20, 23, 16}));
  EXPECT_TRUE(pieces.take().empty());
}

TEST(LoosePieces, VoxelsThatAreEmptyOrGoneArePassedOver) {
  const VoxelModel start = bridged_blocks();
  LoosePieces pieces(start);
  const Voxels section = voxels_in(start, {19, 7, 7}, {20, 9, 9});
  const std::uint32_t empty = 0;
  pieces.remove(std::span(&empty, 1));
  EXPECT_TRUE(pieces.take().empty());
  pieces.remove(section);
  pieces.remove(section);
  const Pieces loose = taken(pieces);
  ASSERT_EQ(loose.size(), 1u);
  pieces.remove(loose[0]);
  pieces.remove(section);
  EXPECT_TRUE(pieces.take().empty());
}

/// Balls with speckle: many components at the start, leaves of many parts.
VoxelModel speckled() { return test::random_blobs({48, 40, 32}, 5); }

/// A lattice of rods of one voxel's width with knots where they meet.
VoxelModel rods() {
  return test::make_model({40, 40, 40}, 1e-4, [](const Cell& c) {
    int knot = 0, rod = 0;
    for (int a = 0; a < 3; ++a) {
      knot += c[a] % 9 >= 3 && c[a] % 9 < 6;
      rod += c[a] % 9 == 4;
    }
    return knot == 3 || rod >= 2;
  });
}

/// A ball, or single voxels at random, solid or not.
Voxels random_cut(const VoxelGrid& grid, std::mt19937& random) {
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const bool ball = below(2) == 0;
  const Cell at(below(grid.cells.x()), below(grid.cells.y()), below(grid.cells.z()));
  const int radius = 1 + below(4);
  Voxels voxels;
  for (std::uint32_t v = 0; v < grid.cell_count(); ++v) {
    if (ball ? (grid.cell_of_linear(v) - at).squaredNorm() <= radius * radius : below(100) == 0) {
      voxels.push_back(v);
    }
  }
  return voxels;
}

TEST(LoosePieces, EqualsAFloodOfTheWholeGridAtEveryStep) {
  const VoxelModel starts[] = {speckled(), test::two_balls(), rods()};
  std::size_t pieces_seen = 0;
  for (const VoxelModel& start : starts) {
    LoosePieces pieces(start);
    PlainLoosePieces plain(start);
    std::mt19937 random(17);
    for (int step = 0; step < 60; ++step) {
      const Voxels cut = random_cut(start.grid, random);
      pieces.remove(cut);
      plain.remove(cut);
      if (step % 3 == 1) continue;  // two cuts in one
      const Pieces loose = taken(pieces);
      ASSERT_EQ(loose, plain.take()) << step;
      ASSERT_EQ(pieces.model().leaves, plain.model().leaves) << step;
      pieces_seen += loose.size();
    }
  }
  EXPECT_GT(pieces_seen, 50u);
}

TEST(LoosePieces, VoxelByVoxelEqualsAFloodOfTheWholeGrid) {
  // Single voxels at random, until nothing is left: leaves divide, empty and join no more.
  const VoxelModel start = test::block({24, 16, 16}, 1e-4, {1, 1, 1}, {23, 15, 15});
  LoosePieces pieces(start);
  PlainLoosePieces plain(start);
  std::mt19937 random(23);
  Voxels order = voxels_in(start, {0, 0, 0}, {24, 16, 16});
  test::shuffle(order, random);
  for (std::size_t i = 0; i < order.size(); i += 7) {
    const auto cut = std::span(order).subspan(i, std::min<std::size_t>(7, order.size() - i));
    pieces.remove(cut);
    plain.remove(cut);
    ASSERT_EQ(taken(pieces), plain.take()) << i;
  }
  EXPECT_EQ(pieces.model().solid_count(), 0u);
}

TEST(LoosePieces, NeitherOrderNorBatchesOfRemovalCount) {
  const VoxelModel start = speckled();
  LoosePieces at_once(start), one_by_one(start);
  std::mt19937 random(29), shuffling(31);
  std::size_t pieces_seen = 0;
  for (int step = 0; step < 20; ++step) {
    Voxels cut;
    for (int cuts = 0; cuts < 3; ++cuts) {
      const Voxels more = random_cut(start.grid, random);
      cut.insert(cut.end(), more.begin(), more.end());
    }
    at_once.remove(cut);
    test::shuffle(cut, shuffling);
    for (const std::uint32_t& v : cut) one_by_one.remove(std::span(&v, 1));
    const Pieces loose = taken(at_once);
    ASSERT_EQ(loose, taken(one_by_one)) << step;
    pieces_seen += loose.size();
  }
  EXPECT_GT(pieces_seen, 20u);
}

}  // namespace
}  // namespace sulcus::loose_pieces_test
