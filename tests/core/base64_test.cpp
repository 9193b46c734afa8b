#include "engine/core/base64.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace sulcus::base64_test {
namespace {

std::string of(const std::string& text) {
  return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(Base64, TheExamplesOfTheStandard) {  // RFC 4648, section 10
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

TEST(Base64, LongOnesAreWhatTheirPartsAre) {
  std::string text(10'000'001, 'x');
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>(i * 31 >> 3);
  const std::string whole = of(text);
  EXPECT_EQ(whole.size(), (text.size() + 2) / 3 * 4);
  EXPECT_EQ(whole.find('='), whole.size() - 1);
  EXPECT_EQ(whole.substr(4'000'000, 4), of(text.substr(3'000'000, 3)));
  EXPECT_EQ(whole.substr(4'194'304, 4), of(text.substr(3'145'728, 3)));
}

}  // namespace
}  // namespace sulcus::base64_test
