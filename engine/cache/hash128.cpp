#include "engine/cache/hash128.hpp"

#include <cstdio>
#include <new>
#include <vector>

#include "engine/core/hash.hpp"

namespace sulcus {

std::string hex(const Hash128& hash) { return hex(hash.high) + hex(hash.low); }

Hash128Stream::Hash128Stream() : state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();
  XXH3_128bits_reset(state_.get());
}

Hash128Stream& Hash128Stream::add_bytes(const void* data, std::size_t bytes) {
  // Of an empty vector the address may be null, which the library may not be given.
  if (bytes > 0) XXH3_128bits_update(state_.get(), data, bytes);
  return *this;
}

Hash128Stream& Hash128Stream::add(std::string_view text) {
  return add(std::uint64_t{text.size()}).add_bytes(text.data(), text.size());
}

Hash128 Hash128Stream::result() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
  return {hash.low64, hash.high64};
}

std::optional<Hash128> hash_file(const std::string& path) {
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
  if (!file) return std::nullopt;
  std::setvbuf(file.get(), nullptr, _IONBF, 0);        // the blocks are large enough
  std::vector<std::byte> block(std::size_t{1} << 18);  // stays in the processor's cache
  Hash128Stream stream;
  for (std::size_t n; (n = std::fread(block.data(), 1, block.size(), file.get())) > 0;) {
    stream.add_bytes(block.data(), n);
  }
  if (std::ferror(file.get())) return std::nullopt;
  return stream.result();
}

}  // namespace sulcus
