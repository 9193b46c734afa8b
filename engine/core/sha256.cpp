#include <array>
#include <cstdio>
#include <string>

#include <openssl/evp.h>

#include "engine/core/hash.hpp"

namespace sulcus {

std::string sha256_hex(const std::string& text) {
  std::array<unsigned char, 32> digest{};
  EVP_Digest(text.data(), text.size(), digest.data(), nullptr, EVP_sha256(), nullptr);
  std::string line;
  for (unsigned char byte : digest) {
    std::array<char, 3> two{};
    std::snprintf(two.data(), two.size(), "%02x", byte);
    line += two.data();
  }
  return line;
}

}  // namespace sulcus
