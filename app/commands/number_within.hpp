#pragma once

#include <cmath>
#include <string>

#include <CLI/CLI.hpp>

namespace sulcus {

/// Numbers from `least` to `most`. CLI::Range alone takes NaN.
inline CLI::Validator number_within(double least, double most) {
  const CLI::Range range(least, most);
  return CLI::Validator(
      [=](std::string& given) {
        double value = 0.0;
        const bool is_nan = CLI::detail::lexical_cast(given, value) && std::isnan(value);
        return is_nan ? "Value " + given + " is no number" : range(given);
      },
      range.get_description());
}

}  // namespace sulcus
