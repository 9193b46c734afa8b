// Recordings of the whole program when things go wrong, and what can be made of one.
#include <csignal>
#include <cstring>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "engine/recording/recording_reader.hpp"
#include "engine/recording/recording_writer.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::recording_test {
namespace {

/// Some 2,200 ticks, and 8,800, which no pace is through with in 60 ms.
constexpr const char* kSlowly = "trajectory.speed_mm_per_s=0.8";
constexpr const char* kForLong = "trajectory.speed_mm_per_s=0.2";

class Recording : public ::testing::Test {
 protected:
  test::CommandResult command(const std::string& arguments,
                              const std::string& environment = "SULCUS_CACHE=off") {
    return test::sulcus_command(arguments, scratch_.path("err"), environment);
  }
  std::string record(const std::string& name, const std::string& options = {}) {
    const std::string scene = scratch_.write("s.toml", test::cut_scene());
    const auto result = command("run " + scene + " " + options + " -o " + scratch_.path(name));
    EXPECT_EQ(result.status, 0) << result.err;
    return scratch_.path(name) + "/recording.h5";
  }
  /// Starts a run that lasts.
  static pid_t start(const std::string& scene, const std::string& pace, const std::string& folder) {
    const pid_t child = fork();
    if (child != 0) return child;
    const int nowhere = open("/dev/null", O_RDWR);
    for (const int stream : {0, 1, 2}) dup2(nowhere, stream);
    execl(SULCUS_PROGRAM, "sulcus", "run", scene.c_str(), "--pace", pace.c_str(), "--set", kForLong,
          "-o", folder.c_str(), nullptr);
    _exit(127);
  }
  /// Until a file is there, but not for ever.
  static void wait_for(const std::string& file) {
    for (int ms = 0; access(file.c_str(), F_OK) != 0 && ms < 60'000; ++ms) usleep(1000);
  }
  /// Starts a run and kills it.
  std::string killed(const std::string& pace, unsigned after_us) {
    const std::string scene = scratch_.write("s.toml", test::cut_scene());
    const std::string folder = scratch_.path("killed");
    std::filesystem::remove_all(folder);
    const pid_t child = start(scene, pace, folder);
    const std::string file = folder + "/recording.h5";
    wait_for(file);
    usleep(after_us);
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    return file;
  }
  ScratchFolder scratch_;
};

bool same_result(TickRecord a, TickRecord b) {
  for (TickRecord* row : {&a, &b}) row->step_us = row->late_us = 0.0f, row->check = 0;
  return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST_F(Recording, AKilledRunIsAnUndisturbedOneCutShortAndCanBeRepaired) {
  const std::string whole = record("whole", std::string("--set ") + kForLong);
  const std::vector<TickRecord> expected = RecordingReader(whole).ticks();
  const std::vector<Edit> edits = RecordingReader(whole).edits();
  std::size_t most = 0;
  for (const auto& [pace, after_us] :
       {std::pair{"real", 200'000u}, std::pair{"real", 500'000u}, std::pair{"fast", 60'000u}}) {
    const std::string file = killed(pace, after_us);
    std::vector<TickRecord> rows;
    {
      const RecordingReader reader(file);
      rows = reader.ticks();
      ASSERT_LE(rows.size(), expected.size());
      for (std::size_t i = 0; i < rows.size(); ++i) {
        ASSERT_TRUE(same_result(rows[i], expected[i])) << i;
      }
      const std::vector<Edit> found = reader.edits();
      for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i].voxel, edits[i].voxel);
    }
    most = std::max(most, rows.size());
    const std::string repaired = scratch_.path("repaired.h5");
    std::filesystem::remove(repaired);
    const auto result = command("repair " + file + " -o " + repaired);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_TRUE(opens_without_swmr(repaired));
    const RecordingReader reader(repaired);
    EXPECT_EQ(reader.missing(), "");
    EXPECT_NE(reader.header().repaired.find("not closed cleanly"), std::string::npos);
    ASSERT_EQ(reader.tick_count(), rows.size());
    if (!rows.empty()) {
      EXPECT_EQ(std::memcmp(reader.ticks().data(), rows.data(), rows.size() * sizeof rows[0]), 0);
      EXPECT_EQ(command("replay --verify " + repaired).status, 0);
    }
  }
  EXPECT_GT(most, 50u);
}

TEST_F(Recording, RepairWritesOverNothing) {
  const std::string file = record("out");
  EXPECT_EQ(command("repair " + file + " -o " + file).status, 2);
  const std::string there = scratch_.write("there.h5", "mine");
  const auto result = command("repair " + file + " -o " + there);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("found a file that already exists"), std::string::npos) << result.err;
  EXPECT_EQ(test::read_file(there), "mine");
}

TEST_F(Recording, RepairedInWholeNothingIsLost) {
  const std::string scene = scratch_.write("post.toml", test::post_scene());
  ASSERT_EQ(command("run " + scene + " -o " + scratch_.path("out")).status, 0);
  const std::string file = scratch_.path("out/recording.h5"), copy = scratch_.path("copy.h5");
  ASSERT_EQ(command("repair " + file + " -o " + copy).status, 0);
  const RecordingReader a(file), b(copy);
  EXPECT_EQ(a.tick_count(), b.tick_count());
  EXPECT_EQ(a.edit_count(), b.edit_count());
  EXPECT_EQ(a.keyframes().size(), b.keyframes().size());
  EXPECT_EQ(a.state_hashes().size(), b.state_hashes().size());
  EXPECT_EQ(a.pieces().size(), b.pieces().size());
  EXPECT_EQ(a.piece_poses().size(), b.piece_poses().size());
  EXPECT_EQ(a.taken_answers().size(), b.taken_answers().size());
  EXPECT_EQ(b.header().repaired, "");
  const auto verified = command("replay --verify " + copy);
  EXPECT_EQ(verified.status, 0) << verified.err;
}

TEST_F(Recording, OneThatGoesOnUnderTheSameSettingsIsTheSame) {
  const std::string file = record("out");
  const auto result = command("replay " + file + " --from 0.25 -o " + scratch_.path("on"));
  ASSERT_EQ(result.status, 0) << result.err;
  const RecordingReader before(file), on(scratch_.path("on/recording.h5"));
  EXPECT_EQ(on.missing(), "");
  EXPECT_EQ(on.header().parent.find("recording.h5, after tick 250, scene_sha256 "), 0u);
  ASSERT_EQ(on.tick_count(), before.tick_count() - 251);
  const auto rows = on.ticks(), expected = before.ticks(251);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].tick, expected[i].tick);
    ASSERT_EQ(std::memcmp(rows[i].force_N, expected[i].force_N, sizeof rows[i].force_N), 0) << i;
  }
  EXPECT_EQ(on.state_hashes().back().volume, before.state_hashes().back().volume);
  EXPECT_EQ(on.state_hashes().back().state, before.state_hashes().back().state);
  // It is a recording as any other, without its parent.
  std::filesystem::remove_all(scratch_.path("out"));
  const auto verified = command("replay --verify " + scratch_.path("on/recording.h5"));
  EXPECT_EQ(verified.status, 0) << verified.err;
  EXPECT_EQ(command("replay --verify --from 0.4 " + scratch_.path("on/recording.h5")).status, 0);
}

