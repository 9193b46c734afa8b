#include "engine/recording/recording_writer.hpp"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <sys/resource.h>
#include <sys/wait.h>

#include "engine/core/error.hpp"
#include "engine/recording/recording_reader.hpp"
#include "tests/recording/sample_recording.hpp"

namespace sulcus::sample::recording_writer_test {
namespace {

class RecordingWriterTest : public RecordingTest {};

TEST_F(RecordingWriterTest, WhatIsWrittenIsRead) {
  const RecordingReader reader(write_whole(1000));
  EXPECT_EQ(reader.missing(), "");
  EXPECT_EQ(reader.tick_count(), 1000u);
  EXPECT_EQ(reader.edit_count(), edits_end(1000));
  EXPECT_EQ(reader.state_hashes().size(), 100u);
  expect_same_header(reader.header());
  expect_true_prefix(reader);
  EXPECT_EQ(reader.grid().cells, workpiece().grid.cells);
  expect_same_workpiece(reader.workpiece(), workpiece());
  const auto mesh = reader.burr_mesh();
  ASSERT_TRUE(mesh.has_value());
  EXPECT_EQ(mesh->positions, burr().positions);
  EXPECT_EQ(mesh->triangles, burr().triangles);
}

TEST_F(RecordingWriterTest, OtherBodiesAreReadInTheirOrderWithTheirEdits) {
  EXPECT_TRUE(RecordingReader(write_whole(10)).bodies().empty());
  VoxelModel small = make_workpiece();
  small.grid.voxel_m = 1e-4;
  VoxelModel plain;
  plain.grid.cells = {8, 8, 16};
  plain.grid.voxel_m = 5e-5;
  plain.leaves.resize(2);
  plain.set({3, 4, 5}, true);
  RecordingWriter writer(path(), header(), workpiece(), nullptr, {}, {{&small, &plain}, nullptr});
  TickRecord row = tick(1);
  const std::array<Edit, 2> edits{Edit{1, plain.grid.linear({3, 4, 5}), 2, EditCause::kCut},
                                  Edit{1, 7, 1, EditCause::kCut}};
  row.edits_end = edits.size();
  seal(row);
  writer.append_edits(edits);
  writer.append_ticks({&row, 1});
  writer.close();

  const RecordingReader reader(path());
  EXPECT_EQ(reader.missing(), "");
  expect_same_workpiece(reader.workpiece(), workpiece());
  const std::vector<VoxelModel> read = reader.bodies();
  ASSERT_EQ(read.size(), 2u);
  expect_same_workpiece(read[0], small);
  expect_same_workpiece(read[1], plain);
  ASSERT_EQ(reader.edits().size(), 2u);
  EXPECT_EQ(reader.edits()[0].body, 2);
  EXPECT_EQ(reader.edits()[1].body, 1);
}

TEST_F(RecordingWriterTest, AGoalOnTheWorkpiecesGridIsReadBack) {
  EXPECT_FALSE(RecordingReader(write_whole(10)).goal());
  VoxelModel goal;
  goal.grid = workpiece().grid;
  goal.leaves.resize(goal.grid.leaf_count());
  goal.set({9, 10, 11}, true);
  RecordingWriter(path(), header(), workpiece(), nullptr, {}, {{}, &goal}).close();
  expect_same_workpiece(*RecordingReader(path()).goal(), goal);

  goal.grid.cells = {8, 8, 8};
  goal.leaves.resize(1);
  RecordingWriter(path(), header(), workpiece(), nullptr, {}, {{}, &goal}).close();
  EXPECT_THROW((void)RecordingReader(path()).goal(), InputError);
}

TEST_F(RecordingWriterTest, WhereTheFileOfTheWorkpieceLiesIsReadBack) {
  EXPECT_FALSE(RecordingReader(write_whole(10)).input());  // as in older recordings
  InputGeometry input;
  input.file_from_world = Eigen::Translation3d(0.1, -0.2, 0.3) *
                          Eigen::AngleAxisd(1.1, Eigen::Vector3d(2, -1, 2).normalized());
  input.sizes = {103, 94, 161};
  input.spacing_m = {1e-4, 2e-4, 3e-4};
  input.origin_m = {-0.01, 0.02, 0.5};
  input.direction = Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()).toRotationMatrix();
  RecordingWriter(path(), header(), workpiece(), nullptr, {}, {{}, nullptr, &input}).close();
  const auto read = RecordingReader(path()).input();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->numbers(), input.numbers());

