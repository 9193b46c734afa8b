#include "haptics/contact/normal_cache.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "engine/normals/normal_method.hpp"
#include "haptics/contact/normals.hpp"
#include "tests/haptics/contact/contact_stages.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::normal_cache_test {
namespace {

HapticsSettings with(NormalMethod method) {
  HapticsSettings settings;
  settings.normals = method;
  return settings;
}

bool same(const SurfaceEstimate& a, const SurfaceEstimate& b) {
  return a.defined == b.defined && a.normal == b.normal && a.offset == b.offset;
}

SurfaceEstimate kept_at(const NormalCache& kept, const Cell& c) {
  const std::uint32_t key = voxel_key(c);
  const NormalCache::Page* page = kept.find(leaf_key(key));
  const int place = leaf_place(key);
  if (!page || !NormalCache::is(page->kept, place)) return {};
  const NormalCache::Value& value = page->values[static_cast<std::size_t>(place)];
  return {{value.normal[0], value.normal[1], value.normal[2]}, value.offset, true};
}

std::vector<Workpiece> shapes() {
  std::vector<Workpiece> all;
  all.emplace_back(test::random_blobs({48, 48, 48}, 5));
  all.emplace_back(test::make_model({48, 48, 48}, 1e-4, [](const Cell& c) {
    return std::abs(0.5 * c.x() + 0.2 * c.y() + 0.84 * c.z() - 36.0) < 1.1;
  }));
  all.emplace_back(test::ball({48, 48, 48}, 1e-4, {23, 24, 22}, 18));
  // Along a diagonal of the grid, where maps that are not whole are looked at wide.
  all.emplace_back(
      test::half_space({48, 48, 48}, 1e-4, Eigen::Vector3d(0.72, -0.69, 0.055), {23, 24, 24}));
  return all;
}

TEST(NormalCache, WhatTheToolDoesNotVetoIsTheSameWithoutIt) {
  // What keeping rests on: a normal found without the tool is the one found with it, unless it
  // points away from what the tool says.
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  for (const Workpiece& workpiece : shapes()) {
    for (const NormalMethod method : {NormalMethod::kLdm, NormalMethod::kLdmFast}) {
      int stood = 0, vetoed = 0;
      for (const Cell& c : test::surface_cells(workpiece)) {
        const Eigen::Vector3f tool(unit(random), unit(random), unit(random));
        const SurfaceEstimate alone = estimate_surface(workpiece, c, with(method));
        if (!alone.defined || alone.normal.dot(tool) < 0.0f) {
          ++vetoed;
          continue;
        }
        ++stood;
        ASSERT_TRUE(same(alone, estimate_surface(workpiece, c, with(method), tool)))
            << c.transpose();
      }
      EXPECT_GT(stood, 500);
      EXPECT_GT(vetoed, 500);
    }
  }
}

TEST(NormalCache, WhatAnEditLeavesStandingIsWhatAFreshOneWouldBe) {
  for (const NormalMethod method : {NormalMethod::kLdm, NormalMethod::kLdmFast}) {
    const HapticsSettings settings = with(method);
    for (Workpiece& workpiece : std::vector<Workpiece>(shapes())) {
      NormalCache kept(workpiece.grid(), settings);
      std::vector<Cell> cells = test::surface_cells(workpiece);
      for (const Cell& c : cells) {
        kept.keep(voxel_key(c), estimate_surface(workpiece, c, settings), 0);
      }
      std::mt19937 random(9);
      std::vector<Edit> edits;
      for (int n = 0; n < 4; ++n) {
        const Cell c = cells[random() % cells.size()];
        if (!workpiece.solid(c)) continue;
        workpiece.remove(c);
        edits.push_back({0, workpiece.grid().linear(c), 0, EditCause::kCut});
      }
      kept.drop(edits);
      int stood = 0, dropped = 0;
      for (const Cell& c : cells) {
        if (!workpiece.is_surface(c)) continue;
        const SurfaceEstimate fresh = estimate_surface(workpiece, c, settings);
        const SurfaceEstimate now = kept_at(kept, c);
        if (fresh.defined && now.defined) {
          ++stood;
          ASSERT_TRUE(same(now, fresh)) << c.transpose() << ": " << now.normal.transpose()
                                        << " instead of " << fresh.normal.transpose();
        } else if (fresh.defined) {
          ++dropped;
        }
      }
      EXPECT_GT(stood, 300) << "more than the edits' neighbourhoods is gone";
      EXPECT_GT(dropped, 50);
    }
  }
}

TEST(NormalCache, WhereRoomRunsOutTheLeavesTouchedLongestAgoGiveWay) {
  HapticsSettings settings = with(NormalMethod::kLdmFast);
  settings.max_contacts = 1;  // the fewest leaves: 64
  const VoxelGrid grid{{1024, 16, 8}, 1e-4};
  NormalCache kept(grid, settings);
  const SurfaceEstimate up{{0, 0, 1}, 0.5f, true, 4};
  const auto leaf = [](int n) { return Cell(8 * (n % 128), 8 * (n / 128), 0); };
  for (int n = 0; n < 64; ++n) kept.keep(voxel_key(leaf(n)), up, 1);
  EXPECT_EQ(kept.pages().size(), 64u);
  kept.keep(voxel_key(leaf(64)), up, 1);
  EXPECT_FALSE(kept_at(kept, leaf(64)).defined) << "all leaves are of this tick";
  std::vector<NormalCache::Place> touched;
  for (int n = 0; n < 32; ++n) {
    const std::uint32_t key = leaf_key(voxel_key(leaf(n)));
    touched.push_back(kept.place_of(key, *kept.find(key)));
  }
  // As if another leaf had taken its page since.
  const std::uint32_t other = leaf_key(voxel_key(leaf(40)));
  touched[3].page = kept.place_of(other, *kept.find(other)).page;
  kept.mark_used(touched, 2);
  for (int n = 64; n < 96; ++n) kept.keep(voxel_key(leaf(n)), up, 3);
  for (int n = 0; n < 96; ++n) {
    EXPECT_EQ(kept_at(kept, leaf(n)).defined, n < 32 || n >= 64) << n;
  }
}

/// A plain list of leaves, of which all are looked at for each that gives way.
struct PlainPages {
  static constexpr std::size_t kCapacity = 64;
  struct Page {
    std::uint32_t leaf;
    std::uint64_t touched;
  };
  std::vector<Page> pages;