TEST_F(Recording, GoesOnWhereLeavesHaveLostATissue) {
  const std::string file = scratch_.path("deep/recording.h5");
  const auto run = command("run " SULCUS_SOURCE_DIR
                           "/scenes/enamel_to_dentine.toml --set workpiece.voxel_mm=0.12 --set "
                           "'workpiece.cells=[112, 112, 208]' --set burr.diameter_mm=2 --set "
                           "trajectory.speed_mm_per_s=2 -o " +
                           scratch_.path("deep"));
  ASSERT_EQ(run.status, 0) << run.err;
  const auto result = command("replay " + file + " --from 1.5 -o " + scratch_.path("on"));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto verified = command("replay --verify " + scratch_.path("on/recording.h5"));
  EXPECT_EQ(verified.status, 0) << verified.err;
}

TEST_F(Recording, GoesOnUnderOtherSettings) {
  const std::string file = record("out");
  const auto result = command("replay " + file +
                              " --from 0.25 --set burr.tangential_ratio=0.6 --set "
                              "haptics.scaling=count -o " +
                              scratch_.path("on"));
  ASSERT_EQ(result.status, 0) << result.err;
  const RecordingReader before(file), on(scratch_.path("on/recording.h5"));
  EXPECT_NE(on.edit_count(), before.edit_count());
  EXPECT_EQ(command("replay --verify " + scratch_.path("on/recording.h5")).status, 0);
  for (const std::string set :
       {"workpiece.voxel_mm=0.1", "trajectory.speed_mm_per_s=1", "'body=[]'",
        "'tissue=[\"enamel\", \"pulp\"]'", "'haptics={normals=\"ldm_fast\", rate_hz=500}'"}) {
    const auto refused = command("replay " + file + " --from 0.25 --set " + set);
    EXPECT_EQ(refused.status, 2) << set;
    EXPECT_NE(refused.err.find("fixed by the recording"), std::string::npos);
  }
  EXPECT_EQ(command("replay " + file + " --set haptics.scaling=count").status, 2);
  EXPECT_EQ(command("replay " + file + " --from 99").status, 2);
}

