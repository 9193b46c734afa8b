// What a recording says of the run before its first tick, and of its own at the end.
#include "engine/recording/earlier_run.hpp"

#include <algorithm>
#include <fstream>
#include <string>

#include "engine/core/error.hpp"
#include "engine/volume/packed_model.hpp"
#include "tests/recording/sample_recording.hpp"

namespace sulcus::sample::earlier_run_test {
namespace {

class EarlierRunTest : public RecordingTest {
 protected:
  /// Some solid voxels of the workpiece went, every one of a leaf among them.
  EarlierRunTest() {
    before_.recording = "out/first/recording.h5";
    before_.scene_sha256 = "abc";
    before_.start = workpiece();
    before_.measures.ticks = 12;
    before_.measures.ticks_in_contact = 7;
    before_.measures.peak_force_N = 1.5;
    before_.measures.force_in_contact_sum_N = 0.1 + 0.2;
    before_.measures.buzz_ticks = 3;
    VoxelModel model = workpiece();
    const VoxelGrid& grid = model.grid;
    std::uint64_t tick = 1;
    std::optional<std::uint32_t> emptied;
    for (std::uint32_t voxel = 0; voxel < grid.cell_count(); ++voxel) {
      const Cell c = grid.cell_of_linear(voxel);
      if (!model.solid(c)) continue;
      if (!emptied) emptied = grid.leaf_of(c);
      if (grid.leaf_of(c) != *emptied && voxel % 97 != 0) continue;
      before_.edits.push_back({tick++, voxel, 0, voxel % 2 ? EditCause::kLoose : EditCause::kCut});
      model.set(c, false);
    }
    now_ = unpack(pack(model));  // as a recording has it: without the tissues of what is gone
  }
  void write() const {
    RecordingWriter writer(path(), header(), now_, nullptr, {}, {{}, nullptr, nullptr, &before_});
    writer.close();
  }
  EarlierRun before_;
  VoxelModel now_;
};

TEST_F(EarlierRunTest, ReadsBackWithTheTissuesOfWhatHasGone) {
  write();
  const std::optional<EarlierRun> read = RecordingReader(path()).earlier();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->recording, before_.recording);
  EXPECT_EQ(read->scene_sha256, before_.scene_sha256);
  EXPECT_EQ(read->measures.ticks, 12u);
  EXPECT_EQ(read->measures.ticks_in_contact, 7u);
  EXPECT_EQ(read->measures.peak_force_N, 1.5);
  EXPECT_EQ(read->measures.force_in_contact_sum_N, 0.1 + 0.2);
  EXPECT_EQ(read->measures.buzz_ticks, 3u);
  EXPECT_EQ(read->measures.jumped_ticks, 0u);
  ASSERT_GT(before_.edits.size(), 100u);
  ASSERT_EQ(read->edits.size(), before_.edits.size());
  for (std::size_t i = 0; i < read->edits.size(); ++i) {
    EXPECT_TRUE(same(read->edits[i], before_.edits[i])) << i;
  }
  const VoxelGrid& grid = before_.start.grid;
  for (std::uint32_t voxel = 0; voxel < grid.cell_count(); ++voxel) {
    const Cell c = grid.cell_of_linear(voxel);
    ASSERT_EQ(read->start.solid(c), before_.start.solid(c)) << voxel;
    if (before_.start.solid(c)) {
      ASSERT_EQ(read->start.tissue(c), before_.start.tissue(c)) << voxel;
    }
  }
}

TEST_F(EarlierRunTest, IsNotThereOfARunThatBeganAnew) {
  RecordingWriter(path(), header(), workpiece(), nullptr).close();
  EXPECT_FALSE(RecordingReader(path()).earlier());
}

TEST_F(EarlierRunTest, EditsThatDoNotLeadToTheWorkpieceAreRefused) {
  before_.edits.pop_back();
  write();
  EXPECT_THROW((void)RecordingReader(path()).earlier(), InputError);
  before_.edits.push_back(before_.edits.front());  // twice the same
  write();
  EXPECT_THROW((void)RecordingReader(path()).earlier(), InputError);
}

TEST_F(EarlierRunTest, ASummaryIsThatOfTheEndOrNone) {
  const std::string text = "{\"scene\": \"" + std::string(20'000, 'z') + "\"}\n";
  {
    RecordingWriter writer(path(), header(), workpiece(), nullptr);
    append(writer, 0, 30);
    writer.append_summary(text);
    EXPECT_THROW(writer.append_summary(text), std::logic_error);
    writer.close();
  }
  EXPECT_EQ(RecordingReader(path()).summary(), text);
  // A letter of it changed.
  std::string bytes;
  {
    std::ifstream in(path(), std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  const std::size_t at = bytes.find("zzzzzzzz");
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 'y';
  std::ofstream(path(), std::ios::binary) << bytes;
  const RecordingReader damaged(path());
  EXPECT_FALSE(damaged.summary());
  EXPECT_EQ(damaged.tick_count(), 31u);
  RecordingWriter(path(), header(), workpiece(), nullptr).close();
  EXPECT_FALSE(RecordingReader(path()).summary());
}

}  // namespace
}  // namespace sulcus::sample::earlier_run_test
