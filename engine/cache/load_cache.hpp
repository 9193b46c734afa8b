#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>

#include "engine/cache/hash128.hpp"

namespace sulcus {

/// What an entry holds; part of its name and of its header.
enum class CacheKind : std::uint32_t { kModel = 1, kField = 2 };

/// Files in a folder of the user's, each named by the hash of all that its content follows from.
/// They are only ever a short cut: an entry that is missing, damaged, of another version or not of
/// ours is as good as none and is made again, and a folder that cannot be written keeps nothing.
/// No call throws for what lies on the disk. Entries are written under another name and renamed, so
/// that runs at the same time, or one that is killed, leave whole ones. Used by one thread.
class LoadCache {
 public:
  static constexpr std::uint64_t kDefaultBound = std::uint64_t{1} << 30;  // bytes

  /// Keeps nothing.
  LoadCache() = default;
  /// `bound_bytes`: what the entries may take together; those not used for longest go first, and a
  /// larger one is not kept.
  explicit LoadCache(std::filesystem::path folder, std::uint64_t bound_bytes = kDefaultBound);
  /// $SULCUS_CACHE ("" or "off": keeps nothing), else $XDG_CACHE_HOME/sulcus, else
  /// $HOME/.cache/sulcus; none of them an absolute path ($SULCUS_CACHE may be any): keeps nothing.
  static LoadCache of_user();

  bool keeps() const { return !folder_.empty(); }

  /// A key for inputs of a kind: add them to it. It begins with what every entry follows from, the
  /// kind, the format and the code (program_id).
  static Hash128Stream key_of(CacheKind kind);

  /// Memory for a payload of so many bytes; empty refuses the size.
  using Place = std::function<std::span<std::byte>(std::uint64_t bytes)>;
  /// Reads the payload into the memory that `place` gives, and checks it. The size is compared with
  /// the file's before `place` is asked. False: there is no such entry, or it is wrong; what lies
  /// in the memory then means nothing.
  bool read(CacheKind kind, const Hash128& key, const Place& place);
  /// Says of an entry that was read that its content is not what it should be.
  void refuse(const Hash128& key);

  /// Keeps a payload, given in parts, and brings the folder back under its bound.
  void write(CacheKind kind, const Hash128& key,
             std::initializer_list<std::span<const std::byte>> parts);

  /// Entries that were read and not refused.
  int hits() const { return hits_; }
  /// One line about the first thing that was wrong, for the log; empty: all was well.
  const std::string& note() const { return note_; }
  std::filesystem::path entry(const Hash128& key) const;

 private:
  void note(const std::filesystem::path& path, const char* what);
  void evict();

  std::filesystem::path folder_;  // empty: keeps nothing
  std::uint64_t bound_bytes_ = kDefaultBound;
  int hits_ = 0;
  std::string note_;
};

/// Which code is running: the hash of the build ids that the linker wrote into the program and
/// into every library it has loaded. It changes with every change of a source, a compiler, a flag
/// or a library, also where no revision is committed, and costs no file to be read. Found once,
/// at the first call. Empty where the program carries no build id.
std::optional<Hash128> program_id();

}  // namespace sulcus
