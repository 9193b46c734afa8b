#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/png_file.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::sweep_test {
namespace {

using test::CommandResult;
using test::read_file;

const std::string kSweep =
    "/usr/bin/python3 -B " + std::string(SULCUS_SOURCE_DIR) + "/tools/sulcus_sweep/main.py";

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) parts.push_back(part);
  return parts;
}

class Sweep : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v parallel >/dev/null && /usr/bin/python3 -c 'import h5py' "
                    "2>/dev/null") != 0) {
      GTEST_SKIP() << "GNU parallel or h5py is not installed";
    }
    scratch_.write("s.toml", test::probe_scene() + "[cutting]\n");
  }

  /// With the scene of the scratch folder, in which all paths lie.
  CommandResult sweep(const std::string& arguments) const {
    return test::program_command(
        "sh -c", "'cd " + scratch_.path("") + " && " + kSweep + " " + arguments + "'",
        scratch_.path("err"), "SULCUS_CACHE=off " + environment_);
  }

  /// A program that is the built one, after `before`, in which $* are its arguments.
  std::string program(const std::string& before) const {
    return executable("program", before + "\nexec " + std::string(SULCUS_PROGRAM) + " \"$@\"\n");
  }
  std::string executable(const std::string& name, const std::string& text) const {
    const std::string file = scratch_.write(name, "#!/bin/bash\n" + text);
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    return file;
  }

  std::string file(const std::string& name) const { return read_file(scratch_.path(name)); }

  ScratchFolder scratch_;
  std::string environment_;
};

const std::string kBuilt = std::string(" --program ") + SULCUS_PROGRAM;
const std::string kFour =
    "s.toml --set burr.diameter_mm=0.7,0.8 --set haptics.normals=ldm,ldm_fast ";

TEST_F(Sweep, AFolderIsNoCommand) {
  // In braces GNU parallel has replacements, and Perl.
  const std::string folder = "{= system(q(touch found)) =} {} {.}";
  const auto swept = sweep("s.toml --set burr.diameter_mm=0.7,0.8 -o \"" + folder + "\"" + kBuilt);
  EXPECT_EQ(swept.status, 0) << swept.err;
  EXPECT_TRUE(std::filesystem::exists(scratch_.path(folder + "/runs/000001/summary.json")));
  EXPECT_FALSE(std::filesystem::exists(scratch_.path("found")));
}

TEST_F(Sweep, EveryCombinationIsARowOfOneTable) {
  const auto swept = sweep(kFour + "-o d --chart burr.diameter_mm force_N.mean" + kBuilt);
  ASSERT_EQ(swept.status, 0) << swept.err;
  EXPECT_EQ(file("d/plan.csv"),
            "run,seed,burr.diameter_mm,haptics.normals,folder\n"
            "0,,0.7,ldm,runs/000000\n1,,0.7,ldm_fast,runs/000001\n"
            "2,,0.8,ldm,runs/000002\n3,,0.8,ldm_fast,runs/000003\n");

  const auto alone =
      test::sulcus_command("run " + scratch_.path("s.toml") + " -o " + scratch_.path("alone") +
                               " --set burr.diameter_mm=0.8 --set haptics.normals=ldm",
                           scratch_.path("err"));
  ASSERT_EQ(alone.status, 0) << alone.err;
  const auto summary = nlohmann::json::parse(file("alone/summary.json"));
  const auto lines = split(file("d/table.csv"), '\n');
  ASSERT_EQ(lines.size(), 5u);
  const auto names = split(lines[0], ','), third = split(lines[3], ',');
  const auto cell = [&](const std::string& name) {
    return third.at(std::find(names.begin(), names.end(), name) - names.begin());
  };
  EXPECT_EQ(cell("run"), "2");
  EXPECT_EQ(cell("exit_status"), "0");
  for (const char* key : {"force_hash", "volume_hash", "build", "scene_sha256"}) {
    EXPECT_EQ(cell(key), summary[key].get<std::string>());
  }
  EXPECT_EQ(std::stod(cell("force_N.mean")), summary["force_N"]["mean"].get<double>());
  EXPECT_EQ(std::count(names.begin(), names.end(), "tick_us.mean"), 0);
  EXPECT_NE(file("d/times.csv").find("tick_us.mean"), std::string::npos);
  // What ldm gave is told from what ldm_fast did: two colours, one sign for each run and one in the
  // key.
  const Image chart = test::read_png(scratch_.path("d/burr.diameter_mm-force_N.mean.png"));
  ASSERT_EQ(chart.width, 960);
  const auto pixels_of = [&](std::array<std::uint8_t, 3> colour) {
    std::size_t found = 0;
    for (std::size_t i = 0; i + 2 < chart.rgb.size(); i += 3) {
      found += std::equal(colour.begin(), colour.end(), &chart.rgb[i]) ? 1 : 0;
    }
    return found;
  };
  const std::size_t first = pixels_of({0x1f, 0x5f, 0xa8}), second = pixels_of({0xd5, 0x5e, 0x00});
  EXPECT_GT(first, 60u);
  EXPECT_GT(second, 60u);
  EXPECT_LT(first + second, 2000u);

  // The same in HDF5.
  const std::string compare = scratch_.write("compare.py", R"(import csv, h5py, sys
rows = list(csv.DictReader(open("table.csv")))
with h5py.File("table.h5") as f:
    assert set(f) == set(rows[0]), set(f) ^ set(rows[0])
    for column in f:
        for row, value in zip(rows, f[column], strict=True):
            value = value.decode() if isinstance(value, bytes) else value
            text = row[column].replace("False", "0")
            assert value == (text if isinstance(value, str) else float(text)), (column, value, text)
)");
  const auto compared = test::program_command(
      "sh -c", "'cd " + scratch_.path("d") + " && /usr/bin/python3 " + compare + "'",
      scratch_.path("err"));
  EXPECT_EQ(compared.status, 0) << compared.err;
}

