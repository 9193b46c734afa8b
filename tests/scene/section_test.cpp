#include "engine/scene/section.hpp"

#include <gtest/gtest.h>

namespace sulcus::section_test {
namespace {

TEST(Section, AnAxisAndMillimetres) {
  const auto y = parse_section("y=0");
  ASSERT_TRUE(y);
  EXPECT_EQ(y->axis, 1);
  EXPECT_EQ(y->at_m, 0.0);
  const auto x = parse_section(" x = -1.5 ");
  ASSERT_TRUE(x);
  EXPECT_EQ(x->axis, 0);
  EXPECT_DOUBLE_EQ(x->at_m, -1.5e-3);
  for (const char* text : {"", "y", "y=", "=1", "w=1", "y=1mm", "y=nan", "y=inf", "y1", "1"}) {
    EXPECT_FALSE(parse_section(text)) << text;
  }
}

}  // namespace
}  // namespace sulcus::section_test
