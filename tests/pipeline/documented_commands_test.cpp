#include "tests/support/documented_commands.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

// The commands of every README and of the tutorial, as they stand there and in their order, in a
// folder that looks like a checkout. Only the optimised build is quick enough for this.

namespace sulcus::documented_commands_test {
namespace {

namespace fs = std::filesystem;

/// Commands that are not run here, and why.
struct NotRun {
  std::string_view begins, why;
};
constexpr std::array kNotRun{
    NotRun{"tools/run", "builds what is being tested; tools/test runs it first"},
    NotRun{"tools/test", "runs this"},
    NotRun{"tools/lab", "installs PCL; lab/documented_lab_commands_test.cpp runs what it runs"},
    NotRun{"tools/everywhere",
           "builds for other systems, which takes minutes and packages of its own"},
    NotRun{"tools/package", "packs what is being tested; tools/test runs it first"},
};

/// Scenes that are run for their first seconds: what takes a minute and more differs from them in
/// nothing but its length.
struct Shortened {
  std::string_view begins, option;
};
constexpr std::array kShortened{
    Shortened{"sulcus run scenes/class_one_turbine.toml", " --duration 10"},
    Shortened{"sulcus run scenes/crown_turbine.toml", " --duration 10"},
    Shortened{"sulcus run scenes/occlusal_minute.toml", " --duration 10"},
};

std::string shortened(const std::string& command) {
  for (const auto& [begins, option] : kShortened) {
    if (!command.starts_with(begins)) continue;
    return std::string(begins).append(option).append(command, begins.size());
  }
  return command;
}

// In place of sudo: apt may only look whether the machine could, and dpkg works in a folder, in
// which there is no shell for the packages' scripts (which call ldconfig): the machine's runs them.
constexpr const char* kSudo = R"(
root="$(dirname "$0")/../root"
case "$*" in
  "apt install "*)
    apt-get --simulate install "$3"
    mkdir -p "$root/var/lib/dpkg/info" "$root/var/lib/dpkg/updates"
    touch "$root/var/lib/dpkg/status"
    dpkg --root="$root" --force-depends --force-script-chrootless --install "$3"
    (cd / && "$root/usr/bin/sulcus" help scene) ;;
  "apt purge --autoremove sulcus")
    dpkg --root="$root" --force-script-chrootless --purge sulcus ;;
  *) echo "not known here: $*" && exit 1 ;;
esac
)";

// Before cmake and ctest: what would make and test all over again what is tested here tells what it
// would do, in the checkout.
constexpr const char* kCmake = R"(
case "$1" in
  --preset) cd "$checkout" && cmake "$@" -N ;;
  --build) cd "$checkout" && cmake "$@" -- -n ;;
  *) exec cmake "$@" ;;
esac
)";
constexpr const char* kCtest = R"(
cd "$checkout" && ctest "$@" -N
)";

/// A folder with what the documents say is there, and a shell in it.
class Documented : public testing::Test {
 protected:
  void SetUp() override {
    const fs::path source = SULCUS_SOURCE_DIR, here = scratch_.path("");
    for (const char* name : {"scenes", "tools", "haptics"}) {
      fs::create_directory_symlink(source / name, here / name);
    }
    fs::create_directories(here / "build/release");
    fs::create_directory_symlink(SULCUS_PLUGINS, here / "build/release/plugins");
    const fs::path packages = source / "build/packages";
    if (fs::exists(packages) && geteuid() == 0) {
      fs::create_directory_symlink(packages, here / "build/packages");
      stand_in("sudo", kSudo);
    } else {
      absent_.push_back("sudo apt");  // what tools/package makes, and root's rights
    }
    if (fs::exists(source / "build/release/CMakeCache.txt")) {
      stand_in("cmake", kCmake);
      stand_in("ctest", kCtest);
    } else {
      absent_.push_back("cmake --preset release");
    }
    fs::create_directory(here / "my_plugins");
    fs::copy_file(source / "tools/plugins/simulated/simulated_device.c", here / "my_device.c");
  }

  /// A script that is found before the program of that name.
  void stand_in(const std::string& program, const std::string& script) const {
    const std::string begin =
        "#!/bin/sh -e\ncheckout='" SULCUS_SOURCE_DIR "'\nPATH=\"${PATH#*:}\"\n";
    fs::permissions(scratch_.write("bin/" + program, begin + script), fs::perms::owner_all);
  }

  /// The user's tooth under the name that the documents give it; false where there is none.
  bool tooth(const char* data, const char* name) const {
    const fs::path file = fs::path(SULCUS_SOURCE_DIR) / "../shared/data" / data;
    if (!fs::exists(file)) return false;
    fs::create_symlink(fs::canonical(file), scratch_.path(name));
    return true;
  }

