#include "tools/sulcus_lab/chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace sulcus::lab {

namespace {

struct Style {
  const char* colour;
  double width;
  int mark;          // gnuplot's point type
  const char* dash;  // gnuplot's dash type
};

// Okabe and Ito's blue and vermilion for ours, told apart by every kind of colour vision.
Style style_of(Method method) {
  switch (method) {
    case Method::kLdm:
      return {"#0072b2", 3.5, 7, "solid"};
    case Method::kLdmFast:
      return {"#d55e00", 3.5, 5, "solid"};
    case Method::kLdmPaper:
      return {"#444444", 1.8, 9, "solid"};
    case Method::kWeightedSum:
      return {"#9a9a9a", 1.8, 1, "solid"};
    case Method::kWeightedSumD2:
      return {"#9a9a9a", 1.8, 2, "'-'"};
    case Method::kPca:
      return {"#7fa88f", 1.8, 13, "solid"};
    case Method::kMls:
      return {"#a78bb8", 1.8, 11, "solid"};
    case Method::kExact:
      return {"#b59a5b", 1.8, 3, "solid"};
  }
  return {};
}

}  // namespace

std::string number_for_gnuplot(double value) {
  if (!std::isfinite(value)) return "NaN";
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string point_for_gnuplot(double x, double y) {
  return number_for_gnuplot(x) + " " + number_for_gnuplot(y) + "\n";
}

std::string block_for_gnuplot(const std::string& name, const std::string& points) {
  return "$" + name + " << EOD\n" + points + "EOD\n";
}

std::string spaced_name(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string line_style(Method method) {
  const Style style = style_of(method);
  return "lw " + number_for_gnuplot(style.width) + " lc rgb '" + style.colour + "' dt " +
         style.dash + " pt " + std::to_string(style.mark);
}

std::string colour_of(Method method) { return style_of(method).colour; }

bool draw_chart(const std::string& commands, int width, int height, const std::string& file_png) {
  return draw_with_gnuplot(file_png, width, height, [&](std::FILE* script) {
    std::fwrite(commands.data(), 1, commands.size(), script);
  });
}

}  // namespace sulcus::lab