  void keep(std::uint32_t leaf, std::uint64_t tick) {
    if (std::ranges::any_of(pages, [&](const Page& p) { return p.leaf == leaf; })) return;
    if (pages.size() < kCapacity) return pages.push_back({leaf, tick});
    const auto oldest = std::ranges::min_element(pages, {}, &Page::touched);
    if (oldest->touched < tick) *oldest = {leaf, tick};
  }
  void touch(std::uint32_t leaf, std::uint64_t tick) {
    for (Page& p : pages) p.touched = p.leaf == leaf ? tick : p.touched;
  }
};

TEST(NormalCache, WhichLeavesGiveWayIsWhatLookingAtAllOfThemGives) {
  HapticsSettings settings = with(NormalMethod::kLdmFast);
  settings.max_contacts = 1;  // the fewest leaves: 64
  const VoxelGrid grid{{1024, 1024, 8}, 1e-4};
  const SurfaceEstimate up{{0, 0, 1}, 0.5f, true, 4};
  for (const std::uint32_t leaves : {70u, 130u, 1000u}) {
    NormalCache kept(grid, settings);
    PlainPages plain;
    std::minstd_rand random(leaves);
    // Too few ticks for a leaf to be forgotten.
    for (std::uint64_t tick = 1; tick < 3000; ++tick) {
      if (tick == 1500) {
        kept.clear();
        plain.pages.clear();
      }
      const auto leaf = [&] {
        const int n = static_cast<int>(random() % leaves);
        return voxel_key({8 * (n % 128), 8 * (n / 128), 0});
      };
      std::vector<NormalCache::Place> places;
      const std::size_t touches = random() % (tick % 100 == 0 ? 400 : 20);
      for (std::size_t i = 0; i < touches; ++i) {
        const std::uint32_t key = leaf();
        if (const NormalCache::Page* page = kept.find(key)) {
          places.push_back(kept.place_of(key, *page));
          plain.touch(key, tick);
        }
      }
      kept.mark_used(places, tick);
      const std::size_t made = random() % (tick % 50 == 0 ? 200 : 4);
      for (std::size_t i = 0; i < made; ++i) {
        const std::uint32_t key = leaf();
        kept.keep(key, up, tick);
        plain.keep(key, tick);
      }
      ASSERT_EQ(kept.pages().size(), plain.pages.size());
      for (std::size_t p = 0; p < plain.pages.size(); ++p) {
        ASSERT_EQ(kept.pages()[p].first_key, plain.pages[p].leaf) << tick << ", page " << p;
        ASSERT_EQ(kept.pages()[p].touched, plain.pages[p].touched) << tick << ", page " << p;
      }
    }
  }
}

TEST(NormalCache, ALongRunTakesNoMorePagesThanItsLastSecondsNeed) {
  HapticsSettings settings = with(NormalMethod::kLdmFast);
  const VoxelGrid grid{{1024, 1024, 8}, 1e-4};
  NormalCache kept(grid, settings);
  const SurfaceEstimate up{{0, 0, 1}, 0.5f, true, 4};
  // A new leaf each 20 ticks: 200 are no older than a leaf is kept untouched, 4,000 ticks.
  for (std::uint64_t n = 0; n < 2000; ++n) {
    const auto at = static_cast<int>(n);
    kept.keep(voxel_key({8 * (at % 128), 8 * (at / 128), 0}), up, 20 * n);
  }
  EXPECT_GE(kept.pages().size(), 200u);
  EXPECT_LE(kept.pages().size(), 300u);
  for (int n = 1800; n < 2000; ++n) {
    EXPECT_TRUE(kept_at(kept, {8 * (n % 128), 8 * (n / 128), 0}).defined) << n;
  }
}

class KeptContacts : public ::testing::Test {
 protected:
  KeptContacts() : workpiece_(test::ball({48, 48, 48}, 50e-6, {23, 24, 22}, 18)) {}

