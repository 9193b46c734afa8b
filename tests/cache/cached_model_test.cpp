#include "engine/cache/cached_model.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/volume/packed_model.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::cached_model_test {
namespace {

constexpr std::size_t kTissues = 4;

/// Full, part-full, empty and speckled leaves, of one tissue and of several.
VoxelModel sample(bool labelled) {
  VoxelModel model = test::random_blobs({64, 48, 40}, 11);
  model.clipped = true;
  if (!labelled) return model;
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LabelBlock labels{};
    for (int v = 0; v < 512; ++v) {
      const Cell c = model.grid.leaf_origin(leaf) + Cell(v & 7, v >> 3 & 7, v >> 6);
      labels[v] = c.x() < 20 ? 3 : c.y() < 30 ? 1 : 2;
    }
    tissues->set_block(leaf, labels, model.leaves[leaf]);
  }
  model.tissues = tissues;
  return model;
}

/// The same with every third voxel of the part-full leaves filled in part.
VoxelModel filled_sample(bool labelled) {
  VoxelModel model = sample(labelled);
  std::vector<LeafLevels> pages;
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    if (const int n = count_voxels(model.leaves[leaf]); n == 0 || n == 512) continue;
    LeafLevels& page = pages.emplace_back();
    page.leaf = leaf;
    for_each_voxel(model.leaves[leaf], [&](int place) {
      page.levels[place] = place % 3 == 0 ? static_cast<FillLevel>(1 + place % 254) : kFullLevel;
    });
  }
  model.fills.emplace(model.grid.leaf_count(), pages);
  return model;
}

void expect_equal(const VoxelModel& a, const VoxelModel& b) {
  EXPECT_EQ(a.grid.cells, b.grid.cells);
  EXPECT_EQ(a.grid.voxel_m, b.grid.voxel_m);
  EXPECT_EQ(a.clipped, b.clipped);
  ASSERT_EQ(a.leaves, b.leaves);
  ASSERT_EQ(a.fills.has_value(), b.fills.has_value());
  for_each_cell(Cell::Zero(), a.grid.cells,
                [&](const Cell& c) { ASSERT_EQ(a.level(c), b.level(c)) << c.transpose(); });
  ASSERT_EQ(a.tissues == nullptr, b.tissues == nullptr);
  if (!a.tissues) return;
  for (std::uint32_t leaf = 0; leaf < a.grid.leaf_count(); ++leaf) {
    const LabelBlock *of_a = a.tissues->block(leaf), *of_b = b.tissues->block(leaf);
    ASSERT_EQ(of_a == nullptr, of_b == nullptr) << leaf;
    if (of_a) {
      ASSERT_EQ(*of_a, *of_b) << leaf;
    } else {
      ASSERT_EQ(a.tissues->uniform_label(leaf), b.tissues->uniform_label(leaf)) << leaf;
    }
  }
}

TEST(CachedModel, ComesBackBitForBit) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path(""));
  for (const bool labelled : {false, true}) {
    const VoxelModel model = sample(labelled);
    const Hash128 key = LoadCache::key_of(CacheKind::kModel).add(labelled).result();
    EXPECT_FALSE(read_cached_model(cache, key, model.grid, kTissues));
    write_cached_model(cache, key, model);
    const auto again = read_cached_model(cache, key, model.grid, kTissues);
    ASSERT_TRUE(again);
    expect_equal(model, *again);
  }
  for (const bool labelled : {false, true}) {
    const VoxelModel model = filled_sample(labelled);
    ASSERT_GT(model.fills->pages().size(), 10u);
    write_cached_model(cache, {2, 1}, model);
    const auto again = read_cached_model(cache, {2, 1}, model.grid, kTissues);
    ASSERT_TRUE(again);
    expect_equal(model, *again);
    EXPECT_EQ(again->fills->pages().size(), model.fills->pages().size());
  }
  // A mask's: fractions, and not one that is not full.
  VoxelModel full = sample(true);
  full.fills.emplace(full.grid.leaf_count(), std::vector<LeafLevels>{});
  write_cached_model(cache, {2, 2}, full);
  const auto again = read_cached_model(cache, {2, 2}, full.grid, kTissues);
  ASSERT_TRUE(again);
  expect_equal(full, *again);
  EXPECT_EQ(cache.hits(), 5);
  EXPECT_EQ(cache.note(), "");
}

