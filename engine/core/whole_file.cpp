#include "engine/core/whole_file.hpp"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "engine/core/error.hpp"
#include "engine/core/stop.hpp"

namespace sulcus {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& why) {
  throw std::runtime_error(path + ": cannot be written: " + why);
}

[[noreturn]] void fail(const std::string& path, int error) { fail(path, std::strerror(error)); }

/// Of this process alone, and hidden. The end of the name stays, since writers go by it.
std::string name_beside(const fs::path& path) {
  static std::atomic<unsigned> count{0};
  constexpr std::size_t kMostBytes = 200;  // of a name: 255 are allowed, ours comes ahead
  std::string name = path.filename().string();
  if (name.size() > kMostBytes) name = name.substr(name.size() - kMostBytes);
  const std::string mark =
      ".part-" + std::to_string(::getpid()) + "-" + std::to_string(++count) + "-";
  return (path.parent_path() / (mark + name)).string();
}

class Descriptor {
 public:
  Descriptor(const std::string& path, int flags)
      : number_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  bool close() { return ::close(std::exchange(number_, -1)) == 0; }

 private:
  int number_;
};

}  // namespace

WholeFile::WholeFile(std::string path) : path_(std::move(path)) {
  std::error_code ignored;
  const fs::path folder = fs::path(path_).parent_path();
  if (!folder.empty() && !fs::is_directory(folder, ignored)) {
    throw InputError(path_, "", "no folder " + folder.string(), "one that is there");
  }
  if (fs::path(path_).filename().empty() ||
      (fs::exists(path_, ignored) && !fs::is_regular_file(path_, ignored))) {
    throw InputError(path_, "", "no regular file", "a file to write");
  }
  beside_ = name_beside(path_);
  remove_when_stopped(beside_);
  const Descriptor made(beside_, O_WRONLY | O_CREAT | O_EXCL);
  if (made.number() >= 0) return;
  const int error = errno;
  keep_when_stopped(beside_);
  if (error == ENOSPC || error == EDQUOT) fail(path_, error);
  throw InputError(path_, "",
                   std::string("that it cannot be written (") + std::strerror(error) + ")",
                   "a file to write");
}

WholeFile::~WholeFile() {
  if (beside_.empty()) return;
  ::unlink(beside_.c_str());
  keep_when_stopped(beside_);
}

WholeFile::WholeFile(WholeFile&& other) noexcept
    : path_(std::move(other.path_)), beside_(std::exchange(other.beside_, {})) {}

void WholeFile::write(std::string_view bytes) {
  Descriptor file(beside_, O_WRONLY | O_TRUNC);
  if (file.number() < 0) fail(path_, errno);
  while (!bytes.empty()) {
    const ssize_t n = ::write(file.number(), bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail(path_, n < 0 ? errno : ENOSPC);
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  if (!file.close()) fail(path_, errno);
}

void WholeFile::finish() {
  // Some file systems tell only now that there was no room.
  Descriptor file(beside_, O_RDONLY);
  if (file.number() < 0 || ::fsync(file.number()) != 0 || !file.close()) fail(path_, errno);
  if (::rename(beside_.c_str(), path_.c_str()) != 0) fail(path_, errno);
  keep_when_stopped(beside_);
  beside_.clear();
}

void WholeFile::fail_incomplete(const std::string& otherwise) const {
  // The program that wrote it kept the reason to itself: the system says it again.
  constexpr int kMostBlocks = 16;
  const std::string block(std::size_t{1} << 16, '\0');
  const Descriptor file(beside_, O_WRONLY | O_APPEND);
  ssize_t n = file.number() < 0 ? -1 : 0;
  for (int i = 0; i < kMostBlocks && n >= 0; ++i) {
    n = ::write(file.number(), block.data(), block.size());
  }
  fail(path_, n < 0 ? std::strerror(errno) : otherwise);
}

void write_whole_file(const std::string& path, std::string_view bytes) {
  WholeFile file(path);
  file.write(bytes);
  file.finish();
}

void check_can_be_written(const std::string& path) { const WholeFile probe(path); }

}  // namespace sulcus