  input.file_from_world.linear() *= 2.0;  // not rigid
  RecordingWriter(path(), header(), workpiece(), nullptr, {}, {{}, nullptr, &input}).close();
  EXPECT_THROW((void)RecordingReader(path()).input(), InputError);
}

TEST_F(RecordingWriterTest, AnEditOfABodyThatIsNotThereOrCannotBeLooseIsDamage) {
  const VoxelModel& other = workpiece();
  for (const Edit& wrong :
       {Edit{1, 0, 2, EditCause::kCut}, Edit{1, 0, 1, EditCause::kLoose},
        Edit{1, static_cast<std::uint32_t>(workpiece().grid.cell_count()), 0, EditCause::kCut}}) {
    RecordingWriter writer(path(), header(), workpiece(), nullptr, {}, {{&other}, nullptr});
    TickRecord row = tick(1);
    row.edits_end = 1;
    seal(row);
    writer.append_edits({&wrong, 1});
    writer.append_ticks({&row, 1});
    writer.close();
    const RecordingReader reader(path());
    EXPECT_EQ(reader.tick_count(), 0u);
    EXPECT_NE(reader.missing().find("row 0 of /edits is damaged"), std::string::npos);
  }
}

TEST_F(RecordingWriterTest, WithoutCuttingThereIsNoRowOfIt) {
  EXPECT_TRUE(RecordingReader(write_whole(10)).cutting().empty());
}

TEST_F(RecordingWriterTest, WhatWasCutIsReadTickByTick) {
  const auto cut = [](std::uint64_t number) {
    CuttingRecord row;
    row.tick = number;
    row.tangential_force_N[1] = 0.5 * static_cast<double>(number);
    row.spindle_rad_per_s = 700.0 - static_cast<double>(number);
    row.work_J = 1e-3 * static_cast<double>(number);
    seal(row);
    return row;
  };
  RecordingWriter writer(path(), header(), workpiece(), nullptr, {.cutting = true});
  for (std::uint64_t t = 1; t <= 300; ++t) {
    append(writer, t, t);
    if (t == 150) writer.flush();
    if (t > 290) continue;  // these have no row: they wait
    const CuttingRecord row = cut(t);
    writer.append_cutting({&row, 1});
  }
  EXPECT_THROW(writer.close(), std::runtime_error);
  const RecordingReader reader(path());
  ASSERT_EQ(reader.tick_count(), 290u);
  const auto rows = reader.cutting(100, 500);
  ASSERT_EQ(rows.size(), 190u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(std::memcmp(&rows[i], std::vector{cut(101 + i)}.data(), sizeof rows[i]), 0) << i;
  }
}

TEST_F(RecordingWriterTest, PiecesAreReadAsFarAsTheTicksGo) {
  RecordingWriter writer(path(), header(), workpiece(), nullptr, {.pieces = true});
  for (std::uint64_t t = 10; t <= 100; t += 10) {
    PieceRow piece{t / 10 - 1, t, 3 * t, 7, 0};
    PiecePoseRow pose{t, t / 10 - 1, {0, 0, 1e-3 * static_cast<double>(t)}, {1, 0, 0, 0}, 0};
    TakenAnswerRow late{t - 5, t, 0};
    seal(piece);
    seal(pose);
    seal(late);
    writer.append_piece(piece);
    writer.append_piece_pose(pose);
    writer.append_taken_answer(late);
  }
  append(writer, 1, 65);
  writer.close();
  const RecordingReader reader(path());
  EXPECT_EQ(reader.missing(), "");
  ASSERT_EQ(reader.pieces().size(), 6u);
  EXPECT_EQ(reader.pieces()[5].first_loose_edit, 180u);
  ASSERT_EQ(reader.piece_poses().size(), 6u);
  EXPECT_EQ(reader.piece_poses()[5].position_m[2], 0.06);
  ASSERT_EQ(reader.taken_answers().size(), 6u);
  EXPECT_EQ(reader.taken_answers()[5].asked, 55u);
}