TEST(CachedModel, KeepsWhatTheImportTold) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path(""));
  const VoxelModel model = sample(true);
  ImportNotes notes;
  notes.warnings = {"values left out: 5", "", "another"};
  InputGeometry& input = notes.input.emplace();
  input.file_from_world =
      Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 2).normalized());
  input.sizes = {3, 4, 5};
  input.spacing_m = {1e-4, 2e-4, 3e-4};
  input.origin_m = {-1, 0.5, 0.25};
  input.direction.col(0) *= -1.0;
  write_cached_model(cache, {1, 3}, model, notes);
  ImportNotes again;
  const auto read = read_cached_model(cache, {1, 3}, model.grid, kTissues, &again);
  ASSERT_TRUE(read);
  expect_equal(model, *read);
  EXPECT_EQ(again.warnings, notes.warnings);
  ASSERT_TRUE(again.input);
  EXPECT_EQ(again.input->numbers(), input.numbers());

  input.direction.setZero();  // no geometry
  write_cached_model(cache, {1, 4}, model, notes);
  EXPECT_FALSE(read_cached_model(cache, {1, 4}, model.grid, kTissues, &again));
}

TEST(CachedModel, KeepsNoBitsOfFullLeavesNorAnythingOfEmptyOnes) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path(""));
  // 14^3 full leaves, and a shell of part-full ones that is 2 * 6 * 14^2 + ... large.
  const VoxelModel model = test::block({256, 256, 256}, 1e-4, {60, 60, 60}, {180, 180, 180});
  write_cached_model(cache, {1, 2}, model);
  const std::uint64_t shell = 16 * 16 * 16 - 14 * 14 * 14;
  EXPECT_EQ(std::filesystem::file_size(cache.entry({1, 2})), 64 + 64 + 4096 * 4 + shell * 64);
}

TEST(CachedModel, RefusesWhatNoWriterOfItsOwnWrote) {
  const ScratchFolder scratch;
  const VoxelModel model = sample(true);
  const PackedModel packed = pack(model);
  const std::size_t n = packed.leaves.size(), m = packed.mixed.size();
  ASSERT_GT(m, 1u);
  std::string good;
  {
    LoadCache cache(scratch.path(""));
    write_cached_model(cache, {1, 1}, model);
    good = test::read_file(cache.entry({1, 1}).string()).substr(64);
  }
  const std::size_t leaves = 64, mixed = leaves + 4 * n, labels = mixed + 4 * m, words = labels + n;
  const auto put = [](std::string& bytes, std::size_t at, auto value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
  };
  // All with a check that fits: only what the content says can tell.
  const std::vector<std::pair<const char*, std::function<void(std::string&)>>> changes = {
      {"nothing", [](std::string& b) { b.clear(); }},
      {"cells", [&](std::string& b) { put(b, 0, 72u); }},
      {"voxel_m", [&](std::string& b) { put(b, 16, 1.0); }},
      {"more leaves", [&](std::string& b) { put(b, 24, std::uint64_t{n + 1}); }},
      {"leaves without end", [&](std::string& b) { put(b, 24, ~std::uint64_t{0}); }},
      {"no part-full leaves", [&](std::string& b) { put(b, 32, std::uint64_t{0}); }},
      {"more mixed leaves", [&](std::string& b) { put(b, 40, std::uint64_t{m + 1}); }},
      {"numbers of an input", [&](std::string& b) { put(b, 48, std::uint64_t{29}); }},
      {"an input that is not there", [&](std::string& b) { put(b, 48, std::uint64_t{30}); }},
      {"warnings without end", [&](std::string& b) { put(b, 56, ~std::uint64_t{0}); }},
      {"mixed leaves without labels", [&](std::string& b) { put(b, 12, 1u); }},
      {"leaf beyond the grid",
       [&](std::string& b) { put(b, leaves + 4 * (n - 1), model.grid.leaf_count()); }},
      {"leaves out of order", [&](std::string& b) { put(b, leaves + 4, packed.leaves[0]); }},
      {"mixed beyond", [&](std::string& b) { put(b, mixed + 4 * (m - 1), std::uint32_t(n)); }},
      {"mixed out of order", [&](std::string& b) { put(b, mixed + 4, packed.mixed[0]); }},
      {"tissue of a leaf", [&](std::string& b) { b[labels] = char(kTissues); }},
      {"empty part-full leaf", [&](std::string& b) { b.replace(words, 64, 64, '\0'); }},
      {"tissue of a voxel", [&](std::string& b) { b.back() = char(kTissues); }},
      {"one byte more", [](std::string& b) { b += 'x'; }},
  };
  LoadCache cache(scratch.path(""));
  for (const auto& [what, change] : changes) {
    std::string bytes = good;
    change(bytes);
    cache.write(CacheKind::kModel, {1, 1}, {std::as_bytes(std::span(bytes))});
    EXPECT_FALSE(read_cached_model(cache, {1, 1}, model.grid, kTissues)) << what;
    EXPECT_EQ(cache.hits(), 0) << what;
    EXPECT_NE(cache.note(), "") << what;
  }
  cache.write(CacheKind::kModel, {1, 1}, {std::as_bytes(std::span(good))});
  EXPECT_TRUE(read_cached_model(cache, {1, 1}, model.grid, kTissues));
}

