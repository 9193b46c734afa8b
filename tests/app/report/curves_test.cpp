#include "app/report/page/curves.hpp"

#include <gtest/gtest.h>

namespace sulcus::curves_test {
namespace {

/// What stands at the ticks, in their order: of the values, then of the times.
std::vector<std::string> tick_texts(const std::string& svg) {
  std::vector<std::string> texts;
  for (std::size_t at = svg.find("<text"); at != std::string::npos; at = svg.find("<text", at)) {
    at = svg.find('>', at) + 1;
    texts.push_back(svg.substr(at, svg.find('<', at) - at));
  }
  return texts;
}

TEST(Curves, TicksAreRoundAndInSeconds) {
  const std::vector<double> times{0.0, 9.0, 18.482};
  const Curve force{.name = "Force", .unit = "N", .colour = "#000", .values = {0.0, 1.99, 0.7}};
  EXPECT_EQ(tick_texts(curve_figure(force, times)),
            (std::vector<std::string>{"0.0", "0.5", "1.0", "1.5", "2.0", "0 s", "2", "4", "6", "8",
                                      "10", "12", "14", "16", "18"}));
  const Curve times_us{.name = "Time", .unit = "us", .colour = "#000", .values = {3.0, 2390.0}};
  EXPECT_EQ(
      tick_texts(curve_figure(times_us, std::vector<double>{0.0, 0.439})),
      (std::vector<std::string>{"0", "500", "1,000", "1,500", "2,000", "2,500", "0.00 s", "0.05",
                                "0.10", "0.15", "0.20", "0.25", "0.30", "0.35", "0.40"}));
}

TEST(Curves, SharedAxesHoldBoth) {
  const std::vector<double> short_s{0.0, 1.0}, long_s{0.0, 7.3};
  const Curve low{.name = "a", .unit = "K", .colour = "#000", .values = {-0.3, 0.1}};
  const Curve high{.name = "b", .unit = "K", .colour = "#000", .values = {0.0, 4.2}};
  const CurveAxes both = joined(axes_of(low, short_s), axes_of(high, long_s));
  EXPECT_DOUBLE_EQ(both.end_s, 7.3);
  EXPECT_LE(both.low, -0.3);
  EXPECT_GE(both.high, 4.2);
}

TEST(Curves, NumbersAreAsAPersonWritesThem) {
  EXPECT_EQ(plain_number(2390.4), "2,390");
  EXPECT_EQ(plain_number(1234567.0), "1,234,567");
  EXPECT_EQ(plain_number(-1500.0), "-1,500");
  EXPECT_EQ(plain_number(14.334), "14.3");
  EXPECT_EQ(plain_number(4.052), "4.05");
  EXPECT_EQ(plain_number(0.0294), "0.029");
  EXPECT_EQ(plain_number(0.0), "0.00");
}

}  // namespace
}  // namespace sulcus::curves_test
