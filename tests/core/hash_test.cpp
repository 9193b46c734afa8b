#include "engine/core/hash.hpp"

#include <string>

#include <gtest/gtest.h>

namespace sulcus::hash_test {
namespace {

// From the standards' own examples, so that hashes in recordings can be checked by other programs.

TEST(Hash, BytesAreXxh3Of64Bits) {
  EXPECT_EQ(hash_bytes("", 0), 0x2d06800538d394c2u);
  EXPECT_EQ(hash_bytes("abc", 3), 0x78af5f94892f3950u);
}

TEST(Hash, SeedChangesIt) { EXPECT_NE(hash_bytes("abc", 3, 0), hash_bytes("abc", 3, 1)); }

TEST(Hash, HexHasSixteenLowerCaseDigits) {
  EXPECT_EQ(hex(0), "0000000000000000");
  EXPECT_EQ(hex(0x0123456789abcdefu), "0123456789abcdef");
  EXPECT_EQ(hex(~std::uint64_t{0}), "ffffffffffffffff");
}

TEST(Hash, Sha256IsThatOfFips180) {
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

}  // namespace
}  // namespace sulcus::hash_test
