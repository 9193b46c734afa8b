#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

// The layers of the source tree: who may include what. app knows everything; haptics and what draws
// (engine/surface, engine/graphics) never see each other; both stand on the rest of engine; a
// library is named by the folder that wraps it and by no other.

namespace sulcus::layers_test {
namespace {

namespace fs = std::filesystem;

/// One #include line: in `file`, relative to the root, of `header`, as written.
struct Include {
  std::string file, header;
  int line = 0;
};

std::vector<Include> includes_of(const fs::path& root) {
  static const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> all;
  for (const char* top : {"engine", "haptics", "app", "tools/plugins"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / top)) {
      const std::string extension = entry.path().extension().string();
      // .in: what configure_file makes sources of. C: the plug-ins'.
      constexpr std::array kSources{".cpp", ".hpp", ".inl", ".in", ".c", ".h"};
      if (std::ranges::find(kSources, extension) == kSources.end()) continue;
      std::ifstream in(entry.path());
      std::string text;
      for (int line = 1; std::getline(in, text); ++line) {
        std::smatch match;
        if (text.find("include") == std::string::npos || !std::regex_search(text, match, pattern))
          continue;
        all.push_back({fs::relative(entry.path(), root).generic_string(), match[1], line});
      }
    }
  }
  std::sort(all.begin(), all.end(), [](const Include& a, const Include& b) {
    return a.file != b.file ? a.file < b.file : a.line < b.line;
  });
  return all;
}

const std::vector<Include>& includes() {
  static const std::vector<Include> all = includes_of(SULCUS_SOURCE_DIR);
  return all;
}

bool is_in(std::string_view file, std::string_view folder) { return file.starts_with(folder); }
bool is_drawing(std::string_view file) {
  return is_in(file, "engine/graphics/") || is_in(file, "engine/surface/");
}

bool is_face(std::string_view file) { return is_in(file, "haptics/c/"); }

/// Whether `header` belongs to a library, told by how its headers begin (any case).
bool is_of(std::string header, std::initializer_list<std::string_view> beginnings) {
  std::transform(header.begin(), header.end(), header.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](std::string_view b) { return header.starts_with(b); });
}

/// Fails for every include for which `forbidden` holds.
template <class Forbidden>
void expect_none(std::string_view rule, const Forbidden& forbidden) {
  for (const Include& include : includes()) {
    EXPECT_FALSE(forbidden(include))
        << include.file << ":" << include.line << " includes " << include.header << ": " << rule;
  }
}

TEST(Layers, TheSourcesAreFound) {
  EXPECT_GT(includes().size(), 300u);
  for (const char* folder :
       {"engine/core/", "engine/volume/", "engine/graphics/", "haptics/", "app/"}) {
    EXPECT_TRUE(std::any_of(includes().begin(), includes().end(), [&](const Include& i) {
      return is_in(i.file, folder);
    })) << folder;
  }
}

TEST(Layers, OwnHeadersAreNamedFromTheRoot) {
  const fs::path root = SULCUS_SOURCE_DIR;
  expect_none("our headers are named from the root, \"engine/...\"", [&](const Include& i) {
    const bool beside = fs::exists(root / fs::path(i.file).parent_path() / i.header);
    return i.header.find("..") != std::string::npos || (beside && !fs::exists(root / i.header));
  });
}

TEST(Layers, EngineKnowsNeitherHapticsNorApp) {
  expect_none("engine stands below haptics and app", [](const Include& i) {
    return is_in(i.file, "engine/") && (is_in(i.header, "haptics/") || is_in(i.header, "app/"));
  });
}

TEST(Layers, HapticsKnowsNeitherGraphicsNorApp) {
  expect_none("haptics sees no picture and no program", [](const Include& i) {
    const bool draws = is_drawing(i.header) && !is_face(i.file);
    return is_in(i.file, "haptics/") && (draws || is_in(i.header, "app/"));
  });
  expect_none("a tick's result is made into rows by app", [](const Include& i) {
    return is_in(i.file, "haptics/") && is_in(i.header, "engine/recording/");
  });
}

