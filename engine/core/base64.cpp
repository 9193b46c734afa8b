#include "engine/core/base64.hpp"

#include <algorithm>

#include <openssl/evp.h>

namespace sulcus {

std::string base64(std::span<const std::uint8_t> bytes) {
  // A call takes an int; whole groups of three need no padding in between.
  constexpr std::size_t kAtOnce = 3 << 20;
  std::string text;
  std::string part(kAtOnce / 3 * 4 + 1, '\0');  // it ends what it writes with a zero
  for (std::size_t first = 0; first < bytes.size(); first += kAtOnce) {
    const auto some = bytes.subspan(first, std::min(kAtOnce, bytes.size() - first));
    const int length = EVP_EncodeBlock(reinterpret_cast<unsigned char*>(part.data()), some.data(),
                                       static_cast<int>(some.size()));
    text.append(part, 0, static_cast<std::size_t>(length));
  }
  return text;
}

}  // namespace sulcus
