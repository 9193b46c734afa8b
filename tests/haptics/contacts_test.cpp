#include "haptics/contacts.hpp"

#include <gtest/gtest.h>

namespace sulcus {
namespace {

constexpr std::size_t kGroup = Contacts::kGroup;

Contact numbered(int n) {
  Contact contact;
  contact.cell = Cell(n, 2, 3);
  contact.distance_m = -1e-3f * static_cast<float>(n + 1);
  contact.outward = Eigen::Vector3f(1, 2, static_cast<float>(n));
  contact.offset_m = 1e-6f * static_cast<float>(n + 1);
  contact.normal = Eigen::Vector3f(0, static_cast<float>(n), 1);
  return contact;
}

void expect_same(const Contact& a, const Contact& b) {
  EXPECT_EQ(a.cell, b.cell);
  EXPECT_EQ(a.distance_m, b.distance_m) << b.cell.x();
  EXPECT_EQ(a.outward, b.outward);
  EXPECT_EQ(a.offset_m, b.offset_m);
  EXPECT_EQ(a.normal, b.normal);
}

TEST(Contacts, WhatPassesIsForgottenAndMakesRoomAndTheRestStays) {
  Contacts contacts(100);
  const auto add = [&](int from, int to) {
    for (int n = from; n < to; ++n) contacts.push_back(numbered(n));
  };
  add(0, 20);
  contacts.let_pass(kGroup);
  add(20, 45);
  contacts.let_pass(2 * kGroup);
  contacts.let_pass(2 * kGroup);  // nothing new
  add(45, 50);
  ASSERT_EQ(contacts.size(), 50u);
  for (int n = 0; n < 50; ++n) {
    Contact expected = numbered(n);
    if (n < 32) {
      expected.distance_m = expected.offset_m = 0.0f;
      expected.outward.setZero();
    }
    expect_same(contacts[static_cast<std::size_t>(n)], expected);
  }
  EXPECT_EQ(*contacts.from(Contacts::kDistance, 50), 0.0f) << "what fills up the last group";
  EXPECT_EQ(contacts(Contacts::kDistance), nullptr) << "the first have passed";
  EXPECT_EQ(contacts(Contacts::kNormal)[20], 0.0f);
  EXPECT_EQ(contacts(static_cast<Contacts::Quantity>(Contacts::kNormal + 1))[20], 20.0f);

  contacts.resize(0);
  add(7, 8);
  EXPECT_EQ(contacts(Contacts::kDistance)[0], numbered(7).distance_m);
  expect_same(contacts[0], numbered(7));
}

}  // namespace
}  // namespace sulcus
