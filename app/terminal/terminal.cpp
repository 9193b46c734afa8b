#include "app/terminal/terminal.hpp"

#include <cstdarg>
#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include <spdlog/pattern_formatter.h>

#include "engine/core/user_text.hpp"

namespace sulcus {
namespace {

/// The progress line and what is said take turns.
std::mutex terminal_mutex;
bool progress_shown = false;

/// Under the lock.
void clear_progress() {
  if (!std::exchange(progress_shown, false)) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
}

std::string text_of(const char* format, std::va_list arguments) {
  std::va_list again;
  va_copy(again, arguments);
  const int bytes = std::vsnprintf(nullptr, 0, format, arguments);
  std::string text(bytes > 0 ? static_cast<std::size_t>(bytes) : 0, '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  return text;
}

void say_to(std::FILE* stream, const char* format, std::va_list arguments) {
  const std::string text = text_of(format, arguments);
  const bool ends = text.ends_with('\n');
  std::string line = for_terminal(std::string_view(text).substr(0, text.size() - (ends ? 1 : 0)));
  if (ends) line += '\n';
  const std::lock_guard lock(terminal_mutex);
  clear_progress();
  std::fwrite(line.data(), 1, line.size(), stream);
}

class OneLine : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& line) override {
    const std::string text = for_terminal({message.payload.data(), message.payload.size()});
    line.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<OneLine>();
  }
};

}  // namespace

std::string formatted(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  std::string text = text_of(format, arguments);
  va_end(arguments);
  return text;
}

void say(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  say_to(stdout, format, arguments);
  va_end(arguments);
}

void say_error(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  say_to(stderr, format, arguments);
  va_end(arguments);
}

void show_progress(std::string_view line) {
  const std::lock_guard lock(terminal_mutex);
  clear_progress();
  if (line.empty()) return;
  std::fflush(stdout);  // what was said before stands above it
  std::fputs(for_terminal(line).c_str(), stderr);
  std::fflush(stderr);
  progress_shown = true;
}

std::unique_ptr<spdlog::formatter> one_line_formatter(const char* pattern) {
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<OneLine>('*').set_pattern(pattern);
  return formatter;
}

}  // namespace sulcus
