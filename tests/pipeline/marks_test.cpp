// What a run says of a run: marks of the whole where one goes on from another, and a recording that
// is enough for them by itself.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/recording/recording_reader.hpp"
#include "engine/recording/recording_writer.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::marks_test {
namespace {

using nlohmann::json;

/// Down through the roof of the pulp and on, in a coarse tooth.
const std::string kAttempt = R"(
tissue = ["enamel", "dentine", "pulp"]
[workpiece]
shape = "molar"
voxel_mm = 0.15
cells = [96, 88, 168]
[burr]
diameter_mm = 1.4
speed_rpm = 160000
field = [48, 192, 48]
[trajectory]
points_mm = [[0.46, -0.12, 6], [0.46, -0.12, 1.3], [1.2, -0.12, 1.3]]
speed_mm_per_s = 4
[haptics]
normals = "ldm_fast"
[cutting]
[goal]
shape = "box"
size_mm = [2, 2, 5]
position_mm = [0.46, 0, 3]
[record]
)";

class Marks : public testing::Test {
 protected:
  /// Runs a command that must succeed.
  test::CommandResult command(const std::string& arguments) {
    const auto result = test::sulcus_command(arguments, scratch_.path("err"));
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.err;
    return result;
  }
  json summary(const std::string& name) {
    return json::parse(test::read_file(scratch_.path(name) + "/summary.json"));
  }
  /// Recorded as "whole".
  std::string attempt() {
    command("run " + scratch_.write("attempt.toml", kAttempt) + " -o " + scratch_.path("whole"));
    return scratch_.path("whole/recording.h5");
  }
  const ScratchFolder scratch_;
};

TEST_F(Marks, OfARunThatWasGoneOnFromAreThoseOfTheWhole) {
  const std::string recording = attempt();
  const json whole = summary("whole");
  ASSERT_FALSE(whole["outcome"]["pulp_exposed_tick"].is_null());
  EXPECT_FALSE(whole.contains("parent"));
  const RecordingReader reader(recording);
  const double end_s = reader.ticks().back().time_s;
  const double exposed_s = whole["outcome"]["pulp_exposed_s"];
  const std::vector<Edit> edits = reader.edits();
  const double voxel_mm3 = 0.15 * 0.15 * 0.15;
  int after_exposure = 0;
  for (const double part : {0.2, 0.5, 0.8, 0.95}) {
    const std::string name = "on_" + std::to_string(part);
    command("replay " + recording + " --from " + std::to_string(part * end_s) + " -o " +
            scratch_.path(name));
    const json on = summary(name);
    EXPECT_EQ(on["outcome"], whole["outcome"]) << part;
    EXPECT_EQ(on["goal"], whole["goal"]) << part;
    EXPECT_EQ(on["workpiece_start"], whole["workpiece_start"]) << part;
    EXPECT_EQ(on["parent"]["recording"], recording);
    const std::uint64_t fork = on["parent"]["after_tick"];
    EXPECT_NEAR(on["parent"]["after_s"].get<double>(), part * end_s, 1.1e-3);
    EXPECT_EQ(on["since_fork"]["ticks"], on["ticks"]);
    // Its own part, by the edits of the parent.
    const auto own =
        std::ranges::count_if(edits, [&](const Edit& edit) { return edit.tick > fork; });
    double removed_mm3 = 0.0;
    for (const auto& [tissue, mm3] : on["since_fork"]["outcome"]["removed_mm3"]["cut"].items()) {
      removed_mm3 += mm3.get<double>();
    }
    EXPECT_NEAR(removed_mm3, static_cast<double>(own) * voxel_mm3, 1e-9) << part;
    after_exposure += part * end_s > exposed_s;
  }
  EXPECT_GT(after_exposure, 0) << "one goes on after the pulp was exposed";
}

