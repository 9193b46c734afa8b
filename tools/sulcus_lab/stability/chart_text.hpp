#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

#include "tools/sulcus_lab/chart.hpp"
#include "tools/sulcus_lab/stability/stability_row.hpp"

namespace sulcus::lab::chart_text {

// What the pictures of the stability measurements say to gnuplot alike, and how each method looks.

// Okabe and Ito's, told apart by every kind of colour vision; ours in the strong blue.
struct Look {
  const char* colour;
  double width;
  int mark;
};
inline constexpr Look kMethodLooks[] = {{"#0072b2", 3.0, 7},  {"#d55e00", 2.2, 5},
                                        {"#009e73", 1.8, 9},  {"#555555", 1.8, 13},
                                        {"#e69f00", 1.8, 11}, {"#cc79a7", 1.8, 3}};
static_assert(std::size(kMethodLooks) == kContactMethodNames.size());
inline constexpr const char* kLabelColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                "#e69f00"};
inline constexpr const char* kDashes[] = {"solid", "'-'", "'.'", "'_.'", "'_ '"};

inline constexpr const char* kFrame =
    "set border 3 lc rgb '#666666'\nset tics nomirror tc rgb '#222222'\n"
    "set grid xtics ytics lc rgb '#d8d8d8' lw 1\n";

inline const Look& look_of(ContactMethod method) {
  return kMethodLooks[static_cast<std::size_t>(method)];
}
inline std::string title_of(ContactMethod method) {
  return spaced_name(std::string(kContactMethodNames[static_cast<std::size_t>(method)]));
}

inline std::string range(const char* axis, double low, double high) {
  return std::string("set ") + axis + "range [" + number_for_gnuplot(low) + ":" +
         number_for_gnuplot(high) + "]\n";
}
inline std::string margins(double left, double right, double bottom, double top) {
  return "set lmargin at screen " + number_for_gnuplot(left) + "\nset rmargin at screen " +
         number_for_gnuplot(right) + "\nset bmargin at screen " + number_for_gnuplot(bottom) +
         "\nset tmargin at screen " + number_for_gnuplot(top) + "\n";
}

template <class T>
std::size_t place_in(std::vector<T>& seen, const T& value) {
  const auto at = std::find(seen.begin(), seen.end(), value);
  if (at != seen.end()) return static_cast<std::size_t>(at - seen.begin());
  seen.push_back(value);
  return seen.size() - 1;
}

/// A key of its own that runs across the picture at that height; `entries` as gnuplot plots them.
inline std::string key_across(double left, double right, double top, const std::string& entries) {
  return margins(left, right, 0.0, top) + "set key at screen " + number_for_gnuplot(left) + "," +
         number_for_gnuplot(top) +
         " left top Left reverse horizontal samplen 4 width 2 font 'sans,11' tc rgb '#111111'\n"
         "unset border\nunset tics\nunset xlabel\nunset ylabel\nset xrange [0:1]\nset yrange "
         "[0:1]\nplot " +
         entries + "\nset key off\n" + kFrame + "set xtics nomirror\nset ytics nomirror\n";
}

}  // namespace sulcus::lab::chart_text
