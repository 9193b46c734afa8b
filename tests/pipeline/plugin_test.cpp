#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

// Devices that are loaded at run time: tools/plugins/ and, for what goes wrong,
// tests/support/plugins.

namespace sulcus::plugin_test {
namespace {

using test::sulcus_command;

constexpr const char* kGood = SULCUS_PLUGINS;
constexpr const char* kBad = SULCUS_BAD_PLUGINS;

/// A hand that presses on a block, through a coupling; [device] comes last and lacks its keys.
const std::string kPressScene = test::block_and_burr() + R"(
[trajectory]
points_mm = [[0, 0, 1.5], [0, 0, -0.4]]
speed_mm_per_s = 20
hold_s = 0.5
[coupling]
[record]
[device]
)";

double force_N(const TickRecord& row) {
  return std::hypot(row.force_N[0], row.force_N[1], row.force_N[2]);
}

/// What the faulty plug-in wrote when it was closed.
struct Sent {
  unsigned long long writes = 0;
  double largest_N = -1.0, last_N = -1.0;
  int last = -1;
  double step_N = 1e9, torque_step_Nm = 1e9;
  unsigned long long falling = 0;
};

class Plugin : public ::testing::Test {
 protected:
  test::CommandResult run(const std::string& device, const std::string& name,
                          const std::string& options) {
    const std::string scene = scratch_.write(name + ".toml", kPressScene + device);
    return sulcus_command("run " + scene + " " + options + " --force -o " + scratch_.path(name),
                          scratch_.path("err"));
  }
  /// With the fault of the faulty plug-in, from a tick on.
  test::CommandResult run_faulty(const std::string& fault, int tick,
                                 const std::string& options = "") {
    const std::string settings =
        fault + " " + std::to_string(tick) + " " + scratch_.path("sent.txt");
    return run("plugin = 'faulty'\nsettings = '" + settings + "'\n", fault,
               options + " --plugins " + kBad);
  }
  nlohmann::json summary(const std::string& name) const {
    return nlohmann::json::parse(test::read_file(scratch_.path(name) + "/summary.json"));
  }
  RecordingReader recording(const std::string& name) const {
    return RecordingReader(scratch_.path(name) + "/recording.h5");
  }
  Sent sent() const {
    Sent sent;
    const std::string text = test::read_file(scratch_.path("sent.txt"));
    EXPECT_EQ(std::sscanf(text.c_str(),
                          "writes %llu largest_N %lf last_N %lf last %d step_N %lf torque_step_Nm "
                          "%lf falling %llu",
                          &sent.writes, &sent.largest_N, &sent.last_N, &sent.last, &sent.step_N,
                          &sent.torque_step_Nm, &sent.falling),
              7)
        << text;
    return sent;
  }
  /// What the device was sent came down to zero, by no step longer than its interface says.
  void expect_faded() const {
    const Sent all = sent();
    EXPECT_EQ(all.last_N, 0.0);
    EXPECT_EQ(all.last, 1);
    EXPECT_GT(all.largest_N, 0.5) << "it had a force";
    EXPECT_LE(all.step_N, 0.5 * (1 + 1e-6));
    EXPECT_LE(all.torque_step_Nm, 0.02 * (1 + 1e-6));
    EXPECT_GE(all.falling, 50u);
  }
  void expect_verified(const std::string& name) {
    const auto verified = sulcus_command("replay --verify " + scratch_.path(name) + "/recording.h5",
                                         scratch_.path("err"));
    EXPECT_EQ(verified.status, 0) << verified.err;
  }
  const ScratchFolder scratch_;
};

void expect_named(const test::CommandResult& result, const std::vector<std::string>& named) {
  for (const std::string& part : named) {
    EXPECT_NE(result.err.find(part), std::string::npos) << part << " in " << result.err;
  }
}

TEST_F(Plugin, TheSimulatedDeviceAsAPluginFeelsWhatTheBuiltInOneDoes) {
  const auto built_in = run("model = 'simulated'\nhand = 'light'\npush_N = 1\n", "built_in", "");
  ASSERT_EQ(built_in.status, 0) << built_in.err;
  const std::string device = "plugin = 'simulated'\nsettings = 'push_N=1'\n";
  const auto plugged = run(device, "plugged", std::string("--plugins ") + kGood);
  ASSERT_EQ(plugged.status, 0) << plugged.err;
  EXPECT_EQ(plugged.err, "");
  const auto a = recording("built_in").ticks(), b = recording("plugged").ticks();
  ASSERT_EQ(a.size(), b.size());
  double largest_N = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      // One quantum of the encoders, should a rounding fall the other way.
      ASSERT_NEAR(a[i].device_position_m[axis], b[i].device_position_m[axis], 56e-6) << i;
      ASSERT_NEAR(a[i].force_N[axis], b[i].force_N[axis], 0.05) << i;
    }
    largest_N = std::max(largest_N, force_N(b[i]));
  }
  EXPECT_GT(largest_N, 0.8);
  EXPECT_EQ(summary("plugged")["device"]["plugin"], "simulated");
  expect_verified("plugged");

  // Its time is the number of ticks.
  const auto paced = run(device, "paced", std::string("--pace real --plugins ") + kGood);
  ASSERT_EQ(paced.status, 0) << paced.err;
  EXPECT_EQ(summary("paced")["force_hash"], summary("plugged")["force_hash"]);
}