TEST_F(Marks, OfARecordingAloneAreThoseOfTheWhole) {
  const json whole = (attempt(), summary("whole"));
  command("replay " + scratch_.path("whole/recording.h5") + " --from 0.4 -o " +
          scratch_.path("first"));
  command("replay " + scratch_.path("first/recording.h5") + " --from 0.8 -o " +
          scratch_.path("second"));
  for (const char* gone : {"whole", "first"}) std::filesystem::remove_all(scratch_.path(gone));
  const json second = summary("second");
  EXPECT_EQ(second["outcome"], whole["outcome"]);
  EXPECT_EQ(second["goal"], whole["goal"]);
  // Run again as it is, and through a repair.
  command("repair " + scratch_.path("second/recording.h5") + " -o " + scratch_.path("copy.h5"));
  command("replay " + scratch_.path("copy.h5") + " --verify");
  command("replay " + scratch_.path("copy.h5") + " -o " + scratch_.path("again"));
  EXPECT_EQ(summary("again")["outcome"], whole["outcome"]);
  EXPECT_EQ(summary("again")["since_fork"], second["since_fork"]);
}

TEST_F(Marks, UnderOtherSettingsCountWhatCameBefore) {
  attempt();
  command("replay " + scratch_.path("whole/recording.h5") +
          " --from 0.8 --set burr.tangential_ratio=0.01 -o " + scratch_.path("on"));
  const RecordingReader parent(scratch_.path("whole/recording.h5"));
  const RecordingReader on(scratch_.path("on/recording.h5"));
  const std::uint64_t first = on.ticks(0, 1).front().tick;
  const std::vector<Edit> before = parent.edits();
  const auto removed =
      std::ranges::count_if(before, [&](const Edit& edit) { return edit.tick < first; }) +
      static_cast<std::ptrdiff_t>(on.edit_count());
  ASSERT_LT(removed, static_cast<std::ptrdiff_t>(parent.edit_count()));
  double removed_mm3 = 0.0;
  const json told = summary("on");
  for (const auto& [tissue, mm3] : told["outcome"]["removed_mm3"]["cut"].items()) {
    removed_mm3 += mm3.get<double>();
  }
  EXPECT_NEAR(removed_mm3, static_cast<double>(removed) * 0.15 * 0.15 * 0.15, 1e-9);
  EXPECT_LT(told["goal"]["missing_mm3"].get<double>(), told["goal"]["target_mm3"].get<double>());
}

TEST_F(Marks, ARecordingCopiedAwayGivesTheSamePage) {
  const std::string scene = scratch_.write("s.toml", test::cut_scene());
  command("run " + scene + " -o " + scratch_.path("out"));
  const std::string recording = scratch_.path("out/recording.h5");
  const std::string text = test::read_file(scratch_.path("out/summary.json"));
  EXPECT_EQ(RecordingReader(recording).summary().value_or(""), text);
  command("render " + recording + " --review " + scratch_.path("here.html"));
  std::filesystem::create_directories(scratch_.path("away"));
  std::filesystem::copy_file(recording, scratch_.path("away/other.h5"));
  scratch_.write("away/summary.json", "{\"scene\": \"of another run\"}");
  command("render " + scratch_.path("away/other.h5") + " --review " + scratch_.path("away.html"));
  const std::string page = test::read_file(scratch_.path("here.html"));
  EXPECT_EQ(test::read_file(scratch_.path("away.html")), page);
  const json told = json::parse(text);
  EXPECT_NE(page.find(told["force_hash"].get<std::string>()), std::string::npos);
  EXPECT_NE(page.find("<th>Duration</th><td>0.440 s, 440 ticks</td>"), std::string::npos);
}

