#include <array>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <zlib.h>

#include "engine/import/volumes/itk_volume_writer.hpp"

namespace sulcus {
namespace {

/// Of the stream, in the file's first bytes: behind NRRD's empty line or MetaImage's last key.
std::size_t begin_of_stream(std::string_view file) {
  if (file.starts_with("NRRD")) {
    const std::size_t blank = file.find("\n\n");
    return blank == std::string_view::npos ? file.size() : blank + 2;
  }
  constexpr std::string_view kLastKey = "ElementDataFile = LOCAL\n";
  if (const std::size_t at = file.find(kLastKey); at != std::string_view::npos) {
    return at + kLastKey.size();
  }
  return 0;
}

/// zlib's reader of a stream of its own or of gzip.
class Inflater {
 public:
  Inflater() {
    constexpr int kEither = 15 + 32;  // [zlib.h, inflateInit2]
    if (inflateInit2(&stream_, kEither) != Z_OK) throw std::runtime_error("zlib cannot begin");
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  /// False: damaged, or bytes after its end.
  bool take(std::string_view bytes) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream_.avail_in = static_cast<uInt>(bytes.size());
    do {  // until it has taken all and has no more to give
      if (ended_) return stream_.avail_in == 0;
      stream_.next_out = out_.data();
      stream_.avail_out = static_cast<uInt>(out_.size());
      const int result = inflate(&stream_, Z_NO_FLUSH);
      if (result == Z_BUF_ERROR) return true;  // neither: it waits for more bytes
      if (result != Z_OK && result != Z_STREAM_END) return false;
      ended_ = result == Z_STREAM_END;
      bytes_ += out_.size() - stream_.avail_out;
    } while (stream_.avail_in > 0 || stream_.avail_out == 0);
    return true;
  }
  bool ended() const { return ended_; }
  std::uint64_t bytes() const { return bytes_; }

 private:
  z_stream stream_{};
  std::vector<Bytef> out_ = std::vector<Bytef>(std::size_t{1} << 18);
  std::uint64_t bytes_ = 0;
  bool ended_ = false;
};

}  // namespace

bool is_whole_volume(const std::string& path, std::uint64_t bytes) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path + ": cannot be read");
  std::vector<char> block(std::size_t{1} << 18);  // a header is much shorter
  Inflater stream;
  for (bool first = true;; first = false) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    std::string_view read(block.data(), static_cast<std::size_t>(in.gcount()));
    if (read.empty()) break;
    if (first) read.remove_prefix(begin_of_stream(read));
    if (!stream.take(read)) return false;
  }
  return stream.ended() && stream.bytes() >= bytes;
}

}  // namespace sulcus