TEST_F(Sweep, GoesOnAfterAKillToTheSameBytes) {
  // The third run kills all that is above it, the sweep included, with half of a summary written.
  const std::string killing = " -j 1 --program " + program(R"(
if [[ -e armed && "$*" == "run "*"diameter_mm=0.8 "*"=ldm" ]]; then
  rm armed
  echo '{"force_hash": "' >"$4/summary.json"
  above=$PPID
  all=
  while true; do
    all="$above $all"
    if grep -q main.py /proc/$above/cmdline; then break; fi
    read -r _ _ _ above _ </proc/$above/stat
  done
  kill -9 $all
  exit 1
fi)");
  scratch_.write("armed", "");
  EXPECT_EQ(sweep(kFour + "-o d" + killing).status, 128 + 9);
  EXPECT_FALSE(std::filesystem::exists(scratch_.path("armed")));
  EXPECT_FALSE(std::filesystem::exists(scratch_.path("d/table.csv")));
  const auto first = std::filesystem::last_write_time(scratch_.path("d/runs/000000/summary.json"));

  const auto resumed = sweep("-o d");
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(std::filesystem::last_write_time(scratch_.path("d/runs/000000/summary.json")), first);
  ASSERT_EQ(sweep(kFour + "-o undisturbed" + kBuilt).status, 0);
  EXPECT_EQ(file("d/table.csv"), file("undisturbed/table.csv"));
  EXPECT_EQ(file("d/table.h5"), file("undisturbed/table.h5"));
  for (const auto& entry : std::filesystem::directory_iterator(scratch_.path("d/runs"))) {
    EXPECT_EQ(entry.path().filename().string().size(), 6u) << entry.path();
  }
}

TEST_F(Sweep, FailedRunsAreTriedAgainListedAndDoneLater) {
  scratch_.write("broken", "");
  const std::string command =
      "s.toml --set burr.diameter_mm=0.6,0.7,0.8 -o d --program " + program(R"(
if [[ "$1" == run ]]; then echo "$*" >>ran; fi
if [[ -e broken && "$*" == "run "*"=0.7" ]]; then
  echo some warning >&2
  echo it broke >&2
  exit 3
fi)");
  const auto failed = sweep(command);
  EXPECT_EQ(failed.status, 1);
  EXPECT_EQ(failed.err,
            "run 000001 failed (burr.diameter_mm=0.7), status 3 in 3 attempts: it broke\n");
  auto lines = split(file("d/table.csv"), '\n');
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[1].substr(0, 8), "0,0,0.6,");
  EXPECT_EQ(lines[2].substr(0, 9), "1,3,0.7,,");
  EXPECT_EQ(lines[3].substr(0, 8), "2,0,0.8,");
  EXPECT_EQ(split(file("ran"), '\n').size(), 1u + 1 + 3 + 1);  // the first asks about the options

  std::filesystem::remove(scratch_.path("broken"));
  EXPECT_EQ(sweep(command).status, 0);
  EXPECT_EQ(split(file("ran"), '\n').size(), 6u + 1);
  EXPECT_EQ(split(file("d/table.csv"), '\n')[2].substr(0, 8), "1,0,0.7,");
}

