#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/input_limits.hpp"

namespace sulcus {

/// The text of a mesh file, word by word. Words end at blanks; lines end with \n, \r\n or \r, as
/// the systems of the three formats' times wrote them. A byte order mark in front is skipped.
class MeshText {
 public:
  /// From the byte `at` on, which lies in the line `line`. The text is not copied.
  explicit MeshText(std::string_view text, std::size_t at = 0, std::uint64_t line = 1);

  /// The next word of this line; empty at its end.
  std::string_view word_of_line();
  /// The next word, of whatever line; empty at the end of the text.
  std::string_view word();
  /// Skips what is left of the line.
  void skip_line();
  /// Skips the end of the line, which all of it was read of; false at that of the text.
  bool end_line();
  /// Goes to the next line that holds a word; false where there is none.
  bool next_line();

  /// Whether nothing but blanks is left of the line.
  bool at_line_end();
  /// "line 12": of the last word, or of where the text ends.
  std::string place() const { return "line " + std::to_string(line_); }
  /// The last word for a message: itself, or what was there instead.
  std::string found(std::string_view word) const;

 private:
  void skip_blanks();

  std::string_view text_;
  std::size_t at_;
  std::uint64_t line_;
};

/// Without the byte order mark that some editors of text put in front.
std::string_view without_byte_order_mark(std::string_view text);

/// A number with a point, whatever the locale; too large a one is infinite, too small a one 0.
/// Nothing where the word is none.
std::optional<double> parse_number(std::string_view word);
std::optional<std::int64_t> parse_whole_number(std::string_view word);

/// A file whose mesh takes up to four times its length.
/// @throws InputError: unreadable, or longer than a quarter of the limit.
std::string read_mesh_bytes(const std::string& path, const InputLimits& limits);

}  // namespace sulcus
