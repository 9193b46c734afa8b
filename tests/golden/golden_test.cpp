// What the program computed of the scenes here when their results were last decided on: hashes and
// counts in the file beside each scene, the same under every instruction set. A change of them is a
// decision, which its commit names;
//
//     SULCUS_GOLDEN=write build/release/tests/sulcus_golden_tests
//
// writes them anew. In tests/recording, version_1.h5 and version_2.h5 are recordings of earlier
// builds; state_3.h5 has states of the third layout and the forces of today.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/energy_balance.hpp"
#include "tests/support/command.hpp"
#include "tests/support/instruction_sets.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::golden_test {
namespace {

using test::sulcus_command;

const std::string kFolder = SULCUS_SOURCE_DIR "/tests/golden/";

bool writes() {
  const char* asked = std::getenv("SULCUS_GOLDEN");
  return asked && std::string(asked) == "write";
}

std::vector<std::string> scenes() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string hex(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

/// All of a run that the machine has no part in.
nlohmann::ordered_json results_of(const std::string& folder) {
  const auto summary = nlohmann::json::parse(test::read_file(folder + "/summary.json"));
  const RecordingReader recording(folder + "/recording.h5");
  std::uint64_t contacts = 0, tested = 0;
  for (const TickRecord& row : recording.ticks()) {
    contacts += row.contacts;
    tested += row.tested;
  }
  nlohmann::ordered_json results;
  results["ticks"] = recording.ticks().size();
  results["contacts"] = contacts;
  results["tested"] = tested;
  results["edits"] = recording.edits().size();
  results["fragments"] = summary.value("fragments", nlohmann::json());
  results["faults"] = summary["faults"];
  results["volume_hash"] = summary["volume_hash"];
  results["force_hash"] = summary["force_hash"];
  results["state_hash"] = hex(recording.state_hashes().back().state);
  return results;
}

using SceneAndSet = std::tuple<std::string, InstructionSet>;
class Golden : public ::testing::TestWithParam<SceneAndSet> {
 protected:
  const ScratchFolder scratch_;
};

TEST_P(Golden, ResultsAreThoseDecidedOn) {
  const auto& [name, set] = GetParam();
  if (set > instruction_set()) GTEST_SKIP() << "this processor has no " << test::set_name(set);
  const auto run = sulcus_command(
      "run " + kFolder + name + ".toml --no-render -o " + scratch_.path("out"),
      scratch_.path("err"), "SULCUS_CACHE=off SULCUS_INSTRUCTIONS=" + test::set_name(set));
  ASSERT_EQ(run.status, 0) << run.err;
  const auto summary = nlohmann::json::parse(test::read_file(scratch_.path("out/summary.json")));
  if (summary.value("tangential_work_J", 0.0) > 0.0) test::expect_energies_balance(summary);
  const auto results = results_of(scratch_.path("out"));
  if (writes()) {
    std::ofstream(kFolder + name + ".json") << results.dump(2) << '\n';
    return;
  }
  EXPECT_EQ(results.dump(2) + "\n", test::read_file(kFolder + name + ".json"));
}

std::string name_of(const ::testing::TestParamInfo<SceneAndSet>& run) {
  return std::get<0>(run.param) + "_" + test::set_name(std::get<1>(run.param));
}
INSTANTIATE_TEST_SUITE_P(Scenes, Golden,
                         ::testing::Combine(::testing::ValuesIn(scenes()),
                                            ::testing::Values(InstructionSet::kPlain,
                                                              InstructionSet::kAvx2,
                                                              InstructionSet::kAvx512)),
                         name_of);

/// A recording by an earlier build, and a tick after which this one can go on from it: where no
/// tick up to it comes out otherwise now, or where a state was recorded.
struct Earlier {
  std::string name;
  std::uint64_t tick = 0;
};

class EarlierRecordings : public ::testing::TestWithParam<Earlier> {
 protected:
  test::CommandResult sulcus(const std::string& arguments) {
    return sulcus_command(arguments, scratch_.path("err"));
  }
  const std::string file_ = SULCUS_SOURCE_DIR "/tests/recording/" + GetParam().name + ".h5";
  const ScratchFolder scratch_;
};

TEST_P(EarlierRecordings, AreDrawnExportedAndGoneOnFromByTheirEdits) {
  EXPECT_EQ(sulcus("export " + file_ + " --mesh " + scratch_.path("m.stl") + " --csv " +
                   scratch_.path("t.csv"))
                .status,
            0);
  const auto drawn =
      sulcus("render " + file_ + " --at 0.05 --size 160x120 -o " + scratch_.path("r"));
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  const std::uint64_t tick = GetParam().tick;
  const auto gone_on =
      sulcus("replay " + file_ + " --from " + std::to_string(1e-3 * static_cast<double>(tick)) +
             " -o " + scratch_.path("from"));
  ASSERT_EQ(gone_on.status, 0) << gone_on.err;
  const RecordingReader before(file_), after(scratch_.path("from/recording.h5"));
  ASSERT_EQ(after.ticks().front().tick, tick + 1);
  EXPECT_EQ(after.ticks().size(), before.ticks().size() - tick - 1);
  VoxelModel then = before.workpiece();
  for (const Edit& edit : before.edits()) {
    if (edit.body == 0 && edit.tick <= tick) then.set(then.grid.cell_of_linear(edit.voxel), false);
  }
  EXPECT_TRUE(then.leaves == after.workpiece().leaves);
  test::expect_energies_balance(
      nlohmann::json::parse(test::read_file(scratch_.path("from/summary.json"))), false);
}

INSTANTIATE_TEST_SUITE_P(Versions, EarlierRecordings,
                         ::testing::Values(Earlier{"version_1", 40}, Earlier{"version_2", 199},
                                           Earlier{"state_3", 120}),
                         [](const auto& earlier) { return earlier.param.name; });

TEST(EarlierRecording, OfTheForcesOfTodayIsVerified) {
  const ScratchFolder scratch;
  const auto verified = sulcus_command(
      "replay " SULCUS_SOURCE_DIR "/tests/recording/state_3.h5 --verify", scratch.path("err"));
  EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
}

}  // namespace
}  // namespace sulcus::golden_test
