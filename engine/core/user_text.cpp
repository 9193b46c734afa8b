#include "engine/core/user_text.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>

namespace sulcus {
namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }

std::string octal(char c) {
  char escaped[8];
  std::snprintf(escaped, sizeof escaped, "\\%03o", static_cast<unsigned char>(c));
  return escaped;
}

/// Bytes at the front of a text that are one character which acts on a terminal; else 0.
std::size_t acting_bytes(std::string_view text) {
  if (is_control(text[0])) return 1;
  const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(text[n]); };
  // C1, U+0080 to U+009F; LINE SEPARATOR to RIGHT-TO-LEFT OVERRIDE, U+2028 to U+202E; the marks
  // U+200E, U+200F; the isolates, U+2066 to U+2069.
  if (text.size() >= 2 && byte(0) == 0xc2 && byte(1) >= 0x80 && byte(1) <= 0x9f) return 2;
  if (text.size() >= 3 && byte(0) == 0xe2) {
    if (byte(1) == 0x80 && ((byte(2) >= 0xa8 && byte(2) <= 0xae) || (byte(2) | 1) == 0x8f))
      return 3;
    if (byte(1) == 0x81 && byte(2) >= 0xa6 && byte(2) <= 0xa9) return 3;
  }
  return 0;
}

/// Bytes of the well-formed UTF-8 character at the front of a text [Unicode 15, table 3-7]; 0 where
/// there is none.
std::size_t utf8_bytes(std::string_view text) {
  const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(text[n]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  if (lead < 0xc2 || lead > 0xf4) return 0;
  const std::size_t bytes = lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
  if (bytes > text.size()) return 0;
  for (std::size_t n = 1; n < bytes; ++n) {
    if ((byte(n) & 0xc0u) != 0x80u) return 0;
  }
  const bool overlong = (lead == 0xe0 && byte(1) < 0xa0) || (lead == 0xf0 && byte(1) < 0x90);
  const bool none = (lead == 0xed && byte(1) > 0x9f) || (lead == 0xf4 && byte(1) > 0x8f);
  return overlong || none ? 0 : bytes;
}

}  // namespace

std::string for_terminal(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  while (!text.empty()) {
    if (const std::size_t acting = acting_bytes(text)) {
      safe += ' ';
      text.remove_prefix(acting);
      continue;
    }
    // A byte that is no character, alone, is C1 to a terminal of eight bits.
    const std::size_t bytes = utf8_bytes(text);
    if (bytes == 0) {
      safe += '?';
      text.remove_prefix(1);
      continue;
    }
    safe += text.substr(0, bytes);
    text.remove_prefix(bytes);
  }
  return safe;
}

std::string for_html(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += is_control(c) && c != '\t' && c != '\n' ? ' ' : c;
    }
  }
  return safe;
}

std::string for_shell(std::string_view text) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("_./=:+-,").find(c) != std::string_view::npos;
  };
  if (!text.empty() && std::ranges::all_of(text, plain)) return std::string(text);
  std::string quoted = "'";
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t acting = acting_bytes(rest);
    if (acting == 0) {
      quoted += rest[0] == '\'' ? "'\\''" : std::string(1, rest[0]);
      rest.remove_prefix(1);
      continue;
    }
    quoted += "'$'";
    for (std::size_t n = 0; n < acting; ++n) quoted += octal(rest[n]);
    quoted += "''";
    rest.remove_prefix(acting);
  }
  return quoted + "'";
}

std::string for_gnuplot(std::string_view text) {
  // What is listed is written as it is; all else by its number.
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           static_cast<unsigned char>(c) >= 0x80 ||
           std::string_view(" _.,:;/()=+-").find(c) != std::string_view::npos;
  };
  std::string quoted = "\"";
  for (const char c : text) {
    if (is_control(c)) {
      quoted += ' ';
    } else if (plain(c)) {
      quoted += c;
    } else {
      quoted += octal(c);
    }
  }
  return quoted + "\"";
}

std::string for_toml(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (is_control(c)) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04X", static_cast<unsigned char>(c));
      quoted += escaped;
      continue;
    }
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "\"";
}

}  // namespace sulcus
