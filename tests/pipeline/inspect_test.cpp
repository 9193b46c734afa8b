#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/png_file.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::inspect_test {
namespace {

using test::sulcus_command;
using Colour = std::array<int, 3>;

Colour pixel(const Image& image, int x, int y) {
  const std::size_t at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                              static_cast<std::size_t>(x));
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

/// Pixels of one colour: how many, and the box that they lie in.
struct Found {
  int count = 0, left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
  int width() const { return right - left + 1; }
  int height() const { return bottom - top + 1; }
};
Found find(const Image& image, const Colour& colour, int from_x = 0, int slack = 0) {
  Found found;
  for (int y = 0; y < image.height; ++y) {
    for (int x = from_x; x < image.width; ++x) {
      const Colour here = pixel(image, x, y);
      bool same = true;
      for (std::size_t c = 0; c < 3; ++c) same = same && std::abs(here[c] - colour[c]) <= slack;
      if (!same) continue;
      ++found.count;
      found.left = std::min(found.left, x);
      found.right = std::max(found.right, x);
      found.top = std::min(found.top, y);
      found.bottom = std::max(found.bottom, y);
    }
  }
  return found;
}

constexpr Colour kScaleBar{0x20, 0x24, 0x28}, kOutline{0xff, 0x7f, 0x0e}, kBlack{0, 0, 0};

/// The first match of a pattern's group, as a number; NaN: none.
double number(const std::string& text, const std::string& pattern) {
  std::smatch match;
  return std::regex_search(text, match, std::regex(pattern)) ? std::stod(match[1]) : std::nan("");
}

/// A ball of 2 mm radius in a scan whose voxels are three times as long along z; grey values with a
/// shell of enamel and some ripple for noise.
std::string write_scan(const ScratchFolder& scratch, const std::string& name) {
  constexpr int kN = 60, kNz = 20;
  std::string bytes =
      "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 60 60 20\nencoding: raw\nendian: little\n"
      "spacings: 0.1 0.1 0.3\n\n";
  for (int k = 0; k < kNz; ++k) {
    for (int j = 0; j < kN; ++j) {
      for (int i = 0; i < kN; ++i) {
        const double x = 0.1 * (i - 29.5), y = 0.1 * (j - 29.5), z = 0.3 * (k - 9.5);
        const double r = std::sqrt(x * x + y * y + z * z);
        const int ripple = (7 * i + 5 * j + 11 * k) % 40 - 20;
        const auto grey = static_cast<std::uint16_t>((r > 2.0   ? 200
                                                      : r > 1.5 ? 1400
                                                                : 900) +
                                                     ripple);
        bytes += static_cast<char>(grey & 0xff);
        bytes += static_cast<char>(grey >> 8);
      }
    }
  }
  return scratch.write(name, bytes);
}

TEST(Inspect, SuggestsThresholdsOfAVolume) {
  const ScratchFolder scratch;
  const auto result =
      sulcus_command("inspect " + write_scan(scratch, "scan.nrrd"), scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;
  const double dentine = number(result.out, "dentine from ([0-9.]+)");
  const double enamel = number(result.out, "enamel from ([0-9.]+)");
  EXPECT_GT(dentine, 221) << result.out;
  EXPECT_LT(dentine, 880);
  EXPECT_GT(enamel, 920);
  EXPECT_LT(enamel, 1380);
  // Half a voxel to either side of a step of 1200 that one sample to the next takes: the kernel
  // smears it over two thirds of that a voxel at its middle.
  const double empty = number(result.out, "surface empty at ([0-9.]+)");
  const double full = number(result.out, "full at ([0-9.]+)");
  EXPECT_NEAR(0.5 * (empty + full), dentine, 1.0) << result.out;
  EXPECT_NEAR(full - empty, 1200 * 2.0 / 3.0, 250);
  // 4/3 pi 2^3, in coarse voxels.
  EXPECT_NEAR(number(result.out, "solid +[0-9]+ voxels \\(([0-9.]+) mm3\\)"), 33.5, 1.5);
  EXPECT_NE(result.out.find("extent           6 x 6 x 6 mm"), std::string::npos) << result.out;
}

TEST(Inspect, ItsCommandCuts) {
  const ScratchFolder scratch;
  const std::string mask =
      scratch.write("a mask.nrrd",
                    "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 16 16 16\nencoding: raw\n"
                    "spacings: 0.1 0.1 0.1\n\n" +
                        std::string(4096, '\1'));
  const std::string unknown =  // says nothing of its spacing
      scratch.write("unknown.nrrd",
                    "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\n" +
                        std::string(64, '\1'));
  for (const std::string& file : {write_scan(scratch, "it's.nrrd"), mask, unknown}) {
    std::string quoted = std::regex_replace(file, std::regex("'"), "'\\''");
    const std::string told = file == unknown ? " --spacing-mm 1 1 1" : "";
    const auto inspected = sulcus_command("inspect '" + quoted + "'" + told, scratch.path("err"));
    ASSERT_EQ(inspected.status, 0) << inspected.err;
    std::smatch match;
    ASSERT_TRUE(std::regex_search(inspected.out, match, std::regex("to cut it +sulcus (.*)")))
        << inspected.out;
    const std::string out = scratch.path("out");
    const auto run = sulcus_command(
        std::string(match[1]) + " --no-render --force -o " + out + " --set haptics.neighbourhood=3",
        scratch.path("err"));
    ASSERT_EQ(run.status, 0) << match[1] << ": " << run.err;
    EXPECT_EQ(run.err.find("warning"), std::string::npos) << run.err;  // all of it is in the grid
    const std::string summary = test::read_file(out + "/summary.json");
    EXPECT_GT(number(summary, "\"removed_voxels\": *([0-9]+)"), 0) << file;
  }
}

TEST(Inspect, TakesNoSpacingThatIsNotSaid) {
  const ScratchFolder scratch;
  const std::string file = scratch.write(
      "unknown.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\n" +
                          std::string(64, '\1'));
  const auto untold = sulcus_command("inspect " + file, scratch.path("err"));
  EXPECT_EQ(untold.status, 0) << untold.err;
  EXPECT_NE(untold.out.find("spacing          not said by the file"), std::string::npos);
  EXPECT_EQ(untold.out.find("mm3"), std::string::npos) << untold.out;
  EXPECT_EQ(untold.out.find("sulcus run"), std::string::npos) << untold.out;
  const auto told =
      sulcus_command("inspect " + file + " --spacing-mm 0.5 0.5 2", scratch.path("err"));
  EXPECT_NE(told.out.find("solid            64 voxels (32.000 mm3)"), std::string::npos)
      << told.out;
  EXPECT_NE(told.out.find("workpiece.spacing_mm="), std::string::npos) << told.out;
  const auto run = sulcus_command("run scenes/minimal.toml --no-render -o " + scratch.path("out") +
                                      " --set workpiece.file=" + file,
                                  scratch.path("err"));
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("unknown.nrrd: spacing: found none in the file, expected spacing_mm"),
            std::string::npos)
      << run.err;
}

TEST(Inspect, WhatIsTakenAsSaidButNotAsItShouldBeIsTold) {
  const ScratchFolder scratch;
  const std::string nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3 3 3\nencoding: raw\n";
  const std::string odd =
      scratch.write("odd.nrrd", nrrd + "spacings: 0.1 0.1 0.1\n\n" + std::string(27, '\1'));
  const auto run =
      sulcus_command("run scenes/minimal.toml --no-render -o " + scratch.path("out") +
                         " --set workpiece.file=" + odd +
                         " --set workpiece.voxel_mm=0.1 --set 'workpiece.cells=[32,32,32]'",
                     scratch.path("err"));
  EXPECT_EQ(run.status, 0);
  EXPECT_NE(run.err.find("odd.nrrd: the solid lies (0.05, 0.05, 0.05) mm beside where "
                         "position_mm puts its middle"),
            std::string::npos)
      << run.err;
  // Of a body as well.
  const auto beside =
      sulcus_command("run scenes/minimal.toml --no-render -o " + scratch.path("beside") +
                         " --set 'body=[{name=\"crown\", file=\"" + odd +
                         "\", voxel_mm=0.1, cells=[32,32,32], position_mm=[0,0,-20]}]'",
                     scratch.path("err"));
  EXPECT_EQ(beside.status, 0) << beside.err;
  EXPECT_NE(beside.err.find("[[body]] 'crown': the solid lies (0.05, 0.05, 0.05) mm beside"),
            std::string::npos)
      << beside.err;
}

TEST(Inspect, TellsTheLabelsOfAMap) {
  const ScratchFolder scratch;
  std::string voxels(4 * 3 * 2, '\0');
  voxels[1] = voxels[2] = 7;
  voxels[23] = 3;
  const std::string file =
      scratch.write("labels.nrrd",
                    "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 3 2\nencoding: raw\n"
                    "spacings: 0.5 1 2\n\n" +
                        voxels);
  const std::string out = sulcus_command("inspect " + file, scratch.path("err")).out;
  EXPECT_NE(out.find("value 3          1 voxels (1.000 mm3), 1.5 to 2, 2 to 3, 2 to 4 mm"),
            std::string::npos)
      << out;
  EXPECT_NE(out.find("value 7          2 voxels (2.000 mm3), 0.5 to 1.5, 0 to 1, 0 to 2 mm"),
            std::string::npos)
      << out;
  EXPECT_EQ(out.find("percentiles"), std::string::npos) << out;
}

TEST(Inspect, ProposesATissueForEachValueOfAMap) {
  const ScratchFolder scratch;
  constexpr int kEdge = 24;
  std::string voxels(kEdge * kEdge * kEdge, '\0');
  for (int z = 4; z < 20; ++z) {
    for (int y = 4; y < 20; ++y) {
      for (int x = 4; x < 20; ++x) voxels[x + kEdge * (y + kEdge * z)] = z < 10 ? 3 : 7;
    }
  }
  const std::string file =
      scratch.write("map.nrrd",
                    "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 24 24 24\nencoding: raw\n"
                    "spacings: 0.2 0.2 0.2\n\n" +
                        voxels);
  const std::string said = sulcus_command("inspect " + file, scratch.path("err")).out;
  std::smatch match;
  ASSERT_TRUE(std::regex_search(said, match, std::regex("to cut it +sulcus (.*)"))) << said;
  const std::string out = scratch.path("out");
  const auto run =
      sulcus_command(std::string(match[1]) + " --duration 0.01 -o " + out, scratch.path("err"));
  ASSERT_EQ(run.status, 0) << match[1] << ": " << run.err;
  const std::string summary = test::read_file(out + "/summary.json");
  EXPECT_NEAR(number(summary, "\"label_3\": *([0-9.]+)"), 1536 * 0.008, 0.2);
  EXPECT_NEAR(number(summary, "\"label_7\": *([0-9.]+)"), 2560 * 0.008, 0.2);
}

TEST(Inspect, DrawsAVolumeInTrueProportion) {
  const ScratchFolder scratch;
  const std::string file = scratch.path("scan.png");
  const auto result = sulcus_command(
      "inspect " + write_scan(scratch, "scan.nrrd") + " --picture " + file, scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;
  const Image image = test::read_png(file);
  EXPECT_EQ(image.width, 1500);
  EXPECT_EQ(image.height, 1000);
  // The scale bars (1 mm) and the outline of a ball of 4 mm in three sections side by side.
  const Found bars = find(image, kScaleBar);
  const Found outline = find(image, kOutline, 0, 40);
  ASSERT_GT(bars.count, 0);
  ASSERT_GT(outline.count, 500);
  int bar = 0;  // the first
  while (pixel(image, bars.left + bar, (bars.top + bars.bottom) / 2) == kScaleBar) ++bar;
  // Sections are 6 mm wide: the first and the last outline's far sides are two frames, two gaps and
  // a ball apart; what is high of them is above the histogram.
  int top = 1 << 20, bottom = -1;
  for (int y = 0; y < bars.top; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const Colour c = pixel(image, x, y);
      if (std::abs(c[0] - 0xff) + std::abs(c[1] - 0x7f) + std::abs(c[2] - 0x0e) > 60) continue;
      top = std::min(top, y);
      bottom = std::max(bottom, y);
    }
  }
  // Along z, between the voxels at 1.95 and 2.25 mm, it lies at 2.16.
  EXPECT_NEAR((bottom - top) / static_cast<double>(bar), 4.32, 0.15);
  // The ball is as wide as it is high in the first section, whose frame is 6 bars wide.
  Found first;
  for (int y = 0; y < bars.top; ++y) {
    for (int x = bars.left; x < bars.left + 6 * bar; ++x) {
      const Colour c = pixel(image, x, y);
      if (std::abs(c[0] - 0xff) + std::abs(c[1] - 0x7f) + std::abs(c[2] - 0x0e) > 60) continue;
      first.left = std::min(first.left, x);
      first.right = std::max(first.right, x);
    }
  }
  EXPECT_NEAR(first.width() / static_cast<double>(bar), 4.0, 0.2);
}

TEST(Inspect, DrawsABurrWhoseZeroLineIsItsSurface) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", test::probe_scene());
  const std::string file = scratch.path("burr.png");
  const auto result =
      sulcus_command("inspect " + scene + " --picture " + file, scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("burr             round, 0.8 mm\n"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("field            48 x 192 x 48 points"), std::string::npos);
  EXPECT_LT(number(result.out, "field's error +([0-9.]+) um"), 20);
  const Image image = test::read_png(file);
  EXPECT_EQ(image.width, 1100);
  EXPECT_EQ(image.height, 1000);
  // The right scale bar is the head's: its last pixel row that has one.
  const Found bars = find(image, kScaleBar);
  int right = bars.right, bar = 0;
  while (pixel(image, right - bar, (bars.top + bars.bottom) / 2) == kScaleBar) ++bar;
  const int panel = right - bar;  // where the head's window begins
  const Found head = find(image, kBlack, panel);
  ASSERT_GT(head.count, 300);
  const double bar_mm = 0.5;  // a round number above 0.15 of its window's 2.5 times 0.8 mm
  EXPECT_NE(result.out.find("head             0.800 mm wide"), std::string::npos);
  // The line is 4 pixels wide, its middle is the surface; a white one over it leaves its edges.
  const double pixels_per_mm = bar / bar_mm;
  EXPECT_NEAR((head.width() - 4) / pixels_per_mm, 0.8, 0.02);
}

TEST(Inspect, TakesAMeshAsABurr) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", test::cut_scene());
  const auto run =
      sulcus_command("run " + scene + " -o " + scratch.path("out"), scratch.path("err"));
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string mesh = scratch.path("block.stl");  // of 2 mm, as a burr
  ASSERT_EQ(sulcus_command("export " + scratch.path("out/recording.h5") + " --mesh " + mesh,
                           scratch.path("err"))
                .status,
            0);
  const auto result = sulcus_command(
      "inspect " + mesh + " --as-burr --picture " + scratch.path("b.png"), scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("burr             block.stl, 2."), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("at the mesh's vertices"), std::string::npos) << result.out;
  EXPECT_GT(find(test::read_png(scratch.path("b.png")), kBlack).count, 300);
}

