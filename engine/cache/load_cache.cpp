#include "engine/cache/load_cache.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/core/stop.hpp"

namespace sulcus {
namespace {

namespace fs = std::filesystem;

constexpr std::array<char, 8> kMagic{'S', 'U', 'L', 'C', 'U', 'S', 'K', '\n'};
constexpr std::uint32_t kVersion = 2;  // of the entries' format
constexpr std::string_view kSuffix = ".sulcus", kTemporary = ".tmp";
constexpr std::size_t kKeyDigits = 32;
constexpr std::chrono::hours kAbandoned{1};  // a temporary file as old as this is of a killed run

/// The first bytes of an entry, little-endian; the payload follows.
struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t kind = 0;
  Hash128 key;
  std::uint64_t payload_bytes = 0;
  std::uint64_t reserved = 0;
  Hash128 check;  // of all above and the payload
};
static_assert(sizeof(Header) == 64 && std::is_trivially_copyable_v<Header>);

Hash128Stream check_of(const Header& header) {
  Hash128Stream stream;
  stream.add_bytes(&header, offsetof(Header, check));
  return stream;
}

class File {
 public:
  File(const fs::path& path, int flags)
      : descriptor_(::open(path.c_str(), flags | O_CLOEXEC, 0600)) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  bool opened() const { return descriptor_ >= 0; }
  /// 0 for what is no plain file.
  std::uint64_t bytes() const {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) return 0;
    return static_cast<std::uint64_t>(status.st_size);
  }
  bool read(void* to, std::size_t bytes) {
    for (auto* at = static_cast<std::byte*>(to); bytes > 0;) {
      const ssize_t n = ::read(descriptor_, at, bytes);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      at += n;
      bytes -= static_cast<std::size_t>(n);
    }
    return true;
  }
  bool write(const void* from, std::size_t bytes) {
    for (const auto* at = static_cast<const std::byte*>(from); bytes > 0;) {
      const ssize_t n = ::write(descriptor_, at, bytes);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return false;
      at += n;
      bytes -= static_cast<std::size_t>(n);
    }
    return true;
  }
  bool close() { return ::close(std::exchange(descriptor_, -1)) == 0; }
  /// Marks it as used now.
  void touch() const { ::futimens(descriptor_, nullptr); }

 private:
  int descriptor_;
};

// Entries, and those that are being written: nothing else in the folder is ours to remove.

bool is_entry_name(std::string_view name) {
  return name.size() == kKeyDigits + kSuffix.size() && name.ends_with(kSuffix) &&
         name.find_first_not_of("0123456789abcdef") == kKeyDigits;
}

bool is_temporary_name(std::string_view name) {
  return name.ends_with(kTemporary) && is_entry_name(name.substr(0, kKeyDigits + kSuffix.size()));
}

/// Why an open entry is not to be read; null where its header is right.
const char* wrong_with(const Header& header, CacheKind kind, const Hash128& key,
                       std::uint64_t file_bytes) {
  if (header.magic != kMagic) return "is no entry of the load cache";
  if (header.version != kVersion) return "is of another version";
  if (header.kind != static_cast<std::uint32_t>(kind) || header.key != key) {
    return "holds something else than its name says";
  }
  if (header.payload_bytes != file_bytes - sizeof(Header)) return "has not the length it announces";
  return nullptr;
}

}  // namespace

LoadCache::LoadCache(fs::path folder, std::uint64_t bound_bytes)
    : folder_(program_id() ? std::move(folder) : fs::path()), bound_bytes_(bound_bytes) {}

LoadCache LoadCache::of_user() {
  if (const char* own = std::getenv("SULCUS_CACHE")) {
    const std::string_view text = own;
    return text.empty() || text == "off" ? LoadCache() : LoadCache(text);
  }
  // The XDG specification has relative paths ignored.
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg == '/') {
    return LoadCache(fs::path(xdg) / "sulcus");
  }
  if (const char* home = std::getenv("HOME"); home && *home == '/') {
    return LoadCache(fs::path(home) / ".cache" / "sulcus");
  }
  return {};
}

Hash128Stream LoadCache::key_of(CacheKind kind) {
  Hash128Stream stream;
  stream.add(kind).add(kVersion).add(program_id());
  return stream;
}

