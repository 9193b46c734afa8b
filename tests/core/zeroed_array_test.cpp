#include "engine/core/zeroed_array.hpp"

#include <cstdint>
#include <fstream>
#include <utility>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/volume/leaf_bits.hpp"

namespace sulcus::zeroed_array_test {
namespace {

constexpr LeafBits kSome{{1, 2, 3, 4, 5, 6, 7, 8}};

/// Of this process, in bytes.
std::int64_t resident_memory() {
  std::ifstream pages("/proc/self/statm");
  std::int64_t all = 0, resident = 0;
  pages >> all >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

TEST(ZeroedArray, IsZeroUntilWrittenAndLiesWhereItsElementsMay) {
  for (const std::size_t count : {1, 3, 1000, 100000}) {
    ZeroedArray<LeafBits> array(count);
    ASSERT_EQ(array.size(), count);
    EXPECT_EQ(array.bytes(), count * sizeof(LeafBits));
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % alignof(LeafBits), 0u);
    for (const LeafBits& leaf : array) ASSERT_EQ(leaf, LeafBits{});
    array[count - 1] = kSome;
    EXPECT_EQ(array[count - 1], kSome);
  }
  EXPECT_TRUE(ZeroedArray<LeafBits>().empty());
  EXPECT_TRUE(ZeroedArray<LeafBits>(0).empty());
}

TEST(ZeroedArray, ACopyIsEqualAndItsOwn) {
  ZeroedArray<LeafBits> array(50);
  array[7] = kSome;
  ZeroedArray<LeafBits> copy = array;
  EXPECT_EQ(copy, array);
  copy[7] = {};
  EXPECT_NE(copy, array);
  EXPECT_EQ(array[7], kSome);
  array = copy;  // over what was written
  EXPECT_EQ(array[7], LeafBits{});
  EXPECT_EQ(array, copy);
  EXPECT_NE(array, ZeroedArray<LeafBits>(49));
}

TEST(ZeroedArray, WhatWasMovedFromIsEmpty) {
  ZeroedArray<LeafBits> array(50);
  array[7] = kSome;
  ZeroedArray<LeafBits> other = std::move(array);
  EXPECT_EQ(other[7], kSome);
  EXPECT_TRUE(array.empty());  // NOLINT(bugprone-use-after-move): what is tested
  EXPECT_EQ(array.begin(), array.end());
}

TEST(ZeroedArray, KeepsWhatThereIsRoomForWhenItsSizeChanges) {
  ZeroedArray<LeafBits> array(50);
  array[7] = array[40] = kSome;
  array.resize(8);
  ASSERT_EQ(array.size(), 8u);
  EXPECT_EQ(array[7], kSome);
  array.resize(50);
  EXPECT_EQ(array[7], kSome);
  EXPECT_EQ(array[40], LeafBits{});
  array.resize(0);
  EXPECT_TRUE(array.empty());
}

TEST(ZeroedArray, WhatIsNeverWrittenTakesNoMemoryInACopyNeither) {
  constexpr std::size_t kLeaves = std::size_t{4} << 20;  // 256 MiB
  const std::int64_t before = resident_memory();
  ZeroedArray<LeafBits> array(kLeaves);
  array[kLeaves / 2] = kSome;
  const ZeroedArray<LeafBits> copy = array;
  EXPECT_EQ(copy[kLeaves / 2], kSome);
  EXPECT_LT(resident_memory() - before, 16 << 20);
}

}  // namespace
}  // namespace sulcus::zeroed_array_test
