#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace sulcus {

/// Bad usage or bad input: the command ends with status 2 and `what()` as its one line,
/// "file: place: found ..., expected ...". Thrown by every loader; never in a tick.
class InputError : public std::runtime_error {
 public:
  /// `file` and `place` (line and column, key, field) may be empty where there is none.
  InputError(std::string_view file, std::string_view place, std::string_view found,
             std::string_view expected)
      : std::runtime_error(line(file, place, found, expected)) {}

 private:
  static std::string line(std::string_view file, std::string_view place, std::string_view found,
                          std::string_view expected) {
    std::string text;
    for (std::string_view part : {file, place}) {
      if (!part.empty()) text.append(part).append(": ");
    }
    return text.append("found ").append(found).append(", expected ").append(expected);
  }
};

}  // namespace sulcus