/// Two boxes of 2 mm that overlap by half, the second one's faces turned out or in.
std::string two_boxes(bool inwards, double scale = 1.0) {
  std::ostringstream obj;
  for (const int x : {0, 1}) {
    for (int c = 0; c < 8; ++c) {
      obj << "v " << scale * (x + 2 * (c & 1)) << ' ' << scale * (2 * (c >> 1 & 1)) << ' '
          << scale * (2 * (c >> 2)) << '\n';
    }
  }
  const int quads[6][4] = {{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5},
                           {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}};
  for (const int first : {0, 8}) {
    for (const auto& quad : quads) {
      obj << 'f';
      for (int c = 0; c < 4; ++c) obj << ' ' << first + quad[inwards && first > 0 ? 3 - c : c];
      obj << '\n';
    }
  }
  return obj.str();
}

TEST(Inspect, TellsShellsAndWhatIsSolidOfAMesh) {
  // 16 mm3 of triangles, 12 mm3 of solid.
  const ScratchFolder scratch;
  const auto inspected = [&](const std::string& contents) {
    return sulcus_command("inspect " + scratch.write("two.obj", contents), scratch.path("err")).out;
  };
  std::string out = inspected(two_boxes(false));
  EXPECT_NE(out.find("volume           16.000 mm3"), std::string::npos) << out;
  EXPECT_NE(out.find("shells           2\n"), std::string::npos) << out;
  EXPECT_NE(out.find("non-manifold     0 "), std::string::npos) << out;
  EXPECT_NEAR(number(out, "solid +([0-9.]+) mm3"), 12.0, 0.1) << out;
  EXPECT_EQ(out.find("metres"), std::string::npos) << out;
  out = inspected(two_boxes(false, 0.001));
  EXPECT_NE(out.find("It is 0.003 mm long, as no tooth is; in metres it would be 3 mm"),
            std::string::npos)
      << out;
}