// The same source, built after the header as it was in version 1.
TEST_F(Plugin, OneOfTheOldVersionIsTheSameDevice) {
  const auto now = run("plugin = 'simulated'\nsettings = 'push_N=1'\n", "now",
                       std::string("--plugins ") + kGood);
  const auto old =
      run("plugin = 'version_1'\nsettings = 'push_N=1'\n", "old", std::string("--plugins ") + kBad);
  ASSERT_EQ(now.status, 0) << now.err;
  ASSERT_EQ(old.status, 0) << old.err;
  EXPECT_EQ(summary("old")["force_hash"], summary("now")["force_hash"]);
  EXPECT_GT(summary("old")["force_N"]["max"].get<double>(), 0.8);
  expect_verified("old");
}

TEST_F(Plugin, LimitsAreThePluginsOrLessAndARecordingSaysThem) {
  const auto run_with = [&](const std::string& keys, const std::string& name) {
    const auto result = run("plugin = 'faulty'\n" + keys, name, std::string("--plugins ") + kBad);
    EXPECT_EQ(result.status, 0) << result.err;
    return recording(name).header().scene_toml;
  };
  const std::string own = run_with("", "own");
  for (const char* said : {"force_limit_N = 2", "torque_limit_mNm = 50",
                           "stiffness_N_per_mm = 0.65", "resolution_mm = 0.01"}) {
    EXPECT_NE(own.find(said), std::string::npos) << said << " in " << own;
  }
  EXPECT_NEAR(summary("own")["coupling"]["stiffness_N_per_mm"].get<double>(), 0.65, 1e-12);
  EXPECT_NE(run_with("force_limit_N = 10\n", "more").find("force_limit_N = 2"), std::string::npos);
  EXPECT_GT(summary("more")["force_N"]["max"].get<double>(), 0.5);
  run_with("force_limit_N = 0.25\n", "less");
  EXPECT_NEAR(summary("less")["force_N"]["max"].get<double>(), 0.25, 1e-12);
  expect_verified("less");
}

TEST_F(Plugin, WhatIsNoPoseEndsTheRunWithZeroForce) {
  for (const char* fault : {"not_finite", "unset", "far", "not_unit"}) {
    SCOPED_TRACE(fault);
    const auto result = run_faulty(fault, 300);
    EXPECT_EQ(result.status, 1) << result.err;
    expect_named(result, {"device plug-in 'faulty' gave what is no pose at tick 300"});
    EXPECT_EQ(summary(fault)["faults"]["not_finite"], 1);
    EXPECT_EQ(summary(fault)["ticks"], 301);
    EXPECT_EQ(force_N(recording(fault).ticks().back()), 0.0) << "its tick has zero force";
    expect_faded();
    EXPECT_EQ(sent().writes, 300u + 50u) << "the fall began in the tick of the fault";
    expect_verified(fault);
  }
}

TEST_F(Plugin, AtTheEndOfARunTheForceFallsIn50MsAndThatIsInNoRecord) {
  for (const char* options : {"--duration 0.5", "--duration 0.5 --pace real"}) {
    SCOPED_TRACE(options);
    const auto result = run_faulty("none", 0, options);
    EXPECT_EQ(result.status, 0) << result.err;
    expect_faded();
    EXPECT_EQ(sent().writes, 500u + 50u);
    EXPECT_EQ(summary("none")["ticks"], 500);
    EXPECT_GT(force_N(recording("none").ticks().back()), 0.5);
    expect_verified("none");
  }
}

TEST_F(Plugin, AStoppedRunTakesTheForceOffToo) {
  // Stops the program by itself, as Ctrl-C would.
  const auto result = run_faulty("interrupt", 300, "--pace real");
  expect_named(result, {"stopped on request"});
  expect_faded();
  EXPECT_LT(summary("interrupt")["ticks"], 400);
}

