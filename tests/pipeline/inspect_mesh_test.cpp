// What inspect says and draws of a mesh, and of a scene; of meshes in other units, run as well. The
// truth is a box of 10 x 6 x 8 mm.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/png_file.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::inspect_mesh_test {
namespace {

class InspectMesh : public testing::Test {
 protected:
  test::CommandResult command(const std::string& arguments) {
    return test::sulcus_command(arguments, scratch_.path("err"),
                                "-C " + scratch_.path("") + " SULCUS_CACHE=off");
  }
  std::string inspected(const std::string& arguments) {
    const auto result = command("inspect " + arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  }
  nlohmann::json summary(const std::string& folder) const {
    return nlohmann::json::parse(test::read_file(scratch_.path(folder + "/summary.json")));
  }
  ScratchFolder scratch_;
};

/// The box as OBJ, its lowest corner at (100, 200, 300) mm, in a unit of so many mm.
std::string box_obj(double unit_mm = 1.0) {
  std::ostringstream obj;
  obj.precision(12);
  for (int c = 0; c < 8; ++c) {
    obj << "v " << (100 + 10 * (c & 1)) / unit_mm << ' ' << (200 + 6 * (c >> 1 & 1)) / unit_mm
        << ' ' << (300 + 8 * (c >> 2)) / unit_mm << '\n';
  }
  return obj.str() + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
}

std::string first_match(const std::string& text, const std::string& pattern) {
  std::smatch match;
  return std::regex_search(text, match, std::regex(pattern)) ? match[1].str() : "";
}

TEST_F(InspectMesh, SaysWhereItLiesInASceneAndTheCommandThatCutsIt) {
  scratch_.write("a box.obj", box_obj());
  const std::string out = inspected("'a box.obj'");
  for (const std::string line :
       {"size             10.000 x 6.000 x 8.000 mm\n",
        "box in the file  (100.000, 200.000, 300.000) to (110.000, 206.000, 308.000) mm\n",
        "box in a scene   (-5.000, -3.000, -4.000) to (5.000, 3.000, 4.000) mm",
        "highest place    (-5.000, -3.000, 4.000) mm in a scene\n",
        "open edges       0 (closed)\n"}) {
    EXPECT_NE(out.find(line), std::string::npos) << line << out;
  }
  EXPECT_NEAR(std::stod(first_match(out, "volume +([0-9.]+)")), 480.0, 0.01) << out;
  EXPECT_EQ(out.find("question"), std::string::npos) << out;
  const std::string cut = first_match(out, "to cut it +sulcus (.*)");
  const auto run = command(cut + " --no-render -o out");
  ASSERT_EQ(run.status, 0) << cut << run.err;
  EXPECT_EQ(run.err.find("beyond the grid"), std::string::npos) << run.err;
  EXPECT_EQ(run.err.find("as no tooth is"), std::string::npos) << run.err;
  EXPECT_GT(summary("out")["removed_voxels"], 0);
  EXPECT_NEAR(summary("out")["workpiece_start"]["tissue_mm3"]["enamel"], 480.0, 1.0);
}

TEST_F(InspectMesh, AsksForTheUnitOfWhatIsNoToothAndTakesIt) {
  for (const auto& [unit, unit_mm, spoken] :
       {std::tuple{"in", 25.4, "inches"}, {"m", 1000.0, "metres"}, {"um", 1e-3, "micrometres"}}) {
    scratch_.write("box.obj", box_obj(unit_mm));
    const std::string out = inspected("box.obj");
    EXPECT_NE(out.find("as no tooth is"), std::string::npos) << out;
    EXPECT_NE(out.find(std::string(spoken) + " it would be 10 mm (unit = \"" + unit + "\")"),
              std::string::npos)
        << out;
    EXPECT_EQ(out.find("sulcus run"), std::string::npos) << out;
    const std::string told = inspected(std::string("box.obj --unit ") + unit);
    EXPECT_NE(told.find("size             10.000 x 6.000 x 8.000 mm\n"), std::string::npos) << told;
    const std::string cut = first_match(told, "to cut it +sulcus (.*)");
    const auto run = command(cut + " --no-render --force -o out");
    ASSERT_EQ(run.status, 0) << cut << run.err;
    EXPECT_EQ(run.err.find("as no tooth is"), std::string::npos) << run.err;
    EXPECT_NEAR(summary("out")["workpiece_start"]["tissue_mm3"]["enamel"], 480.0, 1.0) << unit;
    // The recording says the unit, and needs the file no more.
    EXPECT_NE(inspected("out").find("480."), std::string::npos);
    EXPECT_EQ(command("replay --verify out").status, 0);
  }
}

TEST_F(InspectMesh, ARunDoubtsWhatIsNoToothToo) {
  const std::string scene = R"(
[workpiece]
file = "box.obj"
voxel_mm = 0.01
cells = [64, 64, 64]
[trajectory]
points_mm = [[0, 0, 1], [0, 0, 0.9]]
)";
  scratch_.write("s.toml", scene);
  scratch_.write("box.obj", box_obj(25.4));
  const auto doubted = command("run s.toml -o out");
  EXPECT_EQ(doubted.status, 0) << doubted.err;
  EXPECT_NE(doubted.err.find("box.obj: the mesh is 0.394 mm long, as no tooth is"),
            std::string::npos)
      << doubted.err;
  EXPECT_NE(doubted.err.find("nothing was touched"), std::string::npos) << doubted.err;
  scratch_.write("box.obj", box_obj(1e4));
  const auto lost = command("run s.toml -o out2 --set workpiece.voxel_mm=0.1");
  EXPECT_EQ(lost.status, 2);
  EXPECT_EQ(lost.err_lines(), 1) << lost.err;
  EXPECT_NE(lost.err.find("no voxel of the grid inside"), std::string::npos) << lost.err;
  EXPECT_NE(lost.err.find("0.001 mm long, as no tooth is"), std::string::npos) << lost.err;
  const auto wrong = command("run minimal -o out3 --set workpiece.unit=\"m\"");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find("a unit beside a built-in shape"), std::string::npos) << wrong.err;
  EXPECT_EQ(command("inspect s.toml --unit m").status, 2);
}

