#include "engine/cache/cached_field.hpp"

#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "engine/tool/burr.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::cached_field_test {
namespace {

void expect_same_bits(const DistanceField& a, const DistanceField& b) {
  EXPECT_EQ(a.samples(), b.samples());
  EXPECT_EQ(a.grid().origin_tool, b.grid().origin_tool);
  EXPECT_EQ(a.spacing_m(), b.spacing_m());
  ASSERT_EQ(a.values().size(), b.values().size());
  EXPECT_EQ(std::memcmp(a.values().data(), b.values().data(), a.memory_bytes()), 0);
}

DistanceField burr_field(const Eigen::Vector3i& samples) {
  BurrSettings settings;
  settings.shape = BurrShape::kPear;
  settings.field_samples = samples;
  return make_burr(settings, 50e-6).field;
}

/// A field that is no mirror image of itself.
DistanceField aslant() {
  FieldGrid grid;
  grid.samples = {17, 30, 12};
  grid.spacing_m = 1e-4;
  DistanceField field(grid);
  for (int k = 0; k < 12; ++k) {
    for (int j = 0; j < 30; ++j) {
      for (int i = 0; i < 17; ++i)
        field.kept_at(i, j, k) = static_cast<float>(0.1 * i + 0.01 * j - 0.3 * k);
    }
  }
  return field;
}

TEST(CachedField, ComesBackBitForBit) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path(""));
  int hits = 0;
  const auto expect_back = [&](const DistanceField& field, FieldMirrors mirrors) {
    const Hash128 key{1, static_cast<std::uint64_t>(field.samples().x())};
    EXPECT_FALSE(read_cached_field(cache, key, field.grid(), mirrors));
    write_cached_field(cache, key, field);
    const auto again = read_cached_field(cache, key, field.grid(), mirrors);
    ASSERT_TRUE(again);
    expect_same_bits(field, *again);
    EXPECT_EQ(cache.hits(), ++hits);
  };
  // Even and odd samples: with and without a plane in the middle of the mirrors.
  expect_back(burr_field({32, 128, 32}), FieldMirrors::kXAndZ);
  expect_back(burr_field({33, 100, 31}), FieldMirrors::kXAndZ);
  expect_back(aslant(), FieldMirrors::kNone);
  EXPECT_EQ(cache.note(), "");
}

TEST(CachedField, TheSamplesOfOtherMirrorsAreNoneOfIts) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path(""));
  const DistanceField field = burr_field({32, 128, 32});
  write_cached_field(cache, {1, 1}, field);
  EXPECT_FALSE(read_cached_field(cache, {1, 1}, field.grid(), FieldMirrors::kNone));
}

TEST(CachedField, RefusesAnotherSizeAndWhatIsNoDistance) {
  const ScratchFolder scratch;
  LoadCache cache(scratch.path(""));
  DistanceField field = aslant();
  write_cached_field(cache, {1, 1}, field);
  FieldGrid larger = field.grid();
  larger.samples.y() += 16;
  EXPECT_FALSE(read_cached_field(cache, {1, 1}, larger, FieldMirrors::kNone));
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::infinity()}) {
    field.kept_at(16, 29, 11) = bad;
    write_cached_field(cache, {1, 1}, field);
    EXPECT_FALSE(read_cached_field(cache, {1, 1}, field.grid(), FieldMirrors::kNone));
  }
  EXPECT_EQ(cache.hits(), 0);
  EXPECT_NE(cache.note(), "");
}

}  // namespace
}  // namespace sulcus::cached_field_test