// A Slurm that is none: it runs the tasks of an array at once, and takes at most three.
TEST_F(Sweep, ByArraysTheTableIsTheSame) {
  executable("bin/scontrol", "echo 'MaxArraySize            = 3'\n");
  executable("bin/squeue", "");
  executable("bin/sbatch", R"(
for given; do
  case $given in
    --array=*) tasks=$(tr , '\n' <<<"${given#*=}" | sed -E 's/^([0-9]+)$/\1-\1/; s/-/ /' | xargs -n 2 seq) ;;
    --wrap=*) wrap=${given#*=} ;;
  esac
done
echo "$*" >>arrays
for task in $tasks; do SLURM_ARRAY_TASK_ID=$task bash -c "$wrap"; done
echo 17
)");
  ASSERT_EQ(sweep(kFour + "-o plain" + kBuilt).status, 0);
  environment_ = "PATH=" + scratch_.path("bin") + ":$PATH";
  const auto swept = sweep(kFour + "-o d --slurm" + kBuilt);
  ASSERT_EQ(swept.status, 0) << swept.err;
  EXPECT_EQ(file("d/table.csv"), file("plain/table.csv"));
  const auto arrays = split(file("arrays"), '\n');
  ASSERT_EQ(arrays.size(), 2u);
  EXPECT_NE(arrays[0].find("--array=0-2 "), std::string::npos) << arrays[0];
  EXPECT_NE(arrays[1].find("--array=0 "), std::string::npos) << arrays[1];
}

TEST_F(Sweep, LatinHypercubeMeetsEachPartOfARangeOnce) {
  const std::string keys =
      "s.toml --set burr.tangential_ratio=0.1:0.5 --set haptics.neighbourhood=1:6 "
      "--set haptics.normals=ldm,ldm_fast --plan-only --latin 20" +
      kBuilt;
  ASSERT_EQ(sweep(keys + " --seed 7 -o a").status, 0);
  ASSERT_EQ(sweep(keys + " --seed 7 -o b").status, 0);
  ASSERT_EQ(sweep(keys + " --seed 8 -o c").status, 0);
  EXPECT_EQ(file("a/plan.csv"), file("b/plan.csv"));
  EXPECT_NE(file("a/plan.csv"), file("c/plan.csv"));

  const auto lines = split(file("a/plan.csv"), '\n');
  ASSERT_EQ(lines.size(), 21u);
  std::vector<int> parts, of_neighbourhood(7);
  int ldm = 0;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto cells = split(lines[i], ',');
    EXPECT_EQ(cells.at(1), "7");
    parts.push_back(static_cast<int>((std::stod(cells.at(2)) - 0.1) / 0.4 * 20));
    ++of_neighbourhood.at(std::stoi(cells.at(3)));
    ldm += cells.at(4) == "ldm";
  }
  EXPECT_FALSE(std::is_sorted(parts.begin(), parts.end()));
  std::sort(parts.begin(), parts.end());
  for (int part = 0; part < 20; ++part) EXPECT_EQ(parts[part], part);
  for (int ns = 1; ns <= 6; ++ns) EXPECT_NEAR(of_neighbourhood[ns], 20.0 / 6, 1.4) << ns;
  EXPECT_EQ(ldm, 10);
}

TEST_F(Sweep, CommasInBracketsAndQuotesPartNothing) {
  ASSERT_EQ(sweep("s.toml --set \"workpiece.cells=[64, 64, 64],[56,64,64]\" "
                  "--set \"title=\\\"a, b\\\",c\" -o d --plan-only" +
                  kBuilt)
                .status,
            0);
  EXPECT_EQ(split(file("d/plan.csv"), '\n').at(3),
            "2,,\"[56,64,64]\",\"\"\"a, b\"\"\",runs/000002");
}