TEST_F(Plugin, ADeviceThatIsGoneEndsTheRunOnceTheForceHasFaded) {
  struct Case {
    const char* fault;
    std::string said;
    unsigned long long writes;
  };
  const Case cases[] = {{"gone", "is gone at tick 300 (code 2): the cable came off", 300},
                        {"odd_code", "is gone at tick 300 (code -5)", 300},
                        {"gone_at_write", "is gone at tick 300 (code 2)", 301}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.fault);
    const auto result = run_faulty(c.fault, 300);
    EXPECT_EQ(result.status, 1) << result.err;
    expect_named(result, {c.said});
    const auto ticks = recording(c.fault).ticks();
    ASSERT_GT(ticks.size(), 301u);
    EXPECT_GT(force_N(ticks[299]), 0.5);
    EXPECT_EQ(force_N(ticks.back()), 0.0);
    EXPECT_LT(ticks.size(), 380u) << "20 ms are bridged, 50 ms the force falls";
    EXPECT_EQ(sent().writes, c.writes) << "it was called after it was gone";
    expect_verified(c.fault);
  }
}

TEST_F(Plugin, WhileADeviceIsSilentTheForceFadesAndItComesBack) {
  const auto result = run_faulty("silent", 300);
  EXPECT_EQ(result.status, 0) << result.err;
  expect_named(result, {"gave no pose in 100 ticks"});
  EXPECT_EQ(summary("silent")["device"]["silent_ticks"], 80);
  EXPECT_EQ(summary("silent")["device"]["bridged_ticks"], 20);
  const auto ticks = recording("silent").ticks();
  EXPECT_GT(force_N(ticks[299]), 0.5);
  EXPECT_NEAR(force_N(ticks[319]), force_N(ticks[299]), 0.05 * force_N(ticks[299])) << "bridged";
  EXPECT_GT(force_N(ticks[345]), 0.1) << "it falls";
  EXPECT_EQ(force_N(ticks[372]), 0.0);
  EXPECT_GT(force_N(ticks[550]), 0.5);
  expect_faded();
  expect_verified("silent");
}

TEST_F(Plugin, AJumpFadesTheForceIn) {
  const auto result = run_faulty("jump", 300);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(summary("jump")["device"]["jumped_ticks"], 1);
  const auto ticks = recording("jump").ticks();
  EXPECT_GT(force_N(ticks[299]), 0.5);
  EXPECT_LT(force_N(ticks[305]), 0.2);
  EXPECT_LE(summary("jump")["force_step_N"]["max"].get<double>(), 0.5 + 1e-12);
  expect_verified("jump");
}

TEST_F(Plugin, ALateAnswerIsNone) {
  const auto result = run_faulty("slow", 300, "--pace real");
  EXPECT_EQ(result.status, 0) << result.err;
  expect_named(result, {"took longer than 20 ms to read in"});
  EXPECT_GE(summary("slow")["device"]["bridged_ticks"], 3);
  EXPECT_GE(summary("slow")["missed_ticks"], 3);
  expect_verified("slow");
}

TEST_F(Plugin, ADeviceThatDoesNotReturnEndsTheProgramAndTheRecordingIsThere) {
  const auto result = run_faulty("hang", 300);
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  expect_named(result, {"'faulty' has not returned from read for 2 s"});
  EXPECT_GT(recording("hang").ticks().size(), 250u);
  expect_verified("hang");
}

TEST_F(Plugin, ADeviceThatDoesNotReturnAfterTheLastTickEndsTheProgramToo) {
  for (const std::string call : {"message", "close"}) {
    const auto result = run_faulty("hang_at_" + call, 300);
    EXPECT_EQ(result.status, 1) << result.err;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    expect_named(result, {"'faulty' has not returned from " + call + " for 2 s"});
    expect_verified("hang_at_" + call);
  }
}

TEST_F(Plugin, AFileThatIsNoWholeLibraryIsRefused) {
  const std::string whole = test::read_file(std::string(kBad) + "/sulcus_device_faulty.so");
  ASSERT_GT(whole.size(), 5000u);
  const auto refused = [&](const std::string& name) {
    const auto result = sulcus_command(
        "run " + scratch_.write("s.toml", kPressScene + "plugin = '" + name + "'\n") +
            " --plugins " + scratch_.path("") + " -o " + scratch_.path("out_" + name),
        scratch_.path("err"));
    EXPECT_EQ(result.status, 2) << name << ": " << result.err;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
  };
  for (const std::size_t bytes : {0u, 40u, 100u, 2000u, 5000u}) {
    const std::string name = "cut" + std::to_string(bytes);
    scratch_.write("sulcus_device_" + name + ".so", whole.substr(0, bytes));
    refused(name);
  }
  ASSERT_EQ(::mkfifo(scratch_.path("sulcus_device_pipe.so").c_str(), 0600), 0);
  refused("pipe");
}

