#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <spdlog/formatter.h>

namespace sulcus {

/// printf into a text.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

/// printf of one line to standard output, a line feed at its end or not. What texts of a user's in
/// it would do to the terminal they do not (for_terminal).
[[gnu::format(printf, 1, 2)]] void say(const char* format, ...);
/// The same to standard error.
[[gnu::format(printf, 1, 2)]] void say_error(const char* format, ...);

/// A line on the terminal that the next one replaces; what is said clears it. Empty: none any more.
/// Only where the error stream is a terminal. Any thread.
void show_progress(std::string_view line);

/// How the log and its lines on the terminal look: spdlog's pattern, in which %* is the message as
/// one line.
std::unique_ptr<spdlog::formatter> one_line_formatter(const char* pattern);

}  // namespace sulcus