TEST_F(Recording, GoesOnWithAnotherBurr) {
  const std::string file = record("out");
  const std::string on = scratch_.path("on/recording.h5");
  const auto result = command("replay " + file +
                              " --from 0.25 --set burr.shape=fissure --set "
                              "burr.diameter_mm=0.8 -o " +
                              scratch_.path("on"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(RecordingReader(file).edit_count(), RecordingReader(on).edit_count());
  const auto verified = command("replay --verify " + on);  // it carries the burr
  EXPECT_EQ(verified.status, 0) << verified.err;
  // The whole table is another burr as well.
  const std::string table = scratch_.path("table/recording.h5");
  const auto whole = command("replay " + file +
                             " --from 0.25 --set 'burr={shape=\"fissure\", diameter_mm=0.8}' -o " +
                             scratch_.path("table"));
  ASSERT_EQ(whole.status, 0) << whole.err;
  EXPECT_NE(RecordingReader(file).edit_count(), RecordingReader(table).edit_count());
  const auto refused = command("replay " + file + " --from 0.25 --set burr.shape=fissur");
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("fissure"), std::string::npos) << refused.err;
}

TEST_F(Recording, IsATrajectory) {
  const std::string file = record("out");
  const std::string scene = scratch_.path("scene.toml");
  std::ofstream(scene) << RecordingReader(file).header().scene_toml;
  const auto result = command("run " + scene + " --set trajectory.recording=" + file + " -o " +
                              scratch_.path("again"));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto rows = RecordingReader(file).ticks(),
             again = RecordingReader(scratch_.path("again/recording.h5")).ticks();
  ASSERT_EQ(again.size(), rows.size());
  double most_N = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(again[i].device_position_m[a], rows[i].device_position_m[a], 1e-15) << i;
      most_N = std::max(most_N, std::abs(rows[i].force_N[a]));
    }
  }
  EXPECT_GT(most_N, 0.01);
  const auto missing = command("run " + scene + " --set trajectory.recording=none.h5");
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.err.find("none.h5"), std::string::npos) << missing.err;
}