// What other programs take Sulcus by stands over haptics and engine, beside app; it draws nothing
// itself, but hands out the surface.
TEST(Layers, TheFaceStandsAboveHaptics) {
  expect_none("haptics does not know who takes it in", [](const Include& i) {
    return is_face(i.header) && !is_face(i.file) && !is_in(i.file, "app/");
  });
  expect_none("the face needs no graphics library", [](const Include& i) {
    return is_face(i.file) && is_in(i.header, "engine/graphics/");
  });
  expect_none("the interface stands on C alone", [](const Include& i) {
    return i.file == "haptics/c/sulcus.h" && i.header != "stddef.h" && i.header != "stdint.h";
  });
}

TEST(Layers, OnlyDrawingAndAppKnowDrawing) {
  expect_none("the rest of engine needs no picture", [](const Include& i) {
    return is_drawing(i.header) && !is_drawing(i.file) && !is_in(i.file, "app/") &&
           !is_face(i.file);
  });
  expect_none("the surface does not know how it is drawn", [](const Include& i) {
    return is_in(i.file, "engine/surface/") && is_in(i.header, "engine/graphics/");
  });
}

//   commands                 everything that the program is told to do
//   window                   what is shown and done in a window
//   inspect   live           what is printed of a file; a run under a hand, part by part
//   pictures                 pictures of a recording, and what is beside them
//   report                   results of a run: folder, summary, pages, log
//   playback                 recordings run again
//   session                  a run and its threads
//   report/page              what pages in a browser are made of
//   terminal   stream        what is said, other programs; a run as OpenIGTLink's messages
TEST(Layers, AFolderOfAppSeesThoseBelowIt) {
  const auto height = [](std::string_view file) {
    constexpr std::array<std::pair<std::string_view, int>, 12> kHeights{{{"app/terminal/", 1},
                                                                         {"app/stream/", 1},
                                                                         {"app/report/page/", 2},
                                                                         {"app/session/", 2},
                                                                         {"app/playback/", 3},
                                                                         {"app/report/", 4},
                                                                         {"app/inspect/", 5},
                                                                         {"app/live/", 5},
                                                                         {"app/pictures/", 5},
                                                                         {"app/window/", 6},
                                                                         {"app/python/", 7},
                                                                         {"app/commands/", 7}}};
    for (const auto& [below, level] : kHeights) {
      if (is_in(file, below)) return level;
    }
    return file.starts_with("app/main.") ? 8 : 0;  // the build's name
  };
  const auto folder = [](std::string_view file) { return file.substr(0, file.rfind('/')); };
  expect_none("a folder of app sees those below it", [&](const Include& i) {
    return is_in(i.file, "app/") && is_in(i.header, "app/") && folder(i.file) != folder(i.header) &&
           height(i.header) >= height(i.file);
  });
}

TEST(Layers, CoreStandsOnNothing) {
  expect_none("engine/core is the floor", [](const Include& i) {
    return is_in(i.file, "engine/core/") && is_in(i.header, "engine/") &&
           !is_in(i.header, "engine/core/");
  });
}

TEST(Layers, NormalsStandBelowTheScene) {
  expect_none("normals have settings of their own, which a scene contains", [](const Include& i) {
    return is_in(i.file, "engine/normals/") && is_in(i.header, "engine/") &&
           !is_in(i.header, "engine/normals/") && !is_in(i.header, "engine/volume/") &&
           !is_in(i.header, "engine/core/");
  });
}

TEST(Layers, OnlyImportAndAppKnowTheLoadCache) {
  expect_none("what makes a thing does not know that it is kept", [](const Include& i) {
    return is_in(i.header, "engine/cache/") && !is_in(i.file, "engine/cache/") &&
           !is_in(i.file, "engine/import/") && !is_in(i.file, "app/");
  });
}

