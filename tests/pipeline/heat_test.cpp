#include <optional>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/playback/recorded_heat.hpp"
#include "app/playback/recorded_run.hpp"
#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::heat_test {
namespace {

/// A small block that is cut, without heat and with it.
class Heat : public ::testing::Test {
 protected:
  nlohmann::json run(const std::string& name, const std::string& scene,
                     const std::string& options = "") {
    const auto result = command("run " + scratch_.write(name + ".toml", scene) + " -o " +
                                scratch_.path(name) + " " + options);
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(test::read_file(scratch_.path(name) + "/summary.json"));
  }
  test::CommandResult command(const std::string& arguments) {
    return test::sulcus_command(arguments, scratch_.path("err"));
  }
  std::string recording(const std::string& name) const {
    return scratch_.path(name + "/recording.h5");
  }

  const ScratchFolder scratch_;
  const std::string warm_ = test::cut_scene() + "[heat]\nwater_ml_min = 10\n";
};

bool has_part(const nlohmann::json& summary, const std::string& name) {
  for (const auto& part : summary["parts"]) {
    if (part["name"] == name) return true;
  }
  return false;
}

TEST_F(Heat, ASceneWithoutItHasNothingOfItAndTheSameBits) {
  const nlohmann::json without = run("without", test::cut_scene()), with = run("with", warm_);
  EXPECT_FALSE(without.contains("heat"));
  EXPECT_FALSE(has_part(without, "heat"));
  EXPECT_FALSE(without["memory_MiB"].contains("heat"));
  EXPECT_TRUE(has_part(with, "heat"));
  for (const char* same : {"volume_hash", "force_hash", "removed_voxels", "tangential_work_J"}) {
    EXPECT_EQ(without[same], with[same]) << same;
  }
}

TEST_F(Heat, TheToothHasItsShareOfTheWork) {
  const nlohmann::json summary = run("out", warm_, "--set heat.tooth_share=0.2");
  const double work_J = summary["tangential_work_J"];
  ASSERT_GT(work_J, 0.0);
  // What was done after the last voxel went waits for another.
  EXPECT_NEAR(summary["heat"]["given_J"].get<double>(), 0.2 * work_J, 0.02 * work_J);
  EXPECT_TRUE(summary["heat"]["pulp"].is_null());
}

TEST_F(Heat, TheRecordingGivesWhatTheRunGaveForAnyNumberOfThreads) {
  const nlohmann::json one = run("one", warm_, "--threads 1"),
                       two = run("two", warm_, "--threads 2");
  EXPECT_EQ(one["heat"], two["heat"]);
  const RecordingReader reader(recording("one"));
  const Scene scene = recorded_scene(reader, recording("one"));
  RecordedHeat heat(reader, scene, recorded_workpiece(reader, scene), "--colour-by");
  heat.advance_to_end();
  EXPECT_EQ(one["heat"]["given_J"].get<double>(), heat.tooth().result().given_J);
}

TEST_F(Heat, PicturesShowTheTemperatureInASectionToo) {
  run("out", warm_);
  const auto picture = [&](const std::string& options) {
    const auto result = command("render " + recording("out") + " --at 0.3 --size 200x150 -o " +
                                scratch_.path("drawn") + ' ' + options);
    EXPECT_EQ(result.status, 0) << options << ": " << result.err;
    return test::read_file(result.out.substr(0, result.out.find('\n')));
  };
  EXPECT_NE(picture("--colour-by temperature"), picture(""));
  EXPECT_NE(picture("--colour-by temperature --section y=0"), picture("--section y=0"));
}

TEST_F(Heat, WhatCannotBeIsSaid) {
  run("plain", test::cut_scene());
  const auto refused = [&](const std::string& arguments, const std::string& says) {
    const auto result = command(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
  };
  refused("render " + recording("plain") + " --colour-by temperature", "without [heat]");
  refused("run " + scratch_.write("still.toml", test::probe_scene() + "[heat]\n"),
          "[heat] without [cutting]");
  refused("run " + scratch_.path("plain.toml") +
              " --set heat.cell_mm=0.1 --set workpiece.voxel_mm=0.1 --set "
              "'workpiece.cells=[264, 264, 264]'",
          "heat.cell_mm: found 18399744 cells");
}

}  // namespace
}  // namespace sulcus::heat_test