TEST_F(Recording, OfEveryPaceAndNumberOfThreadsVerifies) {
  for (const std::string options : {"--threads 1", "--threads 2", "--pace real --no-render"}) {
    const std::string file = record("out", options);
    for (const char* threads : {"1", "2", "4"}) {
      EXPECT_EQ(command(std::string("replay --verify --threads ") + threads + " " + file).status,
                0);
    }
    // Where the processor lacks one, by the last that it has.
    for (const char* set :
         {"SULCUS_INSTRUCTIONS=plain", "SULCUS_INSTRUCTIONS=avx2", "SULCUS_INSTRUCTIONS=avx512"}) {
      const auto result =
          command("replay --verify " + file, std::string("SULCUS_CACHE=off ") + set);
      EXPECT_EQ(result.status, 0) << set << result.err;
    }
  }
}

TEST_F(Recording, IsNotWrittenOverByWhatGoesOnFromIt) {
  const std::string file = record("out");
  const std::string before = test::read_file(file);
  for (const std::string from : {"", " --from 0.1"}) {
    const auto refused = command("replay " + file + from + " -o " + scratch_.path("out"));
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.err.find("the folder of the recording itself"), std::string::npos);
  }
  EXPECT_EQ(test::read_file(file), before);
  EXPECT_EQ(command("replay --verify " + file + " --from 0.1 --set haptics.scaling=count").status,
            2);
}

/// A recording made over by hand: rows and edits as they were, states as given.
std::string made_over(const std::string& from, const std::string& to,
                      const std::function<void(RecordingWriter&, const RecordingReader&)>& states,
                      EditCause cause = EditCause::kCut) {
  const RecordingReader reader(from);
  RecordingWriter writer(to, reader.header(), reader.workpiece(), nullptr, reader.tables());
  std::vector<Edit> edits = reader.edits();
  if (!edits.empty()) edits.back().cause = cause;
  writer.append_edits(edits);
  writer.append_cutting(reader.cutting());
  writer.append_ticks(reader.ticks());
  states(writer, reader);
  writer.close();
  return to;
}

TEST_F(Recording, AStateOfAnotherTickIsNoState) {
  const std::string forged = made_over(
      record("out"), scratch_.path("forged.h5"), [](RecordingWriter& writer, const auto& reader) {
        const auto state = reader.keyframe(reader.keyframes().front());
        writer.append_keyframe(reader.keyframes().front().tick + 50, state.value());
      });
  // It is passed over, and the ticks from the start run again.
  const auto result = command("replay --verify --from 0.3 " + forged);
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST_F(Recording, ALoosePieceThatNoSceneLetsGoIsRefused) {
  const std::string forged = made_over(
      record("out"), scratch_.path("forged.h5"), [](auto&, const auto&) {}, EditCause::kLoose);
  const auto result = command("replay --verify " + forged);
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("found a piece cut loose"), std::string::npos) << result.err;
}

TEST_F(Recording, ADamagedRowThatHidesTheRestIsNotVerified) {
  const std::string file = record("out");
  std::string bytes = test::read_file(file);
  const RecordingReader reader(file);
  const TickRecord row = reader.ticks(200, 1).front();
  const std::size_t at =
      bytes.find(std::string_view(reinterpret_cast<const char*>(&row), sizeof row));
  ASSERT_NE(at, std::string::npos);
  bytes[at + 40] ^= 1;
  const auto result = command("replay --verify " + scratch_.write("damaged.h5", bytes));
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("verified 200 of " + std::to_string(reader.tick_count()) +
                            " ticks: row 200 of /ticks is damaged"),
            std::string::npos)
      << result.err;
}