TEST_F(RecordingWriterTest, RangesAreCutAtTheEnd) {
  const RecordingReader reader(write_whole(300));
  const auto rows = reader.ticks(200, 50);
  ASSERT_EQ(rows.size(), 50u);
  EXPECT_EQ(rows.front().tick, 201u);
  EXPECT_EQ(reader.ticks(290).size(), 10u);
  EXPECT_TRUE(reader.ticks(300).empty());
  EXPECT_TRUE(reader.ticks(5000, 7).empty());
  EXPECT_EQ(reader.edits(edits_end(10), edits_of(11)).front().tick, 11u);
}

TEST_F(RecordingWriterTest, WithoutLabelsBurrEditsOrTicks) {
  VoxelModel bare;
  bare.grid.cells = {8, 8, 8};
  bare.grid.voxel_m = 1e-4;
  bare.leaves.resize(1);
  RecordingWriter writer(path(), header(), bare, nullptr);
  writer.close();
  const RecordingReader reader(path());
  EXPECT_EQ(reader.missing(), "");
  EXPECT_EQ(reader.tick_count(), 0u);
  EXPECT_FALSE(reader.burr_mesh().has_value());
  expect_same_workpiece(reader.workpiece(), bare);
}

TEST_F(RecordingWriterTest, ALongSceneFits) {
  RecordingHeader long_header = header();
  for (int i = 0; i < 20000; ++i) long_header.scene_toml += "points_mm = 1\n";
  RecordingWriter writer(path(), long_header, workpiece(), nullptr);
  writer.close();
  EXPECT_EQ(RecordingReader(path()).header().scene_toml, long_header.scene_toml);
}

TEST_F(RecordingWriterTest, EditsOfATickMaySpanFlushes) {
  RecordingWriter writer(path(), header(), workpiece(), nullptr);
  const auto six = edits(6);
  for (std::uint64_t t = 1; t <= 5; ++t) append(writer, t, t);
  writer.append_edits(std::span(six).first(2));
  writer.flush();
  writer.append_edits(std::span(six).subspan(2));
  const TickRecord row = tick(6);
  writer.append_ticks({&row, 1});
  append(writer, 7, 9);
  writer.close();
  const RecordingReader reader(path());
  EXPECT_EQ(reader.missing(), "");
  EXPECT_EQ(reader.tick_count(), 9u);
  expect_true_prefix(reader);
}

TEST_F(RecordingWriterTest, ATickWaitsForItsEdits) {
  {
    RecordingWriter writer(path(), header(), workpiece(), nullptr);
    append(writer, 1, 5);
    const TickRecord row = tick(6);
    writer.append_ticks({&row, 1});  // its six edits are never given
    EXPECT_THROW(writer.close(), std::runtime_error);
  }
  const RecordingReader reader(path());
  EXPECT_EQ(reader.tick_count(), 5u);
  EXPECT_EQ(reader.missing(), "recording ends at tick 5: it was not closed cleanly");
  expect_true_prefix(reader);
}

TEST_F(RecordingWriterTest, WithoutCloseRowsAreKeptAndItIsSaid) {
  {
    RecordingWriter writer(path(), header(), workpiece(), nullptr);
    append(writer, 1, 77);
  }
  const RecordingReader reader(path());
  EXPECT_EQ(reader.tick_count(), 77u);
  EXPECT_EQ(reader.missing(), "recording ends at tick 77: it was not closed cleanly");
}