  /// `command` in a shell in the folder, `sulcus` being the built one.
  test::CommandResult run(const std::string& command) const {
    const std::string script =
        scratch_.write("command.sh", "cd '" + scratch_.path("") + "'\n" + command + "\nended=$?\n" +
                                         "kill %1 2>/dev/null\nexit $ended\n");
    const std::string path = fs::path(SULCUS_PROGRAM).parent_path().string();
    return test::program_command("bash", script, scratch_.path("err"),
                                 "SULCUS_CACHE='" + scratch_.path("cache") + "' PATH='" +
                                     scratch_.path("bin") + "':" + path + ":$PATH");
  }

  /// How many commands were run.
  int run_all(const fs::path& document) {
    const auto steps =
        test::documented_steps(document, {"sulcus ", "tools/", "cc ", "cmake ", "sudo "});
    int ran = 0;
    for (const test::DocumentedStep& step : steps) {
      SCOPED_TRACE(fs::relative(document, SULCUS_SOURCE_DIR).string() + ":" +
                   std::to_string(step.line) + ": " + step.text);
      if (!step.file.empty()) {
        scratch_.write(step.file, step.text);
        continue;
      }
      if (!runs(step.text)) continue;
      // 200 runs: stopped after some of them.
      const bool sweep = step.text.starts_with("tools/sweep");
      const auto result = run((sweep ? "timeout -s INT 20 " : "") + shortened(step.text));
      EXPECT_EQ(result.status, sweep ? 124 : 0) << result.out << result.err;
      ++ran;
    }
    return ran;
  }

  /// False for what is not to be run, or needs a tooth that is not here.
  bool runs(const std::string& command) const {
    return std::ranges::none_of(kNotRun,
                                [&](const NotRun& n) { return command.starts_with(n.begins); }) &&
           std::ranges::none_of(absent_, [&](const std::string& name) {
             return command.find(name) != std::string::npos;
           });
  }

  ScratchFolder scratch_;
  std::vector<std::string> absent_;
};

TEST_F(Documented, CommandsOfTheReadmesRun) {
  if (!tooth("ge_tooth/tooth_103x94x161_u16.nrrd", "tooth.nrrd")) absent_.push_back("tooth.nrrd");
  if (!tooth("open_full_jaw/mandible_tooth_19.stl", "tooth.stl")) absent_.push_back("tooth.stl");
  int ran = 0;
  // In one folder: what a README does, a later one may draw.
  for (const fs::path& readme : test::readmes(SULCUS_SOURCE_DIR)) ran += run_all(readme);
  EXPECT_GE(ran, 15);
  EXPECT_TRUE(fs::exists(scratch_.path("out/sweep/runs/000000/summary.json")));
  EXPECT_TRUE(fs::exists(scratch_.path("cut.mp4")));
  EXPECT_TRUE(fs::exists(scratch_.path("my_plugins/sulcus_device_my_device.so")));
  if (const std::string root = scratch_.path("root"); fs::exists(root)) {
    for (const auto& left : fs::recursive_directory_iterator(root)) {
      const std::string path = left.path().string();
      EXPECT_TRUE(left.is_directory() || path.starts_with(root + "/var/lib/dpkg/")) << path;
    }
  }
  if (!absent_.empty()) GTEST_SKIP() << "not run for want of " << absent_.front();
}

TEST_F(Documented, TheTutorialLeadsFromAScanToACutTooth) {
  if (!tooth("ge_tooth/tooth_103x94x161_u16.nrrd", "scan.nrrd")) GTEST_SKIP() << "no scan here";
  const fs::path tutorial = fs::path(SULCUS_SOURCE_DIR) / "scenes/from_a_scan_to_a_cut_tooth.md";
  EXPECT_GE(run_all(tutorial), 8);
  for (const char* made : {"scan.png", "cut_open.png", "review.html", "cut.stl", "cut.nrrd"}) {
    EXPECT_TRUE(fs::exists(scratch_.path(made))) << made;
  }
  // What it says of the result.
  const auto summary =
      nlohmann::json::parse(test::read_file(scratch_.path("out/cavity/summary.json")));
  EXPECT_EQ(summary["ticks"], 7534);
  EXPECT_NEAR(summary["goal"]["dice"], 0.94, 0.005);
  EXPECT_NEAR(summary["goal"]["missing_within_mm"]["max"], 0.25, 0.03);
  const auto scan = run("sulcus inspect scan.nrrd"),
             cut = run("sulcus inspect cut_as_scanned.nrrd");
  for (const char* line : {"volume ", "spacing ", "origin ", "directions "}) {
    const auto of = [&](const std::string& text) {
      const std::size_t at = text.find(line);
      return text.substr(std::min(at, text.size()), text.find('\n', at) - at);
    };
    EXPECT_NE(of(scan.out), "");
    EXPECT_EQ(of(cut.out), of(scan.out));
  }
}

}  // namespace
}  // namespace sulcus::documented_commands_test