TEST_F(InspectMesh, ABurrMayBeInAnotherUnitAsWell) {
  scratch_.write("burr.obj", [] {  // a prism of 1 x 1 x 6 mm, in metres
    std::ostringstream obj;
    for (int c = 0; c < 8; ++c) {
      obj << "v " << 1e-3 * (c & 1) << ' ' << 1e-3 * (c >> 1 & 1) << ' ' << 6e-3 * (c >> 2) << '\n';
    }
    return obj.str() + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  }());
  EXPECT_NE(inspected("burr.obj --as-burr --unit m").find("of 6.000 mm"), std::string::npos);
  scratch_.write("s.toml", test::block_and_burr() + "[trajectory]\npoints_mm = [[0, 0, 1.1]]\n");
  const std::string set = " --set burr.file=burr.obj --set burr.field=auto --set burr.unit=";
  EXPECT_NE(inspected("s.toml" + set + "m --picture b.png").find("of 6.000 mm"), std::string::npos);
  EXPECT_EQ(command("inspect s.toml" + set + "mm --picture b.png").status, 2);
}

using Colour = std::array<int, 3>;

Colour pixel(const Image& image, int x, int y) {
  const std::size_t at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                              static_cast<std::size_t>(x));
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}

/// The box about all pixels of a colour below `top`, within columns [left, right).
struct Extent {
  int left = 1 << 20, right = -1, top = 1 << 20, bottom = -1;
  int width() const { return right - left + 1; }
  int height() const { return bottom - top + 1; }
};
Extent extent(const Image& image, const Colour& colour, int top, int left, int right,
              int slack = 0) {
  Extent found;
  for (int y = top; y < image.height; ++y) {
    for (int x = left; x < right; ++x) {
      const Colour here = pixel(image, x, y);
      bool like = true;
      for (std::size_t c = 0; c < 3; ++c) like &= std::abs(here[c] - colour[c]) <= slack;
      if (!like) continue;
      found.left = std::min(found.left, x);
      found.right = std::max(found.right, x);
      found.top = std::min(found.top, y);
      found.bottom = std::max(found.bottom, y);
    }
  }
  return found;
}

