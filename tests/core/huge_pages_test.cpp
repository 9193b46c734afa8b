#include "engine/core/huge_pages.hpp"

#include <cstdint>
#include <numeric>

#include <gtest/gtest.h>

namespace sulcus::huge_pages_test {
namespace {

TEST(HugePages, AnArrayThatFillsOneBeginsWithOneAndIsAsAnyOther) {
  constexpr std::size_t kHugePage = HugePageAllocator<float>::kHugePage;
  for (const std::size_t bytes : {std::size_t{64}, kHugePage - 4, kHugePage, 3 * kHugePage + 4}) {
    HugePageVector<float> values(bytes / sizeof(float));
    if (bytes >= kHugePage) {
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(values.data()) % kHugePage, 0u) << bytes;
    }
    EXPECT_EQ(std::accumulate(values.begin(), values.end(), 0.0f), 0.0f);
    values.back() = 1.0f;
    const HugePageVector<float> copy = values;
    values.resize(2 * values.size(), 2.0f);
    EXPECT_EQ(copy.back(), 1.0f);
    EXPECT_EQ(values[copy.size() - 1], 1.0f);
    EXPECT_EQ(values.back(), 2.0f);
  }
}

}  // namespace
}  // namespace sulcus::huge_pages_test