fs::path LoadCache::entry(const Hash128& key) const {
  return folder_ / (hex(key) + std::string(kSuffix));
}

void LoadCache::note(const fs::path& path, const char* what) {
  if (note_.empty()) note_ = "load cache: " + path.string() + " " + what;
}

bool LoadCache::read(CacheKind kind, const Hash128& key, const Place& place) {
  if (!keeps()) return false;
  const fs::path path = entry(key);
  // Without waiting for the other end, should it be a pipe.
  File file(path, O_RDONLY | O_NONBLOCK);
  if (!file.opened()) return false;
  const std::uint64_t bytes = file.bytes();
  Header header;
  if (bytes < sizeof header || !file.read(&header, sizeof header)) {
    note(path, "is too short and is made again");
    return false;
  }
  const char* wrong = wrong_with(header, kind, key, bytes);
  if (!wrong) {
    const std::span<std::byte> payload = place(header.payload_bytes);
    if (payload.size() != header.payload_bytes) {
      wrong = "has a length that cannot be";
    } else if (!file.read(payload.data(), payload.size())) {
      wrong = "could not be read";
    } else if (check_of(header).add_bytes(payload.data(), payload.size()).result() !=
               header.check) {
      wrong = "is damaged";
    }
  }
  if (wrong) {
    note(path, (std::string(wrong) + " and is made again").c_str());
    return false;
  }
  file.touch();
  ++hits_;
  return true;
}

void LoadCache::refuse(const Hash128& key) {
  --hits_;
  note(entry(key), "holds what cannot be and is made again");
}

void LoadCache::write(CacheKind kind, const Hash128& key,
                      std::initializer_list<std::span<const std::byte>> parts) {
  if (!keeps()) return;
  Header header;
  header.kind = static_cast<std::uint32_t>(kind);
  header.key = key;
  for (const auto& part : parts) header.payload_bytes += part.size();
  if (sizeof header + header.payload_bytes > bound_bytes_) return;
  Hash128Stream check = check_of(header);
  for (const auto& part : parts) check.add_bytes(part.data(), part.size());
  header.check = check.result();

  std::error_code error;
  fs::create_directories(folder_, error);
  const fs::path path = entry(key);
  const fs::path temporary =
      path.string() + "." + std::to_string(::getpid()) + std::string(kTemporary);
  // Not as a WholeFile: an entry bears a check of all that it holds, so that nothing has to wait
  // for the disk, and what a killed run leaves has a name that evict() knows.
  remove_when_stopped(temporary.string());
  File file(temporary, O_WRONLY | O_CREAT | O_TRUNC);
  bool done = file.opened() && file.write(&header, sizeof header);
  for (const auto& part : parts) done = done && file.write(part.data(), part.size());
  done = done && file.close();
  if (done) fs::rename(temporary, path, error);
  if (!done || error) {
    note(path, "could not be written");
    fs::remove(temporary, error);
  }
  keep_when_stopped(temporary.string());
  if (!done || error) return;
  evict();
}

void LoadCache::evict() {
  struct Entry {
    fs::file_time_type used;
    std::uint64_t bytes;
    fs::path path;
  };
  std::vector<Entry> entries;
  std::uint64_t total = 0;
  std::error_code error, ignored;
  // Another run may remove what this one has just seen: what cannot be asked is left out.
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const bool temporary = is_temporary_name(name);
    if (!temporary && !is_entry_name(name)) continue;
    if (!it->is_regular_file(ignored)) continue;
    const fs::file_time_type used = it->last_write_time(ignored);
    if (ignored) continue;
    if (temporary) {
      if (fs::file_time_type::clock::now() - used > kAbandoned) fs::remove(it->path(), ignored);
      continue;
    }
    const std::uint64_t bytes = it->file_size(ignored);
    if (ignored) continue;
    entries.push_back({used, bytes, it->path()});
    total += bytes;
  }
  std::ranges::sort(entries, [](const Entry& a, const Entry& b) {
    return a.used != b.used ? a.used < b.used : a.path < b.path;
  });
  for (const Entry& oldest : entries) {
    if (total <= bound_bytes_) break;
    if (fs::remove(oldest.path, ignored)) total -= oldest.bytes;
  }
}

}  // namespace sulcus
