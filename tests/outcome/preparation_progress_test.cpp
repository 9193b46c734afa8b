#include "engine/outcome/preparation_progress.hpp"

#include <gtest/gtest.h>

#include "tests/outcome/labelled_model.hpp"

namespace sulcus::preparation_progress_test {
namespace {

constexpr std::uint8_t kEnamel = 0, kPulp = 1, kCaries = 2;

/// A full block: pulp below z = 8, caries at x < 4 above it, enamel elsewhere.
VoxelModel layered_block() {
  return test::labelled(test::block({16, 16, 24}, 1e-4, {0, 0, 0}, {16, 16, 24}),
                        [](const Cell& c) {
                          return c.z() < 8 ? kPulp : c.x() < 4 ? kCaries : kEnamel;
                        });
}

const std::vector<TissueSettings> kAll = test::tissues_named({"enamel", "pulp", "caries"});

TEST(PreparationProgress, CountsByCauseAndTissue) {
  const VoxelModel model = layered_block();
  PreparationProgress progress(model, kAll);
  EXPECT_EQ(progress.caries_left(), 4u * 16 * 16);
  progress.add(test::edit_of(model, {10, 3, 20}));
  progress.add(test::edit_of(model, {10, 3, 21}));
  progress.add(test::edit_of(model, {2, 3, 20}));
  progress.add(test::edit_of(model, {2, 4, 20}, 5, EditCause::kLoose));
  Edit other_body = test::edit_of(model, {2, 5, 20});
  other_body.body = 1;
  progress.add(other_body);
  EXPECT_EQ(progress.removed_voxels(EditCause::kCut, kEnamel), 2u);
  EXPECT_EQ(progress.removed_voxels(EditCause::kCut, kCaries), 1u);
  EXPECT_EQ(progress.removed_voxels(EditCause::kLoose, kCaries), 1u);
  EXPECT_EQ(progress.removed_voxels(EditCause::kLoose, kEnamel), 0u);
  EXPECT_EQ(progress.caries_left(), 4u * 16 * 16 - 2);
  EXPECT_EQ(progress.pulp_removed(), 0u);
}

TEST(PreparationProgress, FractionsCountByWhatOfThemWasFilled) {
  VoxelModel model = layered_block();
  const Cell part(2, 3, 20), full(3, 3, 20), deep(10, 3, 4);  // caries twice, pulp
  LeafLevels page;
  page.leaf = model.grid.leaf_of(part);
  page.levels.fill(kFullLevel);
  page.levels[leaf_place(part)] = 51;
  model.fills.emplace(model.grid.leaf_count(), std::vector<LeafLevels>{page});
  PreparationProgress progress(model, kAll);
  const double caries = 4.0 * 16 * 16 - 0.8;
  EXPECT_NEAR(*progress.caries_left(), caries, 1e-12);
  const auto cut_to = [&](const Cell& c, FillLevel level) {
    Edit edit = test::edit_of(model, c, 3);
    edit.level = level;
    progress.add(edit);
  };
  cut_to(full, 204);  // a fifth
  cut_to(full, 102);  // two fifths more
  cut_to(deep, 153);  // two fifths, in a leaf without a page
  EXPECT_EQ(progress.removed_voxels(EditCause::kCut, kCaries), 0u);
  EXPECT_NEAR(progress.removed_volume(EditCause::kCut, kCaries), 0.6, 1e-12);
  EXPECT_NEAR(progress.pulp_removed(), 0.4, 1e-12);
  EXPECT_FALSE(progress.pulp_exposed_tick()) << "none is gone";
  cut_to(part, 0);  // a fifth
  progress.add(test::edit_of(model, full, 4, EditCause::kLoose));
  cut_to(deep, 0);
  EXPECT_EQ(progress.removed_voxels(EditCause::kCut, kCaries), 1u);
  EXPECT_NEAR(progress.removed_volume(EditCause::kCut, kCaries), 0.8, 1e-12);
  EXPECT_NEAR(progress.removed_volume(EditCause::kLoose, kCaries), 0.4, 1e-12);
  EXPECT_NEAR(*progress.caries_left(), caries - 1.2, 1e-12);
  EXPECT_NEAR(progress.pulp_removed(), 1.0, 1e-12);
  EXPECT_EQ(progress.pulp_exposed_tick(), 3u);
}

TEST(PreparationProgress, ThePulpIsExposedByTheFirstVoxelThatLaysOneOfItsFacesOpen) {
  const VoxelModel model = layered_block();
  PreparationProgress progress(model, kAll);
  progress.add(test::edit_of(model, {10, 10, 10}, 3));
  progress.add(test::edit_of(model, {10, 10, 9}, 4));
  EXPECT_FALSE(progress.pulp_exposed_tick()) << "one voxel is left between";
  progress.add(test::edit_of(model, {10, 10, 8}, 7));
  EXPECT_EQ(progress.pulp_exposed_tick(), 7u);
  EXPECT_EQ(progress.pulp_removed(), 0u);
  progress.add(test::edit_of(model, {10, 10, 7}, 9));
  EXPECT_EQ(progress.pulp_exposed_tick(), 7u) << "the first stands";
  EXPECT_EQ(progress.pulp_removed(), 1u);
}

TEST(PreparationProgress, EveryFaceCountsAndNoEdgeDoes) {
  const VoxelModel model =
      test::labelled(test::block({24, 24, 24}, 1e-4, {0, 0, 0}, {24, 24, 24}),
                     [](const Cell& c) { return c == Cell(8, 15, 12) ? kPulp : kEnamel; });
  for (int n = 0; n < 27; ++n) {
    const Cell step(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
    PreparationProgress progress(model, kAll);
    progress.add(test::edit_of(model, Cell(8, 15, 12) + step, 1));
    EXPECT_EQ(progress.pulp_exposed_tick().has_value(), step.cwiseAbs().sum() <= 1)
        << step.transpose();
  }
}

TEST(PreparationProgress, ALoosePieceExposesToo) {
  const VoxelModel model = layered_block();
  PreparationProgress progress(model, kAll);
  progress.add(test::edit_of(model, {1, 1, 8}, 12, EditCause::kLoose));
  EXPECT_EQ(progress.pulp_exposed_tick(), 12u);
}

TEST(PreparationProgress, WhatASceneDoesNotNameIsNotKept) {
  const VoxelModel model = layered_block();
  PreparationProgress progress(model, test::tissues_named({"enamel", "nerve", "decay"}));
  EXPECT_FALSE(progress.has_pulp());
  EXPECT_FALSE(progress.caries_left());
  EXPECT_EQ(progress.memory_bytes(), 0u);
  progress.add(test::edit_of(model, {1, 1, 7}, 1));
  EXPECT_FALSE(progress.pulp_exposed_tick());
  EXPECT_EQ(progress.removed_voxels(EditCause::kCut, kPulp), 1u);

  // One tissue, no labels.
  const VoxelModel plain = test::block({8, 8, 8}, 1e-4, {0, 0, 0}, {8, 8, 8});
  PreparationProgress of_plain(plain, test::tissues_named({"enamel"}));
  of_plain.add(test::edit_of(plain, {1, 1, 7}));
  EXPECT_EQ(of_plain.removed_voxels(EditCause::kCut, 0), 1u);
}

}  // namespace
}  // namespace sulcus::preparation_progress_test
