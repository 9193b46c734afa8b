#include <cmath>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/pipeline/energy_balance.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::run_test {
namespace {

using test::sulcus_command;

nlohmann::json summary_of(const std::string& folder) {
  return nlohmann::json::parse(test::read_file(folder + "/summary.json"));
}

std::set<std::string> parts_of(const nlohmann::json& summary) {
  std::set<std::string> names;
  for (const auto& part : summary["parts"]) names.insert(part["name"]);
  return names;
}

TEST(Run, MinimalSceneRunsOnlyThePartsItNeeds) {
  const ScratchFolder scratch;
  const auto result =
      sulcus_command("run " + std::string(SULCUS_SOURCE_DIR) +
                         "/scenes/minimal.toml --duration 0.05 -o " + scratch.path("out"),
                     scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto summary = summary_of(scratch.path("out"));
  EXPECT_EQ(parts_of(summary), (std::set<std::string>{"burr", "workpiece", "contact"}));
  for (const char* part : {"cutting", "outcome", "render", "record"}) {
    EXPECT_FALSE(summary["memory_MiB"].contains(part)) << part;
  }
  for (const char* key : {"outcome", "goal"}) EXPECT_FALSE(summary.contains(key)) << key;
  EXPECT_FALSE(summary["stage_us"].contains("removal"));
  EXPECT_FALSE(std::filesystem::exists(scratch.path("out/recording.h5")));
  EXPECT_FALSE(std::filesystem::exists(scratch.path("out/frames")));
  EXPECT_EQ(summary["removed_voxels"], 0);
}

TEST(Run, TissuesAreMeasuredByWhatIsFilledAndVoxelsCounted) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", test::probe_scene() + "[cutting]\n");
  const auto summary_with = [&](const std::string& surface) {
    const auto result = sulcus_command("run " + scene + " --set workpiece.surface=" + surface +
                                           " --set 'workpiece.box.size_mm=[1.93, 1.77, 1.91]'"
                                           " --set 'workpiece.rotation_deg=[0, 0, 17]' -o " +
                                           scratch.path(surface),
                                       scratch.path("err"));
    EXPECT_EQ(result.status, 0) << result.err;
    return summary_of(scratch.path(surface));
  };
  const auto mm3 = [](const nlohmann::json& tissues) {
    double sum = 0.0;
    for (const auto& tissue : tissues) sum += tissue.get<double>();
    return sum;
  };
  const auto binary = summary_with("binary"), filled = summary_with("fractions");
  const auto before = filled["workpiece_start"], after = filled["workpiece"];
  const double exact = 1.93 * 1.77 * 1.91, voxel_mm3 = 0.05 * 0.05 * 0.05;
  EXPECT_NEAR(mm3(before["tissue_mm3"]) / exact, 1.0, 1e-3);
  EXPECT_GT(std::abs(mm3(binary["workpiece_start"]["tissue_mm3"]) / exact - 1.0), 3e-3);
  for (const char* time : {"workpiece_start", "workpiece"}) {
    EXPECT_NEAR(mm3(binary[time]["tissue_mm3"]),
                binary[time]["solid_voxels"].get<double>() * voxel_mm3, 1e-9);
  }
  // More voxels are solid at all.
  EXPECT_GT(before["solid_voxels"].get<double>() * voxel_mm3, 1.03 * exact);
  const double removed = mm3(filled["outcome"]["removed_mm3"]["cut"]);
  EXPECT_GT(removed, 1e-3);
  EXPECT_NEAR(mm3(before["tissue_mm3"]) - mm3(after["tissue_mm3"]), removed, 1e-9);
}

TEST(Run, NamedPartsAreListedWithTheirMemory) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", test::render_scene());
  const auto result =
      sulcus_command("run " + scene + " -o " + scratch.path("out"), scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto summary = summary_of(scratch.path("out"));
  EXPECT_EQ(parts_of(summary), (std::set<std::string>{"burr", "workpiece", "contact", "cutting",
                                                      "outcome", "record", "render"}));
  for (const auto& part : summary["parts"]) EXPECT_GT(part["memory_MiB"], 0.0) << part;
  EXPECT_GT(summary["removed_voxels"], 100);
  EXPECT_GT(summary["frames"], 1);
  test::expect_energies_balance(summary);
  for (const char* file : {"/recording.h5", "/forces.png", "/log.txt", "/frames/000000.png"}) {
    EXPECT_GT(std::filesystem::file_size(scratch.path("out") + file), 0u) << file;
    EXPECT_NE(result.out.find(scratch.path("out")), std::string::npos);
  }
}

TEST(Run, TheInstructionSetDoesNotChangeTheResult) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", test::cut_scene());
  for (const std::string method : {"ldm", "ldm_fast"}) {
    const auto summary_with = [&](const std::string& set) {
      const std::string folder = scratch.path(method + set);
      const auto result =
          sulcus_command("run " + scene + " --set haptics.normals=" + method + " -o " + folder,
                         scratch.path("err"), "SULCUS_CACHE=off SULCUS_INSTRUCTIONS=" + set);
      EXPECT_EQ(result.status, 0) << result.err;
      return summary_of(folder);
    };
    const auto plain = summary_with("plain");
    EXPECT_EQ(plain["instructions"], "plain");
    for (const std::string set : {"avx2", "avx512", ""}) {  // and the best of this processor
      const auto fast = summary_with(set);
      EXPECT_GT(fast["removed_voxels"], 0);
      EXPECT_EQ(fast["volume_hash"], plain["volume_hash"]) << fast["instructions"];
      EXPECT_EQ(fast["force_hash"], plain["force_hash"]) << fast["instructions"];
    }
  }
}

