#include "haptics/contact/contacts.hpp"

#include <gtest/gtest.h>

namespace sulcus::contacts_test {
namespace {

constexpr std::size_t kGroup = Contacts::kGroup;

Contact numbered(int n) {
  Contact contact;
  contact.cell = Cell(n, 2, 3);
  contact.tissue = static_cast<std::uint8_t>(n);
  contact.normal = Eigen::Vector3f(0, static_cast<float>(n), 1);
  contact.along = 0.25f;
  contact.depth_m = 1e-6f * static_cast<float>(n + 1);
  contact.weight = 0.5f;
  contact.normal_force_N = 2.0f;
  contact.power_W = 3.0f;
  return contact;
}

TEST(Contacts, WhatIsSetIsThereAndWhatFillsUpTheLastGroupIsZero) {
  Contacts contacts(100);
  for (int n = 0; n < 50; ++n) contacts.push_back(numbered(n));
  ASSERT_EQ(contacts.size(), 50u);
  int n = 0;
  for (const Contact contact : contacts) {
    const Contact expected = numbered(n++);
    EXPECT_EQ(contact.cell, expected.cell);
    EXPECT_EQ(contact.tissue, expected.tissue);
    EXPECT_EQ(contact.normal, expected.normal);
    EXPECT_EQ(contact.along, expected.along);
    EXPECT_EQ(contact.depth_m, expected.depth_m);
    EXPECT_EQ(contact.weight, expected.weight);
    EXPECT_EQ(contact.normal_force_N, expected.normal_force_N);
    EXPECT_EQ(contact.power_W, expected.power_W);
  }
  for (std::size_t i = 50; i % kGroup != 0; ++i) {
    EXPECT_EQ(contacts.keys()[i], 0u);
    EXPECT_EQ(contacts(Contacts::kDepth)[i], 0.0f);
  }
}

TEST(ContactBlock, AGroupThatIsNotFullGoesWithTheNextBlock) {
  ContactBlock block;
  const auto set = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      block(ContactBlock::kDistance)[i - block.first()] = static_cast<float>(i);
      block.set_vector(ContactBlock::kOutward, i - block.first(),
                       Eigen::Vector3f(1, 2, static_cast<float>(i)));
    }
    block.set_end(to);
  };
  set(0, 20);
  block.release(kGroup);
  set(20, 45);
  block.release(kGroup);  // nothing new
  EXPECT_EQ(block.first(), kGroup);
  for (std::size_t i = kGroup; i < 45; ++i) {
    EXPECT_EQ(block(ContactBlock::kDistance)[i - kGroup], static_cast<float>(i));
    EXPECT_EQ(block.vector(ContactBlock::kOutward, i - kGroup).z(), static_cast<float>(i));
  }
  EXPECT_EQ(block(ContactBlock::kDistance)[45 - kGroup], 0.0f) << "what fills up the last group";
  block.release(2 * kGroup);
  EXPECT_EQ(block(ContactBlock::kDistance)[0], 32.0f);
  block.clear();
  EXPECT_EQ(block.first(), 0u);
}

}  // namespace
}  // namespace sulcus::contacts_test
