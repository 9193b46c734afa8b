#pragma once

#include <string>
#include <string_view>

namespace sulcus {

// A user's text (a title, a name, a path) on its way into another language: one function for each
// language, and no other way. What comes out means the text and nothing else, whatever is in it.
// (ffmpeg gets paths as arguments, see child_process.hpp; no shell is ever started.)

/// One line for a terminal or a log: what would move the cursor, end the line, set the terminal or
/// turn the direction of writing becomes a blank (control characters of ASCII and, in UTF-8, C1 and
/// the marks of direction).
std::string for_terminal(std::string_view text);

/// HTML, between tags or in an attribute in double or single quotes. Control characters, which HTML
/// does not have, become blanks; tab and line feed stay.
std::string for_html(std::string_view text);

/// A word for a person to paste into a shell: quoted where it needs it, one line, and the shell
/// makes the same bytes of it. Control characters stand as $'\012' [bash; POSIX 2024, 2.2.4].
std::string for_shell(std::string_view text);

/// A string of gnuplot's, with its double quotes: all that it might run, replace or end the string
/// at stands by its octal number. (In single quotes it runs nothing either, but gnuplot 5.4
/// mistakes a quote at their beginning.) Control characters become blanks.
std::string for_gnuplot(std::string_view text);

/// A value of TOML, a basic string with its double quotes. The text is UTF-8 without NUL.
std::string for_toml(std::string_view text);

}  // namespace sulcus