TEST(Run, PaceAndThreadsDoNotChangeTheResult) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", test::cut_scene());
  std::set<std::string> volumes, forces;
  int n = 0;
  for (const char* options : {"--pace fast", "--pace real", "--threads 1", "--threads 4"}) {
    const std::string folder = scratch.path("out" + std::to_string(n++));
    const auto result =
        sulcus_command("run " + scene + " " + options + " -o " + folder, scratch.path("err"));
    ASSERT_EQ(result.status, 0) << result.err;
    const auto summary = summary_of(folder);
    volumes.insert(summary["volume_hash"].get<std::string>());
    forces.insert(summary["force_hash"].get<std::string>());
  }
  EXPECT_EQ(volumes.size(), 1u);
  EXPECT_EQ(forces.size(), 1u);
}

TEST(Run, LoadsTheSameFromTheCache) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", test::cut_scene());
  const std::string cache = scratch.path("cache"), own = "SULCUS_CACHE=" + cache;
  std::set<std::string> volumes, forces;
  const auto cached = [&](const std::string& options, const std::string& environment) {
    const auto result =
        sulcus_command("run " + scene + " --duration 0.3 -o " + scratch.path("out") + options,
                       scratch.path("err"), environment);
    EXPECT_EQ(result.status, 0) << result.err;
    const auto summary = summary_of(scratch.path("out"));
    volumes.insert(summary["volume_hash"].get<std::string>());
    forces.insert(summary["force_hash"].get<std::string>());
    EXPECT_GT(summary["load_s"], 0.0);
    EXPECT_LT(summary["load_s"], 60.0);
    std::vector<bool> parts;
    for (const auto& part : summary["parts"]) {
      const bool kept = part["name"] == "burr" || part["name"] == "workpiece";
      EXPECT_EQ(part.contains("cached"), kept) << part;
      if (kept) parts.push_back(part["cached"]);
    }
    return parts;
  };
  const std::vector<bool> neither{false, false}, both{true, true};
  EXPECT_EQ(cached(" --no-cache", own), neither);
  EXPECT_FALSE(std::filesystem::exists(cache));
  EXPECT_EQ(cached("", own), neither);
  EXPECT_EQ(cached("", own), both);
  EXPECT_EQ(cached(" --no-cache", own), neither);
  // Damaged: made again, and a line in the log.
  for (const auto& entry : std::filesystem::directory_iterator(cache)) {
    std::filesystem::resize_file(entry.path(), std::filesystem::file_size(entry.path()) - 1);
  }
  EXPECT_EQ(cached("", own), neither);
  EXPECT_NE(test::read_file(scratch.path("out/log.txt")).find("load cache: " + cache),
            std::string::npos);
  EXPECT_EQ(cached("", own), both);
  // No folder to be had.
  EXPECT_EQ(cached("", "SULCUS_CACHE=" + scratch.path("s.toml") + "/no"), neither);
  EXPECT_EQ(cached("", "-u SULCUS_CACHE -u XDG_CACHE_HOME -u HOME"), neither);
  EXPECT_EQ(volumes.size(), 1u);
  EXPECT_EQ(forces.size(), 1u);
}

TEST(Run, StopsCleanlyOnRequest) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", test::cut_scene());
  const std::string out = scratch.path("out");
  // Real pace, so that the run lasts; stopped some time after it has begun to record.
  const std::string command =
      "env SULCUS_CACHE=off " + std::string(SULCUS_PROGRAM) + " run " + scene +
      " --pace real --duration 60 -o " + out +
      " >/dev/null 2>&1 & for i in $(seq 600); do test -s " + out +
      "/recording.h5 && break; sleep 0.05; done; sleep 0.5; kill -INT $!; wait $!";
  const int ended = std::system(command.c_str());
  ASSERT_EQ(WEXITSTATUS(ended), 130);
  ASSERT_TRUE(std::filesystem::exists(out + "/summary.json"));
  const auto summary = summary_of(out);
  EXPECT_TRUE(summary["interrupted"]);
  const auto verified =
      sulcus_command("replay --verify " + out + "/recording.h5", scratch.path("err"));
  EXPECT_EQ(verified.status, 0) << verified.err;
  EXPECT_NE(verified.out.find(std::to_string(summary["ticks"].get<int>()) + " ticks"),
            std::string::npos)
      << verified.out;
}

TEST(Run, SetChangesTheScene) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", test::probe_scene());
  const auto result = sulcus_command(
      "run " + scene + " --set haptics.rate_hz=100 --set workpiece.box.size_mm=[1,1,1] -o " +
          scratch.path("out"),
      scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto summary = summary_of(scratch.path("out"));
  EXPECT_EQ(summary["workpiece"]["solid_voxels"], 20 * 20 * 20);
  EXPECT_LT(summary["ticks"], 60);
}

}  // namespace
}  // namespace sulcus::run_test