TEST_F(Plugin, ADeviceThatBeginsInsideTheToothIsWaitedFor) {
  const auto result = run_faulty("inside", 20);
  EXPECT_EQ(result.status, 0) << result.err;
  expect_named(result, {"inside a tooth in 20 ticks"});
  EXPECT_EQ(summary("inside")["device"]["silent_ticks"], 20);
  const auto ticks = recording("inside").ticks();
  EXPECT_EQ(ticks[19].contacts, 0u);
  for (const TickRecord& row : {ticks[0], ticks[19]}) {
    EXPECT_EQ(row.tool_position_m[2], 1.5e-3) << "where the scene has it start";
    EXPECT_EQ(row.device_position_m[2], 1.5e-3);
  }
  EXPECT_GT(force_N(ticks[400]), 0.5);
  expect_verified("inside");
}

TEST_F(Plugin, WhatCannotBeUsedIsRefusedBeforeAnythingRuns) {
  const std::string other = scratch_.path("other");
  std::filesystem::create_directories(other);
  scratch_.write("other/sulcus_device_text.so", "no library");
  const std::string bad = std::string("--plugins ") + kBad,
                    good = std::string("--plugins ") + kGood;
  struct Case {
    std::string device, options;
    std::vector<std::string> named;
  };
  const Case cases[] = {
      {"plugin = 'other_version'",
       bad,
       {"sulcus_device_other_version.so", "found version 3", "expected version 1 to 2"}},
      {"plugin = 'no_entry'", bad, {"sulcus_device_no_entry.so", "no symbol sulcus_device_plugin"}},
      {"plugin = 'data_entry'", bad, {"sulcus_device_plugin, which is no function"}},
      {"plugin = 'no_function'",
       bad,
       {"sulcus_device_no_function.so", "a function that is missing"}},
      {"plugin = 'text'", "--plugins " + other, {"sulcus_device_text.so", "expected a plug-in"}},
      {"plugin = 'faulty'\nsettings = 'no_device'",
       bad,
       {"device plug-in 'faulty': open: found no device on the bus and a second line"}},
      {"plugin = 'faulty'\nsettings = 'no_word'", bad, {"error 18, and no word on it"}},
      {"plugin = 'faulty'\nsettings = 'bad_limits'", bad, {"force_N = nan", "0.001 to 1000"}},
      {"plugin = 'faulty'\nsettings = 'no_limits'", bad, {"resolution_m = nan"}},
      {"plugin = 'simulated'\nsettings = 'push_N=99'", good, {"push_N=99", "0 to 20"}},
      {"plugin = 'udp'\nsettings = 'port=80'", good + " --pace real", {"port=80", "1024..65535"}},
      {"plugin = 'udp'", good, {"--pace fast", "device plug-in 'udp'", "expected --pace real"}},
      {"plugin = 'nowhere'",
       good,
       {"device.plugin", std::string(kGood) + "/sulcus_device_nowhere.so", "lib/sulcus/plugins/",
        "one of simulated, udp", "--plugins DIR"}},
      {"plugin = 'nowhere'", "", {"one of simulated, udp", "--plugins DIR"}},
      {"plugin = 'simulated'", "--plugins " + scratch_.path("none"), {"--plugins"}},
      // Names by which a stranger's scene might reach a library.
      {"plugin = '../bad/sulcus_device_faulty'", good, {"device.plugin", "never a path"}},
      {"plugin = '" + other + "/sulcus_device_text.so'", good, {"device.plugin", "never a path"}},
      {"plugin = '..'", good, {"device.plugin", "never a path"}},
      {"plugin = 'simulated.so'", good, {"device.plugin", "never a path"}},
      {"plugin = ''", good, {"device.plugin", "never a path"}},
      {"plugin = 7", good, {"device.plugin", "7"}},
      {"plugin = 'simulated'\nplugins = '" + other + "'", good, {"device.plugins", "'plugin'"}},
      {"plugin = 'simulated'\nmodel = 'simulated'", good, {"both a model and a plugin"}},
      {"plugin = 'simulated'\npush_N = 1", good, {"device.push_N"}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.device);
    const auto result = run(c.device + "\n", "out", c.options);
    EXPECT_EQ(result.status, 2) << result.err;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    expect_named(result, c.named);
    EXPECT_FALSE(std::filesystem::exists(scratch_.path("out")));
  }
}

}  // namespace
}  // namespace sulcus::plugin_test