  void touch(ContactScratch& scratch) const {
    scratch.contacts.clear();
    for (const Cell& c : test::surface_cells(workpiece_)) {
      if (c.z() < 34) continue;
      Contact contact;
      contact.cell = c;
      test::add_contact(scratch, contact, 0.0f, outward_);
    }
  }
  const Eigen::Vector3f outward_{0, 0, 1};
  Workpiece workpiece_;
};

TEST_F(KeptContacts, KeepingChangesNoNormal) {
  for (const NormalMethod method : {NormalMethod::kLdm, NormalMethod::kLdmFast}) {
    const HapticsSettings settings = with(method);
    ContactScratch scratch(settings), fresh(settings);
    NormalCache kept(workpiece_.grid(), settings);
    for (std::uint64_t tick = 0; tick < 2; ++tick) {
      touch(scratch), touch(fresh);
      normals(workpiece_, settings, &kept, scratch, 0);
      keep_normals(settings, tick, scratch, kept);
      normals(workpiece_, settings, nullptr, fresh, 0);
      for (std::size_t i = 0; i < fresh.contacts.size(); ++i) {
        ASSERT_EQ(scratch.contacts[i].normal, fresh.contacts[i].normal);
        ASSERT_EQ(scratch.block(ContactBlock::kOffset)[i], fresh.block(ContactBlock::kOffset)[i]);
      }
    }
    EXPECT_TRUE(scratch.queries.empty());
  }
}

}  // namespace
}  // namespace sulcus::normal_cache_test