TEST(Inspect, ShellsTurnedAgainstEachOtherAreToldAndNoWorkpieceNorBurr) {
  const ScratchFolder scratch;
  const std::string file = scratch.write("two.obj", two_boxes(true));
  const std::string out = sulcus_command("inspect " + file, scratch.path("err")).out;
  EXPECT_NE(
      out.find("shells           2\nsolid            not clear: shell 2 of 2, about (2, 1, 1) "
               "mm, turned against shell 1 and half over it: "),
      std::string::npos)
      << out;
  EXPECT_NEAR(number(out, "over it: ([0-9.]+) mm3 of both would be a hole"), 4.0, 0.3) << out;
  const std::string scene = scratch.write("s.toml", test::probe_scene());
  for (const std::string& as : {"--set workpiece.file=" + file, "--set burr.file=" + file}) {
    const auto run = sulcus_command("run " + scene + " " + as + " -o " + scratch.path("out"),
                                    scratch.path("err"));
    EXPECT_EQ(run.status, 2) << as;
    EXPECT_NE(run.err.find("two.obj: found shell 2 of 2, about (2, 1, 1) mm, turned against"),
              std::string::npos)
        << run.err;
  }
}

TEST(Inspect, RefusesPicturesOfWhatItDoesNotDraw) {
  const ScratchFolder scratch;
  const std::string mesh = scratch.write("m.stl", "x"), recording = scratch.write("r.h5", "x");
  const std::string scene = scratch.write("s.toml", test::probe_scene());
  for (const std::string& arguments :
       {mesh + " --picture " + scratch.path("p.png"),
        recording + " --picture " + scratch.path("p.png"), scene + " --as-burr"}) {
    const auto result = sulcus_command("inspect " + arguments, scratch.path("err"));
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(result.err_lines(), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(scratch.path("p.png")));
  }
  const auto nowhere = sulcus_command("inspect " + scene + " --picture " + scratch.path("no/p.png"),
                                      scratch.path("err"));
  EXPECT_EQ(nowhere.status, 2);
  EXPECT_EQ(nowhere.err_lines(), 1) << nowhere.err;
}

TEST(Inspect, RefusesALinkToItself) {
  const ScratchFolder scratch;
  const std::string loop = scratch.path("loop.toml");
  std::filesystem::create_symlink(loop, loop);
  const auto result = test::sulcus_command("inspect " + loop, scratch.path("err"));
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_EQ(result.err_lines(), 1) << result.err;
}

}  // namespace
}  // namespace sulcus::inspect_test
