#include "engine/import/volumes/slice_order.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"

namespace sulcus::slice_order_test {
namespace {

/// The names in the order that they are put in, from the wrong way round.
std::vector<std::string> ordered(std::vector<std::string> names,
                                 std::vector<std::string>* warnings = nullptr) {
  std::ranges::reverse(names);
  for (std::string& name : names) name.insert(0, "folder/");
  const SliceOrder order = slice_order("folder", names);
  if (warnings) *warnings = order.warnings;
  std::vector<std::string> result;
  for (const std::string& file : order.files) {
    result.push_back(std::filesystem::path(file).filename().string());
  }
  return result;
}

TEST(SliceOrder, IsThatOfTheNumbers) {
  const std::vector<std::vector<std::string>> series{
      {"slice_1.tif", "slice_2.tif", "slice_9.tif", "slice_10.tif"},
      {"slice_0.25.tif", "slice_0.5.tif", "slice_0.75.tif", "slice_1.tif"},
      {"a007.png", "a8.png", "a0009.png"},
      {"z_-1.5.png", "z_-0.5.png", "z_0.5.png", "z_1.5.png"},
      {"scan-1.tif", "scan-2.tif", "scan-11.tif"},  // a hyphen, and no sign
      {"1.2.840.9.1.tif", "1.2.840.9.2.tif", "1.2.840.9.10.tif"},
      {"99999999999999999999998.png", "99999999999999999999999.png"},
      {"tooth2_z1.tif", "tooth2_z2.tif", "tooth2_z10.tif"},
      // Numbers on either side of a dot, and decimal numbers whose zeros some names have.
      {"v1.1.tif", "v1.2.tif", "v1.3.tif", "v1.4.tif", "v1.5.tif", "v1.6.tif", "v1.7.tif",
       "v1.8.tif", "v1.9.tif", "v1.10.tif", "v1.11.tif"},
      {"v1.8.tif", "v1.9.tif", "v1.10.tif", "v1.11.tif"},
      {"v1.8.tif", "v1.9.tif", "v1.10.tif", "v2.8.tif", "v2.9.tif", "v2.10.tif"},
      {"z0.5.tif", "z0.75.tif", "z1.0.tif", "z1.25.tif"},
      {"z0.5.tif", "z0.75.tif", "z1.00.tif", "z1.25.tif"}};
  for (const auto& names : series) EXPECT_EQ(ordered(names), names) << names.front();
}

TEST(SliceOrder, TellsWhatIsAbsent) {
  std::vector<std::string> warnings;
  ordered({"s_1.tif", "s_2.tif", "s_3.tif"}, &warnings);
  EXPECT_TRUE(warnings.empty());
  ordered({"s_2.tif", "s_4.tif", "s_6.tif"}, &warnings);  // every other one
  EXPECT_TRUE(warnings.empty());
  ordered({"s_0.33.tif", "s_0.67.tif", "s_1.tif"}, &warnings);  // thirds
  EXPECT_TRUE(warnings.empty());
  ordered({"s_8.tif", "s_9.tif", "s_11.tif", "s_12.tif"}, &warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0],
            "the slices' numbers go from 9 to 11 (s_9.tif, s_11.tif): what is absent there is not "
            "made up for");
  ordered({"front.tif", "middle.tif"}, &warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("no numbers"), std::string::npos);
}

TEST(SliceOrder, RefusesNamesThatSayTwoThings) {
  const auto error_of = [](const std::vector<std::string>& names) -> std::string {
    try {
      ordered(names);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(error_of({"s_1.tif", "s_01.tif"}),
            "folder: found s_01.tif and s_1.tif, expected each number once");
  EXPECT_NE(error_of({"s_1.tif", "s_2.tif", "mask_2.tif"}).find("differ in their numbers alone"),
            std::string::npos);
  // 1.9 and then 1.10, or the other way round?
  EXPECT_EQ(error_of({"v1.9.tif", "v1.10.tif"}),
            "folder: found v1.10.tif, where 10 may be a number or a fraction, expected numbers "
            "with as many digits in each name");
  EXPECT_NE(error_of({"v1.8.tif", "v1.9.tif", "v1.10.tif", "v1.12.tif"})
                .find("10 may be a number or a fraction"),
            std::string::npos);
  EXPECT_NE(error_of({"s_1.tif", "preview.tif"}).find("differ in their numbers alone"),
            std::string::npos);
}

}  // namespace
}  // namespace sulcus::slice_order_test
