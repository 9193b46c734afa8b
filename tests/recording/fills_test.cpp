// Fill levels in a recording: those that fell, and those of the solids at the start.
#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <sys/wait.h>

#include "engine/core/error.hpp"
#include "engine/recording/hdf5_handle.hpp"
#include "engine/recording/recording_format.hpp"
#include "engine/volume/edits.hpp"
#include "engine/volume/packed_model.hpp"
#include "tests/recording/sample_recording.hpp"
#include "tests/support/filled_model.hpp"

namespace sulcus::sample::fills_test {
namespace {

/// The sample's workpiece, its surface filled anyhow.
const VoxelModel& filled_workpiece() {
  static const VoxelModel model = test::filled_anyhow(workpiece(), 3);
  return model;
}

std::uint64_t fills_of(std::uint64_t tick) { return tick % 5; }

std::vector<Edit> fills(std::uint64_t tick) {
  std::vector<Edit> out;
  for (std::uint64_t i = 0; i < fills_of(tick); ++i) {
    const std::uint64_t random = hash_bytes(&tick, sizeof tick, 1000 + i);
    out.push_back({tick, static_cast<std::uint32_t>(random % (64 * 48 * 32)), 0, EditCause::kCut,
                   static_cast<FillLevel>(1 + random / 7 % 254)});
  }
  return out;
}

std::uint64_t fills_end(std::uint64_t tick) {
  const std::uint64_t rest = tick % 5;
  return tick / 5 * 10 + rest * (rest + 1) / 2;
}

/// As `append`, with what falls.
void append_filled(RecordingWriter& writer, std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t t = first; t <= last; ++t) {
    writer.append_edits(fills(t));
    const FillEndRow end = sealed(FillEndRow{t, fills_end(t), 0});
    writer.append_fill_ends({&end, 1});
    append(writer, t, t);
  }
}

void expect_true_fills(const RecordingReader& reader) {
  std::vector<Edit> expected;
  const auto ends = reader.fill_ends();
  ASSERT_EQ(ends.size(), reader.tick_count());
  for (std::uint64_t t = 1; t <= reader.tick_count(); ++t) {
    ASSERT_EQ(ends[t - 1].tick, t);
    ASSERT_EQ(ends[t - 1].fills_end, fills_end(t));
    for (const Edit& fill : fills(t)) expected.push_back(fill);
  }
  const std::vector<Edit> read = reader.fills();
  ASSERT_EQ(read.size(), expected.size());
  ASSERT_EQ(reader.fill_count(), expected.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    ASSERT_TRUE(same(read[i], expected[i]) && read[i].level == expected[i].level) << i;
  }
}

class Fills : public RecordingTest {
 protected:
  std::string write_filled(std::uint64_t ticks) const {
    RecordingWriter writer(path(), header(), filled_workpiece(), nullptr);
    append_filled(writer, 1, ticks);
    writer.close();
    return path();
  }
  /// 20 ticks, then one with this row of /fills.
  RecordingReader with_row(const FillRow& row, const std::vector<const VoxelModel*>& bodies = {}) {
    RecordingWriter writer(path(), header(), filled_workpiece(), nullptr, {},
                           {bodies, nullptr, nullptr, nullptr});
    append_filled(writer, 1, 20);
    const Edit edit = unpacked(row);
    writer.append_edits({&edit, 1});
    const FillEndRow end = sealed(FillEndRow{21, fills_end(20) + 1, 0});
    writer.append_fill_ends({&end, 1});
    append(writer, 21, 21);
    writer.close();
    return RecordingReader(path());
  }
  static std::vector<char> bytes_of(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::string changed(std::vector<char> bytes) const {
    std::ofstream(path("changed.h5"), std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return path("changed.h5");
  }
  /// The InputError's line, or "" where all of it reads.
  static std::string refusal(const std::string& file) {
    try {
      RecordingReader(file).workpiece();
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "";
  }
};

TEST_F(Fills, AreReadAsTheyWereWritten) {
  const RecordingReader reader(write_filled(300));
  EXPECT_EQ(reader.missing(), "");
  EXPECT_TRUE(reader.has_fills());
  expect_true_prefix(reader);
  expect_true_fills(reader);
  ASSERT_EQ(reader.fills(7, 5).size(), 5u);
  EXPECT_EQ(reader.fills(7, 5).front().voxel, reader.fills()[7].voxel);
  const VoxelModel read = reader.workpiece();
  expect_same_workpiece(read, filled_workpiece());
  test::expect_equal_levels(read, filled_workpiece());
}

TEST_F(Fills, WhereAllVoxelsAreFullTheyAreLevelsNoLess) {
  VoxelModel full = workpiece();
  full.fills.emplace(full.grid.leaf_count(), std::vector<LeafLevels>{});
  RecordingWriter(path(), header(), full, nullptr).close();
  const RecordingReader reader(path());
  EXPECT_TRUE(reader.has_fills());
  EXPECT_TRUE(reader.workpiece().fills);
}

TEST_F(Fills, ABinaryRecordingHasNone) {
  RecordingWriter writer(path(), header(), workpiece(), nullptr);
  append(writer, 1, 5);
  EXPECT_FALSE(writer.has_fills());
  writer.flush();
  const RecordingReader reader(path());
  EXPECT_FALSE(reader.has_fills());
  EXPECT_TRUE(reader.fills().empty());
  EXPECT_TRUE(reader.fill_ends().empty());
  EXPECT_FALSE(reader.workpiece().fills);
  EXPECT_THROW(writer.append_edits(fills(4)), std::logic_error);
}

TEST_F(Fills, ATickWaitsForThem) {
  RecordingWriter writer(path(), header(), filled_workpiece(), nullptr);
  append_filled(writer, 1, 3);
  const FillEndRow end = sealed(FillEndRow{4, fills_end(4), 0});
  writer.append_fill_ends({&end, 1});
  append(writer, 4, 4);
  writer.flush();
  EXPECT_EQ(RecordingReader(path()).tick_count(), 3u);
  EXPECT_EQ(RecordingReader(path()).damage(), "") << "nothing is there that lacks its edits";
  writer.append_edits(fills(4));
  append(writer, 5, 5);  // without its row of /fill_ends
  writer.flush();
  EXPECT_EQ(RecordingReader(path()).tick_count(), 4u);
  EXPECT_THROW(writer.close(), std::runtime_error);
}

/// Flushes every 20 ticks and tells the pipe how many ticks are safe; never ends by itself.
[[noreturn]] void record_until_killed(const std::string& where, int pipe_end) {
  RecordingWriter writer(where, header(), filled_workpiece(), nullptr);
  for (std::uint64_t t = 1;; ++t) {
    append_filled(writer, t, t);
    if (t % 20 != 0) continue;
    writer.flush();
    if (write(pipe_end, &t, sizeof t) != sizeof t) _exit(1);
  }
}

TEST_F(Fills, AKilledWriterLeavesAllUpToItsLastFlush) {
  for (const std::uint64_t kill_after : {20u, 700u}) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) record_until_killed(path(), ends[1]);
    close(ends[1]);
    std::uint64_t safe = 0;
    while (safe < kill_after && read(ends[0], &safe, sizeof safe) == sizeof safe) {
    }
    expect_true_fills(RecordingReader(path()));  // of one that still grows
    kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    while (read(ends[0], &safe, sizeof safe) == sizeof safe) {
    }
    close(ends[0]);
    const RecordingReader reader(path());
    EXPECT_GE(reader.tick_count(), safe);
    expect_true_prefix(reader);
    expect_true_fills(reader);
  }
}

TEST_F(Fills, TruncatedAnywhereTheyNeverLie) {
  const auto bytes = bytes_of(write_filled(400));
  int refused = 0, shortened = 0;
  for (std::size_t length = 0; length < bytes.size(); length += bytes.size() / 150 + 1) {
    SCOPED_TRACE(length);
    const auto end = bytes.begin() + static_cast<std::ptrdiff_t>(length);
    try {
      const RecordingReader reader(changed({bytes.begin(), end}));
      expect_true_prefix(reader);
      expect_true_fills(reader);
      EXPECT_LE(reader.tick_count(), 400u);
      ++shortened;
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(shortened, 0);
}

TEST_F(Fills, ADamagedRowEndsTheRecordingBeforeItsTick) {
  const auto bytes = bytes_of(write_filled(400));
  const auto expect_end = [&](const auto& row, std::size_t at, const std::string& says) {
    auto damaged = bytes;
    const auto* raw = reinterpret_cast<const char*>(&row);
    const auto found = std::search(damaged.begin(), damaged.end(), raw, raw + sizeof row);
    ASSERT_NE(found, damaged.end());
    found[static_cast<std::ptrdiff_t>(at)] ^= 1;
    const RecordingReader reader(changed(damaged));
    EXPECT_EQ(reader.tick_count(), 98u);
    EXPECT_EQ(reader.damage(), says);
    expect_true_fills(reader);
  };
  expect_end(packed_fill(fills(99).front()), 14,
             "row " + std::to_string(fills_end(98)) + " of /fills is damaged");
  expect_end(sealed(FillEndRow{99, fills_end(99), 0}), 9, "row 98 of /fill_ends is damaged");
}

TEST_F(Fills, ALevelOfNoVoxelOrNoLevelIsDamage) {
  const VoxelModel &binary = workpiece(), &filled = filled_workpiece();
  EXPECT_EQ(with_row({21, 0, 5, 254, 0}).tick_count(), 21u);
  EXPECT_EQ(with_row({21, 2, 5, 1, 0}, {&binary, &filled}).tick_count(), 21u);
  const std::string damaged = "row " + std::to_string(fills_end(20)) + " of /fills is damaged";
  for (const FillRow& row :
       {FillRow{21, 0, 5, 255, 0}, FillRow{21, 0, 64 * 48 * 32, 9, 0}, FillRow{21, 3, 5, 9, 0},
        FillRow{21, 1, 5, 9, 0}, FillRow{20, 0, 5, 9, 0}, FillRow{22, 0, 5, 9, 0}}) {
    const RecordingReader reader = with_row(row, {&binary, &filled});
    EXPECT_EQ(reader.tick_count(), 20u);
    EXPECT_EQ(reader.damage(), damaged);
  }
}

TEST_F(Fills, OfRowsThatAreLeftOutAreThere) {
  for (const bool foreign : {false, true}) {
    RecordingWriter writer(path(), header(), filled_workpiece(), nullptr);
    append_filled(writer, 1, 20);
    for (std::uint64_t t = 21; t <= 30; ++t) {
      std::vector<Edit> of_tick = fills(t);
      if (foreign && t == 22) of_tick.front().tick = 20;
      writer.append_edits(of_tick);
      writer.append_edits(edits(t));
    }
    TickRecord row = tick(30);
    row.faults |= kFaultRowsDropped;
    seal(row);
    const FillEndRow end = sealed(FillEndRow{30, fills_end(30), 0});
    writer.append_fill_ends({&end, 1});
    writer.append_ticks({&row, 1});
    append_filled(writer, 31, 50);
    writer.close();
    const RecordingReader reader(path());
    EXPECT_EQ(reader.tick_count(), foreign ? 20u : 41u) << reader.damage();
    EXPECT_EQ(reader.fill_count(), fills_end(foreign ? 20 : 50));
  }
}

TEST_F(Fills, WhereTheyAreMissingTheFileIsRefused) {
  for (const char* gone : {"fills", "fill_ends", "workpiece/levels", "workpiece/levelled"}) {
    write_filled(10);
    {
      silence_hdf5();
      const auto file =
          hdf5_checked(H5Fopen(path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "file");
      hdf5_check(H5Ldelete(file, gone, H5P_DEFAULT), gone);
    }
    EXPECT_NE(refusal(path()).find("a damaged recording ("), std::string::npos) << gone;
  }
}

TEST_F(Fills, LevelsThatAreNotTheVoxelsAreRefused) {
  VoxelModel wrong = filled_workpiece();
  const LeafLevels& page = wrong.fills->pages().front();
  const auto at = std::ranges::find_if(page.levels, [](FillLevel level) { return level > 0; });
  wrong.leaves[page.leaf].reset(static_cast<int>(at - page.levels.begin()));
  RecordingWriter(path(), header(), wrong, nullptr).close();
  EXPECT_NE(
      refusal(path()).find("levels: of leaf " + std::to_string(page.leaf) + " not as its voxels"),
      std::string::npos)
      << refusal(path());
}

class EarlierFills : public Fills {
 protected:
  /// Some voxels of the workpiece went, others were lowered, all of one leaf went.
  EarlierFills() {
    before_.recording = "first.h5";
    before_.start = filled_workpiece();
    VoxelModel model = filled_workpiece();
    const VoxelGrid& grid = model.grid;
    std::uint64_t tick = 1;
    std::optional<std::uint32_t> emptied;
    for (std::uint32_t voxel = 0; voxel < grid.cell_count(); ++voxel) {
      const Cell c = grid.cell_of_linear(voxel);
      const FillLevel level = model.level(c);
      if (level == 0) continue;
      if (!emptied) emptied = grid.leaf_of(c);
      const bool all = grid.leaf_of(c) == *emptied;
      if (!all && voxel % 31 != 0) continue;
      ++tick;
      if (level > 2)
        before_.edits.push_back({tick, voxel, 0, EditCause::kCut, FillLevel(level / 2)});
      if (all || voxel % 3 == 0) before_.edits.push_back({++tick, voxel, 0, EditCause::kCut});
    }
    for (const Edit& edit : before_.edits) apply_edit(edit, model);
    now_ = unpack(pack(model));
  }
  RecordingReader written() const {
    RecordingWriter(path(), header(), now_, nullptr, {}, {{}, nullptr, nullptr, &before_}).close();
    return RecordingReader(path());
  }
  EarlierRun before_;
  VoxelModel now_;
};

TEST_F(EarlierFills, OfARunBeforeAreReadBack) {
  const std::optional<EarlierRun> read = written().earlier();
  ASSERT_TRUE(read);
  ASSERT_EQ(read->edits.size(), before_.edits.size());
  for (std::size_t i = 0; i < read->edits.size(); ++i) {
    ASSERT_TRUE(same(read->edits[i], before_.edits[i])) << i;
    ASSERT_EQ(read->edits[i].level, before_.edits[i].level) << i;
  }
  EXPECT_EQ(read->start.leaves, before_.start.leaves);
  test::expect_equal_levels(read->start, before_.start);
}

TEST_F(EarlierFills, ThatDoNotLeadToTheWorkpieceAreRefused) {
  const auto refused = [this] {
    try {
      (void)written().earlier();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("read");
  };
  const auto lowered = std::ranges::find_if(before_.edits, [&](const Edit& edit) {
    return now_.level(now_.grid.cell_of_linear(edit.voxel)) == edit.level && edit.level > 1;
  });
  ASSERT_NE(lowered, before_.edits.end());
  --lowered->level;
  EXPECT_NE(refused().find("they do not lead to the workpiece"), std::string::npos) << refused();
  lowered->level = 254;
  EXPECT_NE(refused().find("a level that does not fall"), std::string::npos) << refused();
}

}  // namespace
}  // namespace sulcus::sample::fills_test
