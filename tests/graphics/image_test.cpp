#include "engine/graphics/image.hpp"

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace sulcus::image_test {
namespace {

TEST(SheetOf, ASheetHasThePicturesInRows) {
  const Image red{2, 1, {255, 0, 0, 255, 0, 0}}, blue{2, 1, {0, 0, 255, 0, 0, 255}};
  const std::vector<Image> three{red, blue, red};
  const Image sheet = sheet_of(three, 2);
  EXPECT_EQ(sheet.width, 4);
  EXPECT_EQ(sheet.height, 2);
  EXPECT_EQ(sheet.rgb,
            (std::vector<std::uint8_t>{255, 0, 0, 255, 0, 0, 0,   0,   255, 0,   0,   255,
                                       255, 0, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255}));
  EXPECT_EQ(sheet_of({}, 3), Image{});
  const std::vector<Image> several{red, Image{1, 1, {0, 0, 0}}};
  EXPECT_THROW(sheet_of(several, 2), std::invalid_argument);
}

TEST(WritePng, NamesTheFileItCannotWrite) {
  try {
    write_png({1, 1, {1, 2, 3}}, "/nowhere/at/all.png");
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/at/all.png"), std::string::npos);
  }
}

}  // namespace
}  // namespace sulcus::image_test