TEST_F(Recording, RepairSaysWhichStatesAreDamaged) {
  const std::string file = record("out");
  std::string bytes = test::read_file(file);
  const RecordingReader reader(file);
  const auto state = reader.keyframe(reader.keyframes().back()).value();
  // Its first bytes, which lie together in the file.
  const std::size_t at =
      bytes.find(std::string_view(reinterpret_cast<const char*>(state.data()), 400));
  ASSERT_NE(at, std::string::npos);
  bytes[at + 100] ^= 1;
  const std::string damaged = scratch_.write("damaged.h5", bytes);
  const auto result = command("repair " + damaged + " -o " + scratch_.path("repaired.h5"));
  EXPECT_EQ(result.status, 0);
  const std::size_t states = reader.keyframes().size();
  EXPECT_NE(result.out.find("1 of " + std::to_string(states) + " states in /keyframes are damaged"),
            std::string::npos)
      << result.out;
  EXPECT_EQ(RecordingReader(scratch_.path("repaired.h5")).keyframes().size(), states - 1);
}

/// A disk that stalls once: after so many seconds, for so many.
class StallingDisk : public Recording {
 protected:
  void run(const std::string& options, const std::string& stall_s = "0.15,0.3") {
    const std::string scene = scratch_.write("s.toml", test::cut_scene());
    const auto result =
        command("run " + scene + " --pace real -o " + scratch_.path("out") + " " + options,
                "SULCUS_CACHE=off SULCUS_STALL=" + stall_s +
                    " ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD=" SULCUS_STALLING_DISK);
    ASSERT_EQ(result.status, 0) << result.err;
  }
  /// Stalls for as long as a tenth of a second of rows takes, on however slow a machine.
  void run_past_the_queue(const std::string& options) {
    for (double for_s = 0.3; for_s < 40.0; for_s *= 2.0) {
      run("--set record.queue_s=0.1 " + options, "0.15," + std::to_string(for_s));
      if (!RecordingReader(file()).gaps().empty()) return;
    }
  }
  std::string file() const { return scratch_.path("out/recording.h5"); }
};

TEST_F(StallingDisk, LosesNothingAsLongAsTheQueueLasts) {
  run("");
  const RecordingReader whole(record("whole")), reader(file());
  EXPECT_EQ(reader.tick_count(), whole.tick_count());
  EXPECT_TRUE(reader.gaps().empty());
  EXPECT_EQ(command("replay --verify " + file()).status, 0);
}

TEST_F(StallingDisk, KeepsStatesWaitingSoThatTheyTakeNoMoreMemory) {
  run(std::string("--set haptics.rate_hz=4000 --set ") + kSlowly, "0.15,0.8");
  const auto states = RecordingReader(file()).keyframes();
  std::vector<std::uint64_t> apart;
  for (std::size_t i = 1; i < states.size(); ++i) {
    apart.push_back(states[i].tick - states[i - 1].tick);
  }
  std::ranges::sort(apart);
  ASSERT_GE(apart.size(), 8u);
  EXPECT_GT(apart.back(), 3 * apart[apart.size() / 2]);
  EXPECT_EQ(command("replay --verify " + file()).status, 0);
}

TEST_F(StallingDisk, PastThatItLosesNoEditAndSaysWhichRows) {
  run_past_the_queue(std::string("--set ") + kSlowly);
  const RecordingReader expected(record("whole", std::string("--set ") + kSlowly)), reader(file());
  EXPECT_EQ(reader.missing(), "");
  ASSERT_EQ(reader.gaps().size(), 1u);
  const RecordingGap gap = reader.gaps()[0];
  EXPECT_EQ(reader.tick_count() + gap.end - gap.first, expected.tick_count());
  EXPECT_EQ(reader.edit_count(), expected.edit_count());
  EXPECT_EQ(reader.state_hashes().back().volume, expected.state_hashes().back().volume);
  const auto summary = nlohmann::json::parse(test::read_file(scratch_.path("out/summary.json")));
  EXPECT_EQ(summary["faults"]["rows_dropped"], gap.end - gap.first);
  EXPECT_EQ(summary["ticks"], expected.tick_count());

  const auto verified = command("replay --verify " + file());
  EXPECT_EQ(verified.status, 0) << verified.err;
  EXPECT_NE(verified.out.find(": 1 ticks after rows that were not recorded"), std::string::npos)
      << verified.out;
  const auto again = command("replay " + file() + " -o " + scratch_.path("again"));
  EXPECT_EQ(again.status, 0);
  EXPECT_NE(again.err.find("after which rows were not recorded"), std::string::npos) << again.err;
  const std::string said = command("inspect " + file()).out;
  EXPECT_NE(said.find("not recorded     ticks " + std::to_string(gap.first) + " to " +
                      std::to_string(gap.end - 1)),
            std::string::npos)
      << said;
  // Into the gap nothing leads on.
  const std::string within = std::to_string(1e-3 * static_cast<double>(gap.first + 5));
  const auto refused = command("replay " + file() + " --from " + within);
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("a time before ticks that were not recorded"), std::string::npos)
      << refused.err;
  const std::string after = " --from " + std::to_string(1e-3 * static_cast<double>(gap.end + 20));
  const auto on = command("replay " + file() + after + " -o " + scratch_.path("on"));
  EXPECT_EQ(on.status, 0) << on.err;
  EXPECT_EQ(command("replay --verify " + file() + after).status, 0);
}

