#include "engine/scene/burr_number.hpp"

#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/tool/burr_profile.hpp"

namespace sulcus::burr_number_test {
namespace {

constexpr const char* kHead =
    "[workpiece]\nshape = \"box\"\n[trajectory]\npoints_mm = [[0, 0, 9]]\n[burr]\n";

BurrSettings burr_of(const std::string& lines, std::vector<std::string> overrides = {}) {
  return parse_scene(kHead + lines, "s.toml", overrides).burr;
}

std::string refusal_of(const std::string& lines, std::vector<std::string> overrides = {}) {
  try {
    burr_of(lines, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(BurrNumber, GivesShapeDiameterAndLength) {
  const BurrSettings ball = burr_of("iso = \"806 314 001 524 014\"");
  EXPECT_EQ(ball.shape, BurrShape::kRound);
  EXPECT_NEAR(ball.diameter_m, 1.4e-3, 1e-12);
  EXPECT_FALSE(ball.length_m);
  const struct {
    const char* iso;
    BurrShape shape;
    double diameter_mm, length_mm;
  } cases[] = {
      {"500314010001012", BurrShape::kInvertedCone, 1.2, 0},
      {"107010", BurrShape::kFissure, 1, 0},
      {"110 012", BurrShape::kFissure, 1.2, 6},
      {"111 010", BurrShape::kFissure, 1, 8},
      {"233 012", BurrShape::kPear, 1.2, 0},
      {"237 008", BurrShape::kPear, 0.8, 0},
      {"243 014", BurrShape::kFlame, 1.4, 0},
      {"247 010", BurrShape::kFlame, 1, 5},
      {"248 012", BurrShape::kFlame, 1.2, 6},
      {"249 010", BurrShape::kFlame, 1, 8},
      {"250 010", BurrShape::kFlame, 1, 10},
      {"001 003", BurrShape::kRound, 0.3, 0},
      {"001 050", BurrShape::kRound, 5, 0},
  };
  for (const auto& expected : cases) {
    SCOPED_TRACE(expected.iso);
    const BurrSettings burr = burr_of("iso = \"" + std::string(expected.iso) + "\"");
    EXPECT_EQ(burr.shape, expected.shape);
    EXPECT_NEAR(burr.diameter_m, expected.diameter_mm * 1e-3, 1e-12);
    EXPECT_NEAR(burr.length_m.value_or(0.0), expected.length_mm * 1e-3, 1e-12);
    // And the shape can be made of that size.
    EXPECT_NEAR(make_burr_profile(burr).head_diameter_m(), expected.diameter_mm * 1e-3, 1e-12);
  }
}

TEST(BurrNumber, GivesMaterialAndGrit) {
  const struct {
    const char* iso;
    BurrMaterial material;
    Grit grit;
  } cases[] = {
      {"806 314 001 514 014", BurrMaterial::kDiamond, Grit::kFine},
      {"806 314 001 524 014", BurrMaterial::kDiamond, Grit::kMedium},
      {"807 314 001 534 014", BurrMaterial::kDiamond, Grit::kCoarse},
      {"806 316 107 544 010", BurrMaterial::kDiamond, Grit::kSuperCoarse},
      {"500 314 107 001 010", BurrMaterial::kCarbide, Grit::kMedium},
      {"107 010", BurrMaterial::kDiamond, Grit::kMedium},
  };
  for (const auto& expected : cases) {
    const BurrSettings burr = burr_of("iso = \"" + std::string(expected.iso) + "\"");
    EXPECT_EQ(burr.material, expected.material) << expected.iso;
    EXPECT_EQ(burr.grit, expected.grit) << expected.iso;
  }
  // Of those that are not known nothing is asked where nothing depends on them.
  const std::string saturating = "\n[cutting]\nlaw = \"saturating\"";
  for (const auto& [iso, found] : {std::pair{"806 314 001 494 014", "found grit 494"},
                                   std::pair{"330 314 001 001 014", "found material 330"}}) {
    const std::string line = "iso = \"" + std::string(iso) + "\"";
    const std::string says = refusal_of(line + saturating);
    EXPECT_NE(says.find(std::string("burr.iso: ") + found), std::string::npos) << says;
    EXPECT_EQ(refusal_of(line), "");
    EXPECT_EQ(refusal_of(line + "\ngrit = \"fine\"" + saturating), "");
  }
}

TEST(BurrNumber, EveryRowHasASource) {
  std::set<std::string_view> numbers;
  for (const BurrShapeNumber& row : burr_shape_numbers()) {
    EXPECT_EQ(row.number.size(), 3u);
    EXPECT_FALSE(row.source.empty()) << row.number;
    EXPECT_TRUE(numbers.insert(row.number).second) << row.number;
  }
}

TEST(BurrNumber, RefusesWhatItDoesNotKnow) {
  const struct {
    const char *iso, *found;
  } cases[] = {
      {"806 314 292 524 014", "found shape 292, expected one of 001, 010, 107"},
      {"806 104 001 524 023", "found shank 104, expected 313 to 316"},
      {"001 002", "found size 002, expected 003 to 050"},
      {"001 051", "found size 051, expected 003 to 050"},
      {"001", "expected 15 digits of ISO 6360"},
      {"", "expected 15 digits of ISO 6360"},
      {"806 314 001 524 01a", "expected 15 digits of ISO 6360"},
      {"801.314.014", "expected 15 digits of ISO 6360"},
  };
  for (const auto& bad : cases) {
    const std::string says = refusal_of("iso = \"" + std::string(bad.iso) + "\"");
    EXPECT_NE(says.find("burr.iso"), std::string::npos) << bad.iso << ": " << says;
    EXPECT_NE(says.find(bad.found), std::string::npos) << bad.iso << ": " << says;
  }
}

TEST(BurrNumber, RefusesContradictions) {
  const std::string iso = "iso = \"249 012\"\n";
  for (const char* line : {"shape = \"round\"", "diameter_mm = 1.4", "length_mm = 5"}) {
    const std::string says = refusal_of(iso + line);
    const std::string key = std::string(line).substr(0, std::string(line).find(' '));
    EXPECT_NE(says.find("burr." + key), std::string::npos) << says;
    EXPECT_NE(says.find("249 012"), std::string::npos) << says;
  }
  EXPECT_NE(refusal_of(iso + "file = \"a.stl\""), "");
  const std::string coarse = "iso = \"806 314 001 534 014\"\n";
  for (const char* line : {"material = \"carbide\"", "grit = \"medium\""}) {
    EXPECT_NE(refusal_of(coarse + line), "") << line;
  }
  EXPECT_EQ(burr_of(coarse + "grit = \"coarse\"").grit, Grit::kCoarse);
  // What says the same, or what the number leaves open, stands beside it.
  EXPECT_NO_THROW(
      burr_of(iso + "shape = \"flame\"\ndiameter_mm = 1.2\nlength_mm = 8\nspeed_rpm = 9"));
  EXPECT_NEAR(*burr_of("iso = \"107 010\"\nlength_mm = 4").length_m, 4e-3, 1e-12);
}

TEST(BurrNumber, IsSetAndChangedByOverrides) {
  // It stands instead of what the scene says of the shape.
  for (const char* set : {"burr.iso=237 012", "burr.iso=\"237 012\"", "burr.iso=500314237001012"}) {
    const BurrSettings pear = burr_of("shape = \"flame\"\ndiameter_mm = 1.4\nlength_mm = 5", {set});
    EXPECT_EQ(pear.shape, BurrShape::kPear) << set;
    EXPECT_NEAR(pear.diameter_m, 1.2e-3, 1e-12) << set;
    EXPECT_FALSE(pear.length_m) << set;
  }
  // Another diameter of the same shape; the scene that is recorded says so itself.
  const BurrSettings wider = burr_of("iso = \"249 012\"", {"burr.diameter_mm=1.6"});
  EXPECT_EQ(wider.shape, BurrShape::kFlame);
  EXPECT_NEAR(wider.diameter_m, 1.6e-3, 1e-12);
  EXPECT_NEAR(wider.length_m.value_or(0), 8e-3, 1e-12);
}

}  // namespace
}  // namespace sulcus::burr_number_test
