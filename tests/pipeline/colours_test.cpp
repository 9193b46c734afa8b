#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/playback/recorded_contacts.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::colours_test {
namespace {

/// Small recordings, of a scene with a goal and of one without.
class Colours : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string goal =
        "[goal]\nshape = 'box'\nsize_mm = [0.6, 0.4, 0.2]\nposition_mm = [0, 0, 0.9]\n";
    record("goal", test::cut_scene() + goal);
    record("plain", test::cut_scene());
  }
  void record(const std::string& name, const std::string& scene) {
    const auto result = command("run " + scratch_.write(name + ".toml", scene) +
                                " --no-render -o " + scratch_.path(name));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  test::CommandResult command(const std::string& arguments) {
    return test::sulcus_command(arguments, scratch_.path("err"));
  }
  std::string recording(const std::string& name) const {
    return scratch_.path(name + "/recording.h5");
  }
  /// The picture that the options make.
  std::string picture(const std::string& options) {
    const auto result = command("render " + recording("goal") + " --at 0.3 --size 200x150 -o " +
                                scratch_.path("drawn") + ' ' + options);
    EXPECT_EQ(result.status, 0) << options << ": " << result.err;
    return test::read_file(result.out.substr(0, result.out.find('\n')));
  }

  ScratchFolder scratch_;
};

TEST_F(Colours, EachQuantityMakesAnotherPicture) {
  const std::string tissue = picture("");
  ASSERT_FALSE(tissue.empty());
  std::vector<std::string> pictures{tissue};
  for (const std::string by : {"time", "goal", "contacts", "normal_error"}) {
    pictures.push_back(picture("--colour-by " + by));
  }
  pictures.push_back(picture("--contacts"));
  for (std::size_t a = 0; a < pictures.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) EXPECT_NE(pictures[a], pictures[b]) << a << ' ' << b;
  }
  EXPECT_EQ(picture("--colour-by tissue"), tissue);
}

TEST_F(Colours, SeveralTimesHaveTheColoursOfEach) {
  const auto result = command("render " + recording("goal") +
                              " --at 0.1 --at 0.3 --size 200x150 --colour-by contacts --contacts " +
                              "-o " + scratch_.path("two"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(test::read_file(scratch_.path("two/review_0.300s_by_contacts_contacts.png")),
            picture("--colour-by contacts --contacts"));
}

TEST_F(Colours, WhatCannotBeColouredIsSaid) {
  const auto refused = [&](const std::string& arguments, const std::string& says) {
    const auto result = command("render " + arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
  };
  refused(recording("plain") + " --colour-by goal", "without [goal]");
  refused(recording("plain") + " --colour-by depth", "--colour-by");
  refused(recording("goal") + " --review r.html --contacts", "it alone");
}

TEST_F(Colours, ContactsAreThoseThatTheRunHad) {
  RecordedContacts all(recording("goal"), true);
  RecordedContacts one(recording("goal"), false);
  const RecordingReader reader(recording("goal"));
  const std::vector<TickRecord> rows = reader.ticks();
  std::size_t touched = 0, same = 0;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    all.seek_row(row);
    ASSERT_EQ(all.marks().size(), rows[row].contacts) << row;
    touched += rows[row].contacts > 0;
    if (row % 37 != 0) continue;
    one.seek_row(row);
    ASSERT_EQ(one.marks().size(), all.marks().size()) << row;
    for (std::size_t i = 0; i < all.marks().size(); ++i, ++same) {
      EXPECT_EQ(one.marks()[i].centre_world, all.marks()[i].centre_world);
      EXPECT_EQ(one.marks()[i].force_N, all.marks()[i].force_N);
    }
  }
  EXPECT_GT(touched, 100u);
  EXPECT_GT(same, 100u);
  // Voxels that stand alone are counted, none oftener than there were ticks that touched.
  const VoxelValues counts = all.counts(0);
  VoxelModel end = reader.workpiece();
  for (const Edit& edit : reader.edits()) end.set(end.grid.cell_of_linear(edit.voxel), false);
  std::size_t counted = 0;
  for (const auto& [leaf, block] : counts.blocks()) {
    for (std::size_t place = 0; place < block.size(); ++place) {
      if (std::isnan(block[place])) continue;
      ++counted;
      EXPECT_TRUE(end.solid(end.grid.leaf_origin(leaf) + cell_in_leaf(static_cast<int>(place))));
      EXPECT_GE(block[place], 1.0f);
      EXPECT_LE(block[place], static_cast<float>(touched));
    }
  }
  EXPECT_GT(counted, 50u);
}

}  // namespace
}  // namespace sulcus::colours_test
