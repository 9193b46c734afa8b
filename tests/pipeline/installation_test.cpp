#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

// What `cmake --install` makes, in a folder of a test's own: the program, and the library in a
// program of somebody else.

namespace sulcus::installation_test {
namespace {

namespace fs = std::filesystem;

/// Standard output of a command, which must end with status 0.
std::string run(const ScratchFolder& scratch, const std::string& program,
                const std::string& arguments) {
  const auto result = test::program_command(program, arguments, scratch.path("err"));
  EXPECT_EQ(result.status, 0) << program << " " << arguments << "\n" << result.out << result.err;
  return result.out;
}

void install(const ScratchFolder& scratch, const std::string& component) {
  run(scratch, SULCUS_CMAKE,
      "--install " SULCUS_BINARY_DIR " --component " + component + " --prefix " +
          scratch.path("installed"));
}

TEST(Installation, AProgramOfOthersIsLinkedWithTheHapticCoreAlone) {
  const ScratchFolder scratch;
  install(scratch, "development");
  const std::string build = scratch.path("build");
  run(scratch, SULCUS_CMAKE,
      "-G Ninja -S " SULCUS_SOURCE_DIR "/tools/install/embed -B " + build +
          " -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_COMPILER=" SULCUS_COMPILER
          " -D CMAKE_PREFIX_PATH=" +
          scratch.path("installed"));
  run(scratch, SULCUS_CMAKE, "--build " + build);

  // The burr goes into the ball at 0.15 mm/s from 0.05 mm above it, and cuts.
  const std::string out = run(scratch, build + "/embed", "");
  unsigned contacts = 0;
  double force_N = 0.0;
  const std::string last = out.substr(std::min(out.size(), out.find("1000 ms")));
  ASSERT_EQ(std::sscanf(last.c_str(), "1000 ms %u voxels in contact %lf N", &contacts, &force_N), 2)
      << out;
  EXPECT_GT(contacts, 150u);
  EXPECT_GT(force_N, 0.5);
  EXPECT_NE(out.find(" 100 ms     0 voxels in contact"), std::string::npos) << out;

  // Neither named when it is linked nor loaded when it is run.
  const std::string linked =
      test::read_file(build + "/build.ninja") + run(scratch, "ldd", build + "/embed");
  EXPECT_NE(linked.find("libtbb"), std::string::npos);
  for (const char* library : {"libGL", "libEGL", "libepoxy", "libglfw", "libimgui", "hdf5",
                              "Bullet", "ITK", "libgdcm", "libspdlog"}) {
    EXPECT_EQ(linked.find(library), std::string::npos) << library;
  }
}

TEST(Installation, EveryHeaderStandsWithoutTheSources) {
  const ScratchFolder scratch;
  install(scratch, "development");
  const fs::path headers = scratch.path("installed/include/sulcus");
  std::string text;
  for (const auto& entry : fs::recursive_directory_iterator(headers)) {
    if (!entry.is_regular_file()) continue;
    text += "#include \"" + fs::relative(entry.path(), headers).generic_string() + "\"\n";
  }
  EXPECT_NE(text.find("\"haptics/tick.hpp\""), std::string::npos) << text;
  run(scratch, SULCUS_COMPILER,
      "-std=c++20 -fsyntax-only -I " + headers.string() + " -isystem " SULCUS_EIGEN " " +
          scratch.write("all.cpp", text));
  const std::string targets =
      test::read_file(scratch.path("installed/lib/cmake/sulcus/sulcus-targets.cmake"));
  EXPECT_NE(targets.find("sulcus::haptics"), std::string::npos);
  EXPECT_EQ(targets.find(SULCUS_SOURCE_DIR), std::string::npos) << "it cannot be moved";
}

TEST(Installation, TheProgramRunsItsScenesFromAnyFolder) {
  const ScratchFolder scratch;
  install(scratch, "program");
  // Moved: nothing of where it was built or installed is in it.
  fs::rename(scratch.path("installed"), scratch.path("moved"));
  fs::create_directories(scratch.path("elsewhere"));
  const std::string program =
      "-C " + scratch.path("elsewhere") + " " + scratch.path("moved/bin/sulcus");
  for (const char* scene : {"minimal", "minimal.toml", "scenes/minimal.toml"}) {
    run(scratch, "env", program + " run " + scene + " --duration 0.002");
    const std::string out = scratch.path("elsewhere/out");
    EXPECT_TRUE(fs::exists(out + "/minimal/summary.json")) << scene;
    fs::remove_all(out);
  }
  EXPECT_NE(run(scratch, "env", program + " inspect cut_sulcus").find("central sulcus"),
            std::string::npos);
  // A file of that name comes first; what is not there is refused as it was given.
  scratch.write("elsewhere/minimal", "no scene");
  for (const char* scene :
       {"minimal", "other", "/minimal", "elsewhere/minimal.toml", "scenes/../minimal"}) {
    const auto result =
        test::program_command("env", program + " run " + scene, scratch.path("err"));
    EXPECT_EQ(result.status, 2) << scene;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    EXPECT_NE(result.err.find("sulcus: " + std::string(scene) + ": "), std::string::npos)
        << result.err;
  }
  for (const char* file :
       {"share/man/man1/sulcus.1", "share/man/man1/sulcus-run.1", "share/man/man5/sulcus-scene.5",
        "share/sulcus/assets/tissues.toml", "share/bash-completion/completions/sulcus"}) {
    EXPECT_TRUE(fs::exists(scratch.path("moved/") + file)) << file;
  }
  // Device plug-ins are found where the installation has them.
  run(scratch, "env",
      program +
          " run press_plugin --no-render --duration 0.002 --set workpiece.voxel_mm=0.14 --set "
          "'workpiece.cells=[128, 128, 128]'");
  fs::remove(scratch.path("moved/lib/sulcus/plugins/sulcus_device_simulated.so"));
  const auto missing =
      test::program_command("env", program + " run press_plugin --no-render", scratch.path("err"));
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.err.find("moved/lib/sulcus/plugins"), std::string::npos) << missing.err;
}

TEST(Installation, AProgramInCIsBuiltByWhatPkgConfigSays) {
  const ScratchFolder scratch;
  install(scratch, "program");
  fs::rename(scratch.path("installed"), scratch.path("moved"));
  const std::string moved = scratch.path("moved"), press = scratch.path("press");
  const std::string says =
      run(scratch, "env",
          "PKG_CONFIG_PATH=" + moved + "/lib/pkgconfig pkg-config --cflags --libs sulcus");
  run(scratch, SULCUS_C_COMPILER,
      SULCUS_SANITIZE_OPTION " " SULCUS_SOURCE_DIR "/tools/examples/press.c -o " + press + " " +
          says.substr(0, says.find('\n')));
  const std::string out = run(scratch, "env", "LD_LIBRARY_PATH=" + moved + "/lib " + press);
  EXPECT_NE(out.find("300 ms"), std::string::npos) << out;
}

}  // namespace
}  // namespace sulcus::installation_test