TEST(Layers, APluginKnowsNothingOfUsButItsHeader) {
  expect_none("a plug-in is a vendor's: its header, and the system's", [](const Include& i) {
    return is_in(i.file, "tools/plugins/") && i.header != "sulcus_device.h" &&
           fs::exists(fs::path(SULCUS_SOURCE_DIR) / i.header);
  });
  expect_none("the interface stands on C alone", [](const Include& i) {
    return i.file == "haptics/device/sulcus_device.h" && i.header != "stddef.h" &&
           i.header != "stdint.h";
  });
  expect_none("devices that are loaded are app's", [](const Include& i) {
    return i.header == "haptics/device/sulcus_device.h" && !is_in(i.file, "app/");
  });
}

TEST(Layers, NothingIncludesTests) {
  expect_none("the program does not know its tests", [](const Include& i) {
    return is_in(i.header, "tests/") || is_of(i.header, {"gtest/", "gmock/"});
  });
}

TEST(Layers, OnlyImportNamesItk) {
  expect_none("volumes come in through engine/import", [](const Include& i) {
    return is_of(i.header, {"itk", "vnl/"}) && !is_in(i.file, "engine/import/");
  });
}

TEST(Layers, OnlyImportNamesAssimp) {
  expect_none("assimp writes mesh files", [](const Include& i) {
    return is_of(i.header, {"assimp/"}) && !is_in(i.file, "engine/import/");
  });
}

TEST(Layers, OnlyTheStreamNamesOpenIgtLink) {
  expect_none("messages are app/stream's", [](const Include& i) {
    return is_of(i.header, {"igtl"}) && !is_in(i.file, "app/stream/");
  });
}

TEST(Layers, OnlyPagesNameMeshoptimizer) {
  expect_none("what is felt, exported and measured is not simplified", [](const Include& i) {
    return is_of(i.header, {"meshoptimizer"}) && !is_in(i.file, "app/report/page/");
  });
}

TEST(Layers, OnlyRecordingNamesHdf5) {
  expect_none("recordings are engine/recording's", [](const Include& i) {
    return is_of(i.header, {"hdf5", "h5"}) && !is_in(i.file, "engine/recording/");
  });
}

TEST(Layers, OnlySoundNamesLibsndfile) {
  expect_none("sound files are engine/sound's", [](const Include& i) {
    return is_of(i.header, {"sndfile"}) && !is_in(i.file, "engine/sound/");
  });
}

TEST(Layers, OnlyBodiesNamesBullet) {
  expect_none("bodies are engine/bodies'", [](const Include& i) {
    return is_of(i.header, {"bt", "bullet", "linearmath/"}) && !is_in(i.file, "engine/bodies/");
  });
}

TEST(Layers, OnlyGraphicsNamesGl) {
  expect_none("drawing is engine/graphics'", [](const Include& i) {
    return is_of(i.header,
                 {"epoxy/", "egl/", "gl/", "gles", "khr/", "glfw/", "imgui", "backends/"}) &&
           !is_in(i.file, "engine/graphics/");
  });
}

TEST(Layers, OnlyAppLogsAndReadsCommands) {
  expect_none("what the core has to say it returns or throws", [](const Include& i) {
    return is_of(i.header, {"spdlog/", "fmt/", "cli/"}) && !is_in(i.file, "app/");
  });
}

TEST(Layers, HapticsNamesNoThreadClockOrFile) {
  expect_none("a tick has no clock, lock, thread or file inside", [](const Include& i) {
    return is_in(i.file, "haptics/") &&
           (is_of(i.header, {"tbb/", "oneapi/", "readerwriterqueue", "toml++/"}) ||
            is_of(i.header, {"thread", "mutex", "chrono", "fstream", "iostream", "ctime", "cstdio",
                             "condition_variable", "random"}));
  });
}

}  // namespace
}  // namespace sulcus::layers_test
