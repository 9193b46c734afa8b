#include "tools/sulcus_lab/laws/laws.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.hpp"
#include "tools/sulcus_lab/laws/law_rig.hpp"
#include "tools/sulcus_lab/laws/law_shapes.hpp"
#include "tools/sulcus_lab/laws/laws_page.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab::laws_test {
namespace {

// The quick half of `sulcus-lab laws`: what holds is held.

/// Rows that are not met yet, by law, scaling and how shape, setting and quantity begin. When all
/// of its rows are met the line goes.
struct NotYet {
  std::string_view law, scaling, shape, setting, quantity;
  SurfaceKind surface = SurfaceKind::kBinary;
};
constexpr SurfaceKind kFractions = SurfaceKind::kFractions;
constexpr NotYet kNotYet[] = {
    {"device_way", "none", "box", "", "given_out"},
    {"device_way", "potential", "wall", "", "given_out"},
    {"two_bodies", "smooth", "flat", "", "removed_off"},
    {"stiffness_and_voxels", "smooth", "", "voxels of 0.1 mm 0.03 mm", ""},
    {"stiffness_and_voxels", "smooth", "", "voxels of 0.1 mm 0.06 mm", ""},
    {"stiffness_and_voxels", "smooth", "steep plane", "voxels of 0.05 mm 0.03 mm", ""},
    {"stiffness_and_voxels", "potential", "steep plane", "voxels of 0.1 mm 0.06 mm", ""},
    {"groove_direction", "none", "groove", "mean", "off_the_bisector"},
    {"groove_direction", "count", "groove", "mean", "off_the_bisector"},
    {"groove_direction", "smooth", "groove", "mean", "off_the_bisector"},
    {"groove_direction", "potential", "groove of 60", "mean", "off_the_bisector"},
    {"groove_direction", "potential", "groove of 90", "mean", "off_the_bisector"},
    // With fractions, as of whole voxels, but under `potential`.
    {"turned_cut", "none", "box", "", "other_voxels", kFractions},
    {"turned_cut", "count", "box", "", "other_voxels", kFractions},
    {"turned_cut", "smooth", "box", "", "other_voxels", kFractions},
    {"turned_cut", "potential", "box", "", "other_voxels", kFractions},
    {"two_bodies", "count", "flat", "", "removed_off", kFractions},
    {"two_bodies", "smooth", "flat", "", "removed_off", kFractions},
    {"two_bodies", "potential", "flat", "", "removed_off", kFractions},
    {"stiffness_and_voxels", "smooth", "", "voxels of 0.1 mm 0.03 mm", "", kFractions},
    {"stiffness_and_voxels", "smooth", "", "voxels of 0.1 mm 0.06 mm", "", kFractions},
    {"stiffness_and_voxels", "smooth", "steep plane", "voxels of 0.05 mm 0.03 mm", "", kFractions},
    {"groove_direction", "none", "groove", "mean", "off_the_bisector", kFractions},
    {"groove_direction", "count", "groove", "mean", "off_the_bisector", kFractions},
    {"groove_direction", "smooth", "groove", "mean", "off_the_bisector", kFractions},
};

bool matches(const NotYet& miss, const LawRow& row) {
  return row.law == miss.law && (miss.scaling.empty() || row.scaling == miss.scaling) &&
         row.shape.starts_with(miss.shape) && row.setting.starts_with(miss.setting) &&
         row.quantity.starts_with(miss.quantity);
}

void expect_law(std::string_view name, SurfaceKind surface = SurfaceKind::kBinary) {
  LawOptions options;
  options.quick = true;
  options.surface = surface;
  const std::vector<LawRow> rows = measure_law(name, options);
  EXPECT_FALSE(rows.empty());
  for (const LawRow& row : rows) {
    EXPECT_TRUE(std::isfinite(row.value)) << row.shape << ", " << row.quantity;
    const bool known = std::ranges::any_of(
        kNotYet, [&](const NotYet& miss) { return miss.surface == surface && matches(miss, row); });
    EXPECT_TRUE(row.pass() || known)
        << row.law << ", " << row.shape << ", " << row.scaling << ", " << row.setting << ", "
        << row.quantity << ": " << row.value << ", wanted " << row.limit.value_or(0.0);
  }
  for (const NotYet& miss : kNotYet) {
    if (miss.law != name || miss.surface != surface) continue;
    EXPECT_TRUE(std::ranges::any_of(
        rows, [&](const LawRow& row) { return matches(miss, row) && !row.pass(); }))
        << "holds now, its line can go: " << miss.law << ", " << miss.scaling << ", " << miss.shape
        << ", " << miss.setting << ", " << miss.quantity;
  }
}

TEST(Laws, AtRest) { expect_law("at_rest"); }
TEST(Laws, AnotherWay) { expect_law("another_way"); }
TEST(Laws, Symmetries) { expect_law("symmetries"); }
TEST(Laws, TurnedCut) { expect_law("turned_cut"); }
TEST(Laws, ClosedWay) { expect_law("closed_way"); }
TEST(Laws, CoupledWay) { expect_law("coupled_way"); }
TEST(Laws, DeviceWay) { expect_law("device_way"); }
TEST(Laws, TwoBodies) { expect_law("two_bodies"); }
TEST(Laws, CuttingBalance) { expect_law("cutting_balance"); }
TEST(Laws, RemovedAndVoxels) { expect_law("removed_and_voxels"); }
TEST(Laws, StiffnessAndVoxels) { expect_law("stiffness_and_voxels"); }
TEST(Laws, JumpAndSilence) { expect_law("jump_and_silence"); }
TEST(Laws, LongSteps) { expect_law("long_steps"); }
TEST(Laws, FreeSlide) { expect_law("free_slide"); }
TEST(Laws, QuietController) { expect_law("quiet_controller"); }
TEST(Laws, GrooveDirection) { expect_law("groove_direction"); }

/// Those that take seconds.
class LawsWithFractions : public ::testing::TestWithParam<const char*> {};
TEST_P(LawsWithFractions, Hold) { expect_law(GetParam(), kFractions); }
INSTANTIATE_TEST_SUITE_P(All, LawsWithFractions,
                         ::testing::Values("at_rest", "another_way", "symmetries", "turned_cut",
                                           "closed_way", "coupled_way", "two_bodies",
                                           "cutting_balance", "stiffness_and_voxels",
                                           "jump_and_silence", "groove_direction"),
                         [](const auto& law) { return std::string(law.param); });

/// A plane through the middle of a cube leaves half of it, an edge a quarter.
TEST(LawShapes, AreAsLargeAsTheyAre) {
  for (const SurfaceKind surface : {SurfaceKind::kBinary, kFractions}) {
    const double most_off = surface == kFractions ? 1e-5 : 1e-3;
    const LawShape plane = law_shape("plane", surface), box = law_shape("box", surface);
    const auto cells = static_cast<double>(plane.model.grid.cell_count());
    EXPECT_NEAR(filled_voxels(plane.model) / cells, 0.5, most_off);
    EXPECT_EQ(filled_voxels(box.model), 0.25 * cells);
    EXPECT_EQ(filled_voxels(box.model, 0), filled_voxels(box.model));
    EXPECT_EQ(filled_voxels(box.model, 1), 0.0);
  }
}

/// A ball on a plane through the origin touches it at its radius.
TEST(LawShapes, ABallTouchesAPlaneAtItsRadius) {
  const LawShape plane = law_shape("plane");
  for (const double aside_m : {0.0, 0.13e-3, -0.27e-3}) {
    const Eigen::Vector3d centre = touching_centre(plane, aside_m * plane.across);
    EXPECT_NEAR(plane.normal.dot(centre), kLawRadius_m, 0.5 * kLawVoxel_m);
  }
}

TEST(LawShapes, ACircleBeginsInFreeAirAndComesToItsDepth) {
  for (const std::string_view name : law_shape_names()) {
    SCOPED_TRACE(name);
    const LawShape shape = law_shape(name);
    LawRig rig(law_scene({}), shape.model);
    std::vector<std::uint32_t> contacts;
    for (const Eigen::Vector3d& centre : circle_over(shape, 0.1e-3, 0.3e-3, 20e-6, false)) {
      contacts.push_back(rig.step(pose_at_centre(centre)).contact.contacts);
    }
    EXPECT_EQ(contacts.front(), 0u);
    EXPECT_GT(contacts[contacts.size() / 2], 5u);
  }
}

LawRow row_of(std::string law, std::string scaling, double value, double limit) {
  return {.law = std::move(law),
          .shape = "box",
          .scaling = std::move(scaling),
          .setting = "<here>",
          .quantity = "given_out_uJ",
          .value = value,
          .limit = limit};
}

TEST(LawsPage, TellsWhatPassedAndWhatFailed) {
  const std::vector<LawRow> rows{row_of("closed_way", "smooth", 0.1, 0.2),
                                 row_of("closed_way", "count", 0.3, 0.2),
                                 row_of("closed_way", "none", NAN, 0.2)};
  const std::string page = laws_page(rows, "", "build <1>");
  const auto count = [&](const std::string& text) {
    int found = 0;
    for (std::size_t at = page.find(text); at != std::string::npos; at = page.find(text, at + 1)) {
      ++found;
    }
    return found;
  };
  EXPECT_EQ(count("&#10003; pass"), 2);  // in the summary and in the law's own table
  EXPECT_EQ(count("&#10007; FAIL"), 4);
  EXPECT_EQ(count("Not run this time."), static_cast<int>(laws().size()) - 1);
  EXPECT_EQ(count("&lt;here&gt;"), 6);
  EXPECT_EQ(count("build &lt;1&gt;"), 1);
}

TEST(LawsPage, TheChartOfClosedWaysIsDrawn) {
  ScratchFolder folder;
  folder.write("laws.csv",
               "law,shape,scaling,setting,quantity,value,limit,pass\n"
               "at_rest,\"box\",smooth,\"normals kept\",change_N,0.1,0,no\n"
               "closed_way,\"box\",smooth,\"0.1 mm deep forth\",given_out_of_stored_percent,44,,\n"
               "closed_way,\"box\",smooth,\"0.1 mm deep back\",given_out_of_stored_percent,-31,,\n"
               "closed_way,\"blob\",count,\"0.1 mm deep back\",given_out_of_stored_percent,0.001,"
               ",\n");
  Results results(folder.path(""));
  EXPECT_TRUE(results.draw("laws", "laws"));
  EXPECT_GT(std::filesystem::file_size(folder.path("laws.png")), 5000u);
}

}  // namespace
}  // namespace sulcus::lab::laws_test