TEST_F(RecordingWriterTest, ACallerWhoNeverFlushesIsHelped) {
  {
    RecordingWriter writer(path(), header(), workpiece(), nullptr);
    TickRecord row;
    for (row.tick = 0; row.tick < 10000; ++row.tick) {
      seal(row);
      writer.append_ticks({&row, 1});
    }
    std::filesystem::copy_file(path(), path("seen.h5"));
  }
  EXPECT_GT(RecordingReader(path("seen.h5")).tick_count(), 4000u);
  EXPECT_EQ(RecordingReader(path()).tick_count(), 10000u);
}

TEST_F(RecordingWriterTest, AnEarlierRecordingIsReplaced) {
  write_whole(500);
  write_whole(20);
  const RecordingReader reader(path());
  EXPECT_EQ(reader.tick_count(), 20u);
  EXPECT_EQ(reader.missing(), "");
}

TEST_F(RecordingWriterTest, ARunThatNeverBeganLeavesWhatWasThere) {
  write_whole(100);
  { RecordingWriter writer(path(), header(), workpiece(), nullptr); }
  EXPECT_EQ(RecordingReader(path()).tick_count(), 100u);
  EXPECT_FALSE(std::filesystem::exists(path() + ".part"));
}

TEST_F(RecordingWriterTest, UnwritablePathsAreBadUsage) {
  const auto message = [](const std::string& where) -> std::string {
    try {
      RecordingWriter writer(where, header(), workpiece(), nullptr);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string folder = message(folder_.string());
  EXPECT_EQ(folder, folder_.string() + ": found a folder, expected a file to record into");
  const std::string nowhere = message(path("no/such/folder.h5"));
  EXPECT_NE(nowhere.find("No such file or directory"), std::string::npos) << nowhere;
  EXPECT_EQ(nowhere.find('\n'), std::string::npos);
  EXPECT_NE(message("/dev/null").find("no regular file"), std::string::npos);
  EXPECT_NE(message("").find("found a path that cannot be written"), std::string::npos);
}

TEST_F(RecordingWriterTest, UseAfterCloseIsRefused) {
  RecordingWriter writer(path(), header(), workpiece(), nullptr);
  writer.close();
  EXPECT_THROW(append(writer, 1, 1), std::runtime_error);
  EXPECT_THROW(writer.flush(), std::runtime_error);
  EXPECT_EQ(RecordingReader(path()).missing(), "");
}

/// In a process of its own, whose files may not grow beyond 200 kB: as if the disk were full.
/// Exits with the number of flushes of ten ticks that went well, 0 where anything else is wrong.
[[noreturn]] void record_on_a_full_disk(const std::string& where) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{200'000, 200'000};
  setrlimit(RLIMIT_FSIZE, &limit);
  int flushed = 0;
  bool told_twice = false;
  try {
    RecordingWriter writer(where, header(), workpiece(), nullptr);
    std::string first;
    try {
      for (;; ++flushed) {
        append(writer, static_cast<std::uint64_t>(flushed) * 10 + 1,
               static_cast<std::uint64_t>(flushed) * 10 + 10);
        writer.flush();
      }
    } catch (const std::runtime_error& error) {
      first = error.what();
    }
    try {
      writer.close();
    } catch (const std::runtime_error& error) {
      told_twice = first == error.what() && first.find("File too large") != std::string::npos &&
                   first.find('\n') == std::string::npos;
    }
  } catch (...) {
    _exit(0);
  }
  std::exit(told_twice ? flushed : 0);  // and whatever HDF5 does at exit goes well too
}

TEST_F(RecordingWriterTest, AFullDiskKeepsWhatWasFlushed) {
  std::fflush(nullptr);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) record_on_a_full_disk(path());
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  const int flushed = WEXITSTATUS(status);
  ASSERT_GT(flushed, 5);
  const RecordingReader reader(path());
  EXPECT_GE(reader.tick_count(), 10u * static_cast<unsigned>(flushed));
  EXPECT_NE(reader.missing(), "");
  expect_true_prefix(reader);
  expect_same_workpiece(reader.workpiece(), workpiece());
}

}  // namespace
}  // namespace sulcus::sample::recording_writer_test
