#include "app/report/log_file.hpp"

#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/build_info.hpp"
#include "app/report/output_file.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"

namespace sulcus {
namespace {

[[noreturn]] void fail(const std::string& path, int error) {
  throw std::runtime_error(path + ": cannot be written: " + std::strerror(error));
}

[[noreturn]] void refuse_kind(const std::string& path) {
  throw InputError(path, "", "no regular file", "one that can be written");
}

/// An empty one. Nobody waits for the reader of a pipe, and no link leads elsewhere.
int open_log_file(const std::string& path) {
  const int file =
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
  if (file < 0) {
    if (errno == ENOSPC || errno == EDQUOT) fail(path, errno);
    if (errno == ELOOP || errno == ENXIO || errno == EISDIR) refuse_kind(path);
    throw InputError(path, "",
                     std::string("a file that cannot be written (") + std::strerror(errno) + ")",
                     "one that can");
  }
  struct stat kind {};
  const bool is_regular = ::fstat(file, &kind) == 0 && S_ISREG(kind.st_mode);
  if (is_regular && ::ftruncate(file, 0) == 0) return file;
  const int error = errno;
  ::close(file);
  if (is_regular) fail(path, error);
  refuse_kind(path);
}

}  // namespace

LogFile::LogFile(std::string path) : path_(std::move(path)), file_(open_log_file(path_)) {}

LogFile::~LogFile() { ::close(file_); }

void LogFile::sink_it_(const spdlog::details::log_msg& message) {
  if (error_ != 0) return;
  spdlog::memory_buf_t line;
  formatter_->format(message, line);
  const ssize_t n = ::write(file_, line.data(), line.size());
  if (n == static_cast<ssize_t>(line.size())) {
    bytes_ += line.size();
    return;
  }
  error_ = n < 0 ? errno : ENOSPC;
  [[maybe_unused]] const int cut = ::ftruncate(file_, static_cast<off_t>(bytes_));
}

void LogFile::check() {
  const std::lock_guard lock(mutex_);
  if (error_ == 0 && ::fsync(file_) != 0) error_ = errno;
  if (error_ != 0) fail(path_, error_);
}

void open_log(const std::string& folder) {
  make_output_folder("-o", folder);
  auto file = std::make_shared<LogFile>(folder + "/log.txt");
  file->set_formatter(one_line_formatter("[%Y-%m-%d %H:%M:%S.%e] [%l] %*"));
  auto terminal = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  terminal->set_level(spdlog::level::warn);
  terminal->set_formatter(one_line_formatter("sulcus: %*"));
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("sulcus", spdlog::sinks_init_list{file, terminal}));
  spdlog::info("{}", build_info());
}

void check_log() {
  for (const auto& sink : spdlog::default_logger()->sinks()) {
    if (const auto file = std::dynamic_pointer_cast<LogFile>(sink)) file->check();
  }
}

}  // namespace sulcus
