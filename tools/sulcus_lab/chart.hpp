#pragma once

#include <string>

#include "app/report/gnuplot.hpp"
#include "tools/sulcus_lab/normals/normal_methods.hpp"

namespace sulcus::lab {

/// A number for gnuplot's data; what is not finite becomes its "NaN".
std::string number_for_gnuplot(double value);

/// A line of two numbers.
std::string point_for_gnuplot(double x, double y);
/// `$name << EOD` with the points.
std::string block_for_gnuplot(const std::string& name, const std::string& points);

/// A name of the command line as words.
std::string spaced_name(std::string name);

/// How a method's line looks in every chart, as gnuplot writes it ("lw 3 lc rgb ... pt ..."): ours
/// in strong colours that colour-blind readers can tell apart, the others muted, each with a mark
/// of its own.
std::string line_style(Method method);
/// The colour alone, '#rrggbb'.
std::string colour_of(Method method);

/// Runs gnuplot on commands that draw one picture, of that many pixels. False, and no file, where
/// gnuplot cannot be run or refuses them.
bool draw_chart(const std::string& commands, int width, int height, const std::string& file_png);

}  // namespace sulcus::lab