/// Columns with a colour, as runs that lie further apart than a line is wide.
std::vector<std::pair<int, int>> runs_of(const Image& image, const Colour& colour, int top) {
  std::vector<std::pair<int, int>> runs;
  for (int x = 0; x < image.width; ++x) {
    bool here = false;
    for (int y = top; y < image.height && !here; ++y) here = pixel(image, x, y) == colour;
    if (!here) continue;
    if (runs.empty() || x > runs.back().second + 10) runs.emplace_back(x, x);
    runs.back().second = x;
  }
  return runs;
}

TEST_F(InspectMesh, ItsPictureIsTrueToScaleAndMarksTheHighestPlace) {
  scratch_.write("box.obj", box_obj());
  inspected("box.obj --picture box.png");
  const Image image = test::read_png(scratch_.path("box.png"));
  constexpr int kTop = 70;  // below the titles
  // Faces that are seen straight from before have one colour: the most frequent but white.
  std::map<Colour, int> counts;
  for (int y = kTop; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) ++counts[pixel(image, x, y)];
  }
  counts.erase(Colour{255, 255, 255});
  const Colour face =
      std::ranges::max_element(counts, {}, [](const auto& c) { return c.second; })->first;
  const auto runs = runs_of(image, face, kTop);
  ASSERT_EQ(runs.size(), 3u);
  const std::array<std::array<double, 2>, 3> sizes_mm{{{10, 6}, {10, 8}, {6, 8}}};
  const double pixels_per_mm = 0.1 * (runs[0].second - runs[0].first + 1);
  EXPECT_GT(pixels_per_mm, 30.0);
  const Colour mark{0xd6, 0x27, 0x28};
  for (std::size_t view = 0; view < 3; ++view) {
    const int left = runs[view].first, right = runs[view].second + 1;
    const Extent shown = extent(image, face, kTop, left, right);
    EXPECT_NEAR(shown.width() / pixels_per_mm, sizes_mm[view][0], 0.06);
    EXPECT_NEAR(shown.height() / pixels_per_mm, sizes_mm[view][1], 0.06);
    // The first of the highest corners is the one at the least x and y.
    const Extent cross = extent(image, mark, kTop, left - 25, left + 25, 60);
    EXPECT_NEAR(0.5 * (cross.left + cross.right), shown.left, 2.0);
    EXPECT_NEAR(0.5 * (cross.top + cross.bottom), view == 0 ? shown.bottom : shown.top, 2.0);
  }
}

TEST_F(InspectMesh, OfASceneAllThatIsFeltIsSaid) {
  scratch_.write("s.toml", test::block_and_burr() + R"(
[trajectory]
points_mm = [[0, 0, 2], [0, 0, 1]]
speed_mm_per_s = 0.5
[haptics]
normals = "ldm_fast"
[device]
model = "simulated"
[coupling]
stiffness_N_per_mm = 0.9
[cutting]
[goal]
shape = "box"
size_mm = [1, 1, 0.5]
position_mm = [0, 0, 0.75]
)");
  const std::string out = inspected("s.toml");
  for (const std::string part :
       {"workpiece        built-in box\n", "burr             round, 0.8 mm, 100000 rpm\n",
        "normals ldm_fast over 10 voxels", "device           simulated, at most 3.3 N\n",
        "coupling         0.9 N/mm, at most 3.3 N\n", "trajectory       2.000 s, 2000 ticks\n",
        "cutting          law paper\n",
        "goal             box of 1 x 1 x 0.5 mm, at (0, 0, 0.75) mm\n"}) {
    EXPECT_NE(out.find(part), std::string::npos) << part << out;
  }
  const auto absent = command("inspect s.toml --set workpiece.file=none.stl");
  EXPECT_EQ(absent.status, 2);
  EXPECT_EQ(absent.err_lines(), 1) << absent.err;
  EXPECT_NE(absent.err.find("none.stl', which is not there"), std::string::npos) << absent.err;
}

}  // namespace
}  // namespace sulcus::inspect_mesh_test