TEST_F(StallingDisk, TheLastRowIsThereWhereTheRunEndsBeforeTheDiskIsBack) {
  run_past_the_queue("");
  const RecordingReader reader(file());
  EXPECT_EQ(reader.missing(), "");
  ASSERT_EQ(reader.gaps().size(), 1u);
  EXPECT_EQ(reader.ticks().back().tick + 1, RecordingReader(record("whole")).tick_count());
  EXPECT_EQ(command("replay --verify " + file()).status, 0);
}

TEST_F(Recording, AFullDiskEndsTheRecordingNotTheRun) {
  const std::string scene = scratch_.write("s.toml", test::cut_scene());
  // No file may be longer than 200 KiB: as a full disk, but for the others.
  const std::string limited = "sh -c \"ulimit -f 400; trap '' XFSZ; exec " SULCUS_PROGRAM " run " +
                              scene + " --pace real --set " + kSlowly + " -o " +
                              scratch_.path("out") + "\"";
  const auto result = test::program_command(limited, "", scratch_.path("err"), "SULCUS_CACHE=off");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("recording.h5: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("File too large"), std::string::npos) << result.err;
  const std::string file = scratch_.path("out/recording.h5");
  const RecordingReader reader(file);
  EXPECT_GT(reader.tick_count(), 20u);
  EXPECT_LT(reader.tick_count(), 2200u);
  EXPECT_EQ(command("replay --verify " + file).status, 0);
}

TEST_F(Recording, ARendererThatDiesLeavesTheRecordingWhole) {
  const std::string scene = scratch_.write("s.toml", test::render_scene());
  std::filesystem::create_directories(scratch_.path("out/frames/000001.png"));  // in its way
  const auto result = command("run " + scene + " -o " + scratch_.path("out"));
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("000001.png"), std::string::npos) << result.err;
  const std::string file = scratch_.path("out/recording.h5");
  EXPECT_EQ(RecordingReader(file).missing(), "");
  EXPECT_EQ(command("replay --verify " + file).status, 0);
}

TEST_F(Recording, SigtermEndsARunAsCtrlCDoes) {
  const std::string scene = scratch_.write("s.toml", test::cut_scene());
  for (const int signal : {SIGTERM, SIGINT}) {
    const std::string folder = scratch_.path("out" + std::to_string(signal));
    const pid_t child = start(scene, "real", folder);
    wait_for(folder + "/recording.h5");
    usleep(200'000);
    kill(child, signal);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 128 + signal) << status;
    const RecordingReader reader(folder + "/recording.h5");
    EXPECT_EQ(reader.missing(), "");
    EXPECT_GT(reader.tick_count(), 20u);
    EXPECT_LT(reader.tick_count(), 2000u);
  }
}

}  // namespace
}  // namespace sulcus::recording_test