TEST_F(Marks, OfARunThatWasNotEndedAreFromItsRows) {
  const std::string goal =
      "[goal]\nshape = 'box'\nsize_mm = [0.6, 0.4, 0.2]\nposition_mm = [0, 0, 0.9]\n";
  const std::string scene = scratch_.write("s.toml", test::cut_scene() + goal);
  command("run " + scene + " -o " + scratch_.path("out"));
  const RecordingReader reader(scratch_.path("out/recording.h5"));
  const std::string unended = scratch_.path("unended.h5");
  {
    RecordingWriter writer(unended, reader.header(), reader.workpiece(), nullptr, reader.tables());
    writer.append_edits(reader.edits());
    writer.append_cutting(reader.cutting());
    writer.append_ticks(reader.ticks());
  }  // as a kill leaves it
  command("render " + unended + " --review " + scratch_.path("page.html"));
  const std::string page = test::read_file(scratch_.path("page.html"));
  EXPECT_NE(page.find("holds no summary of its run"), std::string::npos);
  EXPECT_EQ(page.find("summary.json"), std::string::npos);
  const json told = summary("out");
  for (const auto& [name, value] :
       {std::pair{"goal, dice", told["goal"]["dice"]},
        std::pair{"outcome, peak_force_N", told["outcome"]["peak_force_N"]},
        std::pair{"outcome, contact_s", told["outcome"]["contact_s"]}}) {
    EXPECT_NE(page.find("<th>" + std::string(name) + "</th><td>" + value.dump() + "</td>"),
              std::string::npos)
        << name;
  }
}

TEST_F(Marks, ThePageTellsOfTheWholeAndOfItsPart) {
  const std::string scene = scratch_.write("s.toml", test::cut_scene());
  command("run " + scene + " -o " + scratch_.path("out"));
  command("replay " + scratch_.path("out/recording.h5") + " --from 0.2 -o " + scratch_.path("on"));
  command("render " + scratch_.path("on/recording.h5") + " --review " + scratch_.path("page.html"));
  const std::string page = test::read_file(scratch_.path("page.html"));
  EXPECT_NE(page.find("Goes on from " + scratch_.path("out/recording.h5") + " at 0.201 s"),
            std::string::npos);
  const std::size_t whole = page.find("<td>0.440 s, 440 ticks</td>");
  const std::size_t part = page.find("<td>0.239 s, 239 ticks</td>");
  EXPECT_LT(whole, part);
  EXPECT_NE(part, std::string::npos);
}

TEST_F(Marks, RemovedIsTheSumOfItsLinesWhereAPieceCameLoose) {
  const std::string scene =
      scratch_.write("post.toml", "tissue = [\"enamel\", \"dentine\"]\n" + test::post_scene());
  const auto ran = command("run " + scene + " -o " + scratch_.path("out"));
  const RecordingReader reader(scratch_.path("out/recording.h5"));
  const std::vector<Edit> edits = reader.edits();
  const auto loose = std::ranges::count(edits, EditCause::kLoose, &Edit::cause);
  ASSERT_GT(loose, 100);
  char said[64];
  std::snprintf(said, sizeof said, "came loose         %td voxels", loose);
  EXPECT_NE(ran.out.find(said), std::string::npos) << ran.out;
  command("render " + scratch_.path("out/recording.h5") + " --review " +
          scratch_.path("page.html"));
  std::snprintf(said, sizeof said, "<th>Removed</th><td>%.3f mm",
                static_cast<double>(edits.size()) * 0.05 * 0.05 * 0.05);
  EXPECT_NE(test::read_file(scratch_.path("page.html")).find(said), std::string::npos) << said;
  // What there was is what is left and what went.
  const json told = summary("out");
  EXPECT_EQ(told["workpiece_start"]["solid_voxels"], reader.workpiece().solid_count());
  EXPECT_EQ(told["workpiece"]["solid_voxels"],
            reader.workpiece().solid_count() - reader.edit_count());
}

TEST_F(Marks, AtRealPaceMissedTicksAreTold) {
  const std::string scene = scratch_.write("s.toml", test::cut_scene());
  const auto real = command("run " + scene + " --pace real -o " + scratch_.path("real"));
  const std::string missed =
      std::to_string(summary("real")["missed_ticks"].get<std::uint64_t>()) + " ticks missed";
  EXPECT_NE(real.out.find(missed), std::string::npos) << real.out;
  const auto fast = command("run " + scene + " -o " + scratch_.path("fast"));
  EXPECT_EQ(fast.out.find("missed"), std::string::npos) << fast.out;
}

}  // namespace
}  // namespace sulcus::marks_test