TEST_F(Sweep, BadInputIsOneLineAndNothingIsWritten) {
  struct {
    const char* arguments;
    std::vector<std::string> named;
  } const cases[] = {
      {"none.toml --set a.b=1,2 -o d", {"none.toml", "no such file", "a scene"}},
      {"s.toml -o d", {"--set", "missing", "KEY=VALUE"}},
      {"-o d", {"/d", "no sweep", "SCENE"}},
      {"s.toml --set burr.diameter_mm=0.7", {"-o"}},
      {"s.toml --set burr.diametre_mm=0.7,0.8 -o d", {"burr.diametre_mm", "'diameter_mm'"}},
      {"s.toml --set haptics.normals=ldm,best -o d", {"haptics.normals", "best", "ldm_fast"}},
      {"s.toml --set burr.diameter_mm -o d", {"burr.diameter_mm", "no key with values"}},
      {"s.toml --set burr.diameter_mm= -o d", {"burr.diameter_mm", "value 1 is empty"}},
      {"s.toml --set burr.diameter_mm=0.7,,0.8 -o d", {"value 2 is empty"}},
      {"s.toml --set burr.diameter_mm=0.7,0.7 -o d", {"0.7", "twice"}},
      {"s.toml --set burr.diameter_mm=0.7 --set burr.diameter_mm=0.8 -o d", {"given twice"}},
      {"s.toml --set burr.diameter_mm=0.7:0.8 -o d", {"a range", "--latin N"}},
      {"s.toml --set burr.diameter_mm=0.8:0.7 --latin 3 -o d", {"LOW below HIGH"}},
      {"s.toml --set burr.diameter_mm=0.7:80.0 --latin 3 -o d",
       {"burr.diameter_mm", "found 80", "0.3 to 5"}},
      {"s.toml --set burr.diameter_mm=0.7,0.8 --latin 0 -o d", {"--latin 0", "1 to"}},
      {"s.toml --set burr.diameter_mm=0.7,0.8 --seed 3 -o d", {"--seed", "--latin"}},
      {"s.toml --set burr.diameter_mm=0.7,0.8 -j many -o d", {"-j", "many"}},
      {"s.toml --set burr.diameter_mm=0.7,0.8 --sshloginfile none -o d", {"none", "no such file"}},
      {"s.toml --set burr.diameter_mm=0.7,0.8 -o d -- --duration long", {"--duration", "long"}},
      {"s.toml --set burr.diameter_mm=0.7,0.8 -o d -- --help", {"options after --", "run nothing"}},
      {"s.toml --set burr.diameter_mm=0.7,0.8 -o s.toml", {"s.toml", "no folder"}},
      {"s.toml --set burr.diameter_mm=0.7,0.8 -o s.toml/d", {"s.toml", "no folder"}},
      {"s.toml --set burr.diameter_mm=0.7,0.8 -o \"\"", {"-o", "empty"}},
  };
  for (const auto& bad : cases) {
    const std::string arguments = bad.arguments;
    const auto options = std::min(arguments.find(" -- "), arguments.size());
    const auto result = sweep(arguments.substr(0, options) + kBuilt + arguments.substr(options));
    EXPECT_EQ(result.status, 2) << arguments << ": " << result.err;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    for (const std::string& part : bad.named) {
      EXPECT_NE(result.err.find(part), std::string::npos) << part << " in " << result.err;
    }
    EXPECT_FALSE(std::filesystem::exists(scratch_.path("d"))) << arguments;
  }
}

TEST_F(Sweep, AFolderIsThatOfOnePlan) {
  const std::string planned = "s.toml --plan-only -o d" + kBuilt + " --set burr.diameter_mm=";
  ASSERT_EQ(sweep(planned + "0.7,0.8").status, 0);
  EXPECT_EQ(sweep(planned + "0.7,0.8").status, 0);
  const auto other = sweep(planned + "0.7,0.9");
  EXPECT_EQ(other.status, 2);
  EXPECT_EQ(other.err_lines(), 1) << other.err;
  EXPECT_NE(other.err.find("another set"), std::string::npos) << other.err;
  scratch_.write("s.toml", test::probe_scene() + "[cutting]\n\n");
  const auto edited = sweep(planned + "0.7,0.8");
  EXPECT_EQ(edited.status, 2);
  EXPECT_NE(edited.err.find("another scene_sha256"), std::string::npos) << edited.err;
  const auto alone = sweep("-o d" + kBuilt);
  EXPECT_EQ(alone.status, 2);
  EXPECT_NE(alone.err.find("another scene_sha256"), std::string::npos) << alone.err;
}