TEST(CachedModel, RefusesLevelsThatDoNotFit) {
  const ScratchFolder scratch;
  const VoxelModel model = filled_sample(true);
  const std::size_t pages = model.fills->pages().size();
  LoadCache cache(scratch.path(""));
  write_cached_model(cache, {1, 1}, model);
  const std::string good = test::read_file(cache.entry({1, 1}).string()).substr(64);
  const std::size_t first = good.size() - pages * sizeof(LeafLevels);
  const auto put = [](std::string& bytes, std::size_t at, auto value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
  };
  const LeafLevels& page = model.fills->pages().front();
  const auto empty = std::ranges::find(page.levels, FillLevel{0}) - page.levels.begin();
  const auto full = std::ranges::find(page.levels, kFullLevel) - page.levels.begin();
  const std::size_t levels = first + sizeof(std::uint32_t);
  const std::vector<std::pair<const char*, std::function<void(std::string&)>>> changes = {
      {"no levels", [&](std::string& b) { b.resize(first - 8); }},
      {"half a page", [&](std::string& b) { b.resize(b.size() - 100); }},
      {"a page more", [&](std::string& b) { put(b, first - 8, std::uint64_t{pages + 1}); }},
      {"pages without end", [&](std::string& b) { put(b, first - 8, ~std::uint64_t{0}); }},
      {"levels of a binary model", [&](std::string& b) { put(b, 12, 3u); }},
      {"an unknown flag", [&](std::string& b) { put(b, 12, 15u); }},
      {"a page twice", [&](std::string& b) { put(b, first + sizeof(LeafLevels), page.leaf); }},
      {"a leaf beyond", [&](std::string& b) { put(b, first, model.grid.leaf_count()); }},
      {"an empty voxel filled",
       [&](std::string& b) { b[levels + static_cast<std::size_t>(empty)] = 1; }},
      {"a solid voxel not filled",
       [&](std::string& b) { b[levels + static_cast<std::size_t>(full)] = 0; }},
  };
  int hits = cache.hits();
  for (const auto& [what, change] : changes) {
    std::string bytes = good;
    change(bytes);
    cache.write(CacheKind::kModel, {1, 1}, {std::as_bytes(std::span(bytes))});
    EXPECT_FALSE(read_cached_model(cache, {1, 1}, model.grid, kTissues)) << what;
    EXPECT_EQ(cache.hits(), hits) << what;
  }
  cache.write(CacheKind::kModel, {1, 1}, {std::as_bytes(std::span(good))});
  EXPECT_TRUE(read_cached_model(cache, {1, 1}, model.grid, kTissues));
}

}  // namespace
}  // namespace sulcus::cached_model_test
