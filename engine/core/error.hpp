#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include "engine/core/user_text.hpp"

namespace sulcus {

/// Bad usage or bad input: the command ends with status 2 and `what()` as its one line,
/// "file: place: found ..., expected ...", without control characters whatever the input holds.
/// Thrown by every loader; never in a tick.
class InputError : public std::runtime_error {
 public:
  /// `file` and `place` (line and column, key, field) may be empty where there is none.
  InputError(std::string_view file, std::string_view place, std::string_view found,
             std::string_view expected)
      : std::runtime_error(line(file, place, found, expected)) {}

 private:
  static constexpr std::size_t kLongestPart = 400, kLongestExpected = 1000;

  static std::string line(std::string_view file, std::string_view place, std::string_view found,
                          std::string_view expected) {
    std::string text;
    if (!file.empty()) text.append(file).append(": ");
    if (!place.empty()) text.append(shortened(place, kLongestPart)).append(": ");
    text.append("found ").append(shortened(found, kLongestPart));
    text.append(", expected ").append(shortened(expected, kLongestExpected));
    // Keys and words of a file may hold anything, and the error is one line of text.
    return for_terminal(text);
  }
  static std::string shortened(std::string_view part, std::size_t longest) {
    if (part.size() <= longest) return std::string(part);
    std::size_t end = longest;  // not within a character of UTF-8
    while (end > 0 && (static_cast<unsigned char>(part[end]) & 0xc0u) == 0x80u) --end;
    return std::string(part.substr(0, end)) + "...";
  }
};

}  // namespace sulcus