TEST_F(Sweep, GoesOnWithTheFilesThatItBeganWithAlone) {
  const std::string way = "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,0,0,9,1,0,0,0\n1,0,0,9,1,0,0,0\n",
                    other = way + "2,0,0,8,1,0,0,0\n";
  const std::string scene = test::probe_scene();
  const std::string follows = scene.substr(0, scene.find("[trajectory]")) + "[trajectory]\nfile = ";
  scratch_.write("beside/s.toml", follows + "\"way.csv\"\n");
  for (const char* name : {"beside/way.csv", "here.csv", "there.csv"}) scratch_.write(name, way);
  for (const auto& [asked, named] :
       {std::pair{"--set burr.diameter_mm=0.8 -o a", "beside/way.csv"},
        {"--set trajectory.file=here.csv,there.csv -o b", "there.csv"},
        {"--set burr.diameter_mm=0.8 -o c -- --set trajectory.file=here.csv", "here.csv"}}) {
    SCOPED_TRACE(asked);
    const std::string planned = "beside/s.toml --plan-only" + kBuilt + " " + asked;
    const auto begun = sweep(planned);
    ASSERT_EQ(begun.status, 0) << begun.err;
    EXPECT_EQ(sweep(planned).status, 0);
    scratch_.write(named, other);
    for (const std::string& again :
         {planned, std::string("-o ") +
                       std::string(asked).substr(std::string(asked).find("-o ") + 3, 1) + kBuilt}) {
      const auto changed = sweep(again);
      EXPECT_EQ(changed.status, 2) << again;
      EXPECT_EQ(changed.err_lines(), 1) << changed.err;
      EXPECT_NE(changed.err.find(named), std::string::npos) << changed.err;
    }
    scratch_.write(named, way);
    EXPECT_EQ(sweep(planned).status, 0);
  }
}

TEST_F(Sweep, TablesOfFinishedRunsNeedNoScene) {
  ASSERT_EQ(sweep("s.toml --set burr.diameter_mm=0.8 -o d" + kBuilt).status, 0);
  const std::string table = file("d/table.csv");
  std::filesystem::remove(scratch_.path("s.toml"));
  std::filesystem::remove(scratch_.path("d/table.csv"));
  const auto again = sweep("-o d" + kBuilt);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(file("d/table.csv"), table);
}

TEST_F(Sweep, ADamagedFolderIsRefusedAndOneWhoseBeginningWasKilledGoesOn) {
  const std::string planned = "s.toml --plan-only --set burr.diameter_mm=0.7,0.8 -o d" + kBuilt;
  ASSERT_EQ(sweep(planned).status, 0);
  std::filesystem::remove(scratch_.path("d/runs"));
  EXPECT_EQ(sweep(planned).status, 0) << "killed before the last step";
  std::filesystem::remove(scratch_.path("d/runs"));
  std::filesystem::remove(scratch_.path("d/sweep.json"));
  EXPECT_EQ(sweep(planned).status, 0) << "killed before the last but one";
  const std::string plan = file("d/plan.csv"), json = file("d/sweep.json");
  const auto refused = [&](const std::string& what) {
    for (const std::string& again : {planned, "--plan-only -o d" + kBuilt}) {
      const auto result = sweep(again);
      EXPECT_EQ(result.status, 2) << what << ": " << result.err;
      EXPECT_EQ(result.err_lines(), 1) << what << ": " << result.err;
    }
  };
  for (const std::string& damaged : {std::string(), std::string("run,seed\n"), plan.substr(0, 40),
                                     plan + "2,,0.9,runs/000002\n", std::string("\xff\xfe\0", 3)}) {
    scratch_.write("d/plan.csv", damaged);
    refused("plan.csv: " + damaged);
  }
  scratch_.write("d/plan.csv", plan);
  for (const std::string& damaged :
       {std::string(), std::string("{}"), std::string("[]"), json.substr(0, json.size() / 2)}) {
    scratch_.write("d/sweep.json", damaged);
    refused("sweep.json: " + damaged);
  }
  scratch_.write("d/sweep.json", json);
  EXPECT_EQ(sweep("--plan-only -o d" + kBuilt).status, 0);
}

TEST_F(Sweep, AShippedSceneIsKnownByItsName) {
  const auto planned = sweep("minimal --set burr.diameter_mm=0.8 --plan-only -o d" + kBuilt);
  EXPECT_EQ(planned.status, 0) << planned.err;
  EXPECT_NE(file("d/sweep.json").find("/scenes/minimal.toml"), std::string::npos);
  const auto other =
      sweep("../scenes/minimal --set burr.diameter_mm=0.8 --plan-only -o e" + kBuilt);
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("../scenes/minimal: no such file"), std::string::npos) << other.err;
}

TEST_F(Sweep, AChartOfNoSuchColumnIsRefusedByItsNearest) {
  const auto result =
      sweep("s.toml --set burr.diameter_mm=0.8 -o d --chart run force_N.meen" + kBuilt);
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err_lines(), 1) << result.err;
  EXPECT_NE(result.err.find("'force_N.mean'"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace sulcus::sweep_test
