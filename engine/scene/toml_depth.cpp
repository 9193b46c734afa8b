#include <algorithm>
#include <cstddef>

#include "engine/core/error.hpp"
#include "engine/core/input_limits.hpp"
#include "engine/scene/toml_table.hpp"

namespace sulcus {

namespace {

/// The end of the string that begins at `begin`, behind its last quote; the end of the text where
/// it is not closed, of the line where one of a single line is not.
std::size_t end_of_string(std::string_view text, std::size_t begin) {
  const char quote = text[begin];
  const bool escapes = quote == '"';
  const std::string three(3, quote);
  const bool many_lines = text.substr(begin).starts_with(three);
  std::size_t at = begin + (many_lines ? 3 : 1);
  for (; at < text.size(); ++at) {
    if (escapes && text[at] == '\\') {
      ++at;
    } else if (!many_lines && (text[at] == quote || text[at] == '\n')) {
      return at + 1;
    } else if (many_lines && text.substr(at).starts_with(three)) {
      at += 3;
      for (int more = 0; more < 2 && at < text.size() && text[at] == quote; ++more) ++at;
      return at;  // up to two of its own quotes may stand before the last three
    }
  }
  return text.size();
}

[[noreturn]] void refuse(std::string_view text, const std::string& file, std::size_t at,
                         const std::string& found) {
  const std::string_view before = text.substr(0, at);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_begin = before.rfind('\n') + 1;  // npos + 1 is 0
  throw InputError(
      file, "line " + std::to_string(line) + ", column " + std::to_string(at - line_begin + 1),
      found, "at most " + std::to_string(InputLimits::kSceneDepth));
}

}  // namespace

void check_toml_depth(std::string_view text, const std::string& file) {
  int depth = 0, dots = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    switch (c) {
      case '"':
      case '\'':
        at = end_of_string(text, at);
        continue;
      case '#':
        at = std::min(text.find('\n', at), text.size());
        continue;
      case '[':
      case '{':
        dots = 0;
        if (++depth > InputLimits::kSceneDepth) {
          refuse(text, file, at, "arrays or tables " + std::to_string(depth) + " levels deep");
        }
        break;
      case ']':
      case '}':
        dots = 0;
        depth = std::max(0, depth - 1);
        break;
      case '.':
        if (++dots >= InputLimits::kSceneDepth) {
          refuse(text, file, at, "a key of more than " + std::to_string(dots) + " parts");
        }
        break;
      case ',':
      case '=':
      case '\n':
        dots = 0;
        break;
      default:
        break;
    }
    ++at;
  }
}

}  // namespace sulcus
