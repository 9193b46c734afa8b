#include "haptics/normals.hpp"

#include <gtest/gtest.h>

#include "engine/normals/normal_method.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus {
namespace {

Contact contact_at(const Workpiece& workpiece, const Cell& c) {
  Contact contact;
  contact.cell = c;
  contact.voxel = workpiece.grid().linear(c);
  return contact;
}

TEST(Normals, EveryContactGetsWhatTheMethodSaysInMetres) {
  const Workpiece workpiece(test::ball({48, 48, 48}, 50e-6, {23, 24, 22}, 18));
  HapticsSettings settings;
  for (const NormalMethod method : {NormalMethod::kLdm, NormalMethod::kLdmPaper}) {
    settings.normals = method;
    ContactScratch scratch(settings);
    for (const Cell& c : test::surface_cells(workpiece)) {
      scratch.contacts.push_back(contact_at(workpiece, c));
    }
    normals(workpiece, settings, scratch);
    for (const Contact& contact : scratch.contacts) {
      const SurfaceEstimate e = estimate_surface(workpiece, contact.cell, settings);
      ASSERT_EQ(contact.normal, e.normal);
      ASSERT_FLOAT_EQ(contact.offset_m, e.offset * 50e-6f);
    }
  }
}

TEST(Normals, WhatIsUndefinedStaysZero) {
  const Workpiece workpiece(test::block({24, 24, 24}, 50e-6, {12, 12, 12}, {13, 13, 13}));
  const HapticsSettings settings;
  ContactScratch scratch(settings);
  scratch.contacts.push_back(contact_at(workpiece, {12, 12, 12}));
  normals(workpiece, settings, scratch);
  EXPECT_EQ(scratch.contacts[0].normal, Eigen::Vector3f(0, 0, 0));
  EXPECT_EQ(scratch.contacts[0].offset_m, 0.0f);
}

}  // namespace
}  // namespace sulcus
