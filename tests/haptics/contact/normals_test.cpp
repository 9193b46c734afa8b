#include "haptics/contact/normals.hpp"

#include <gtest/gtest.h>

#include "engine/normals/normal_method.hpp"
#include "tests/haptics/contact/contact_stages.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::normals_test {
namespace {

/// A contact whose burr lies away from `outward`.
void add(ContactScratch& scratch, const Cell& c,
         const Eigen::Vector3f& outward = Eigen::Vector3f::Zero()) {
  Contact contact;
  contact.cell = c;
  test::add_contact(scratch, contact, 0.0f, outward);
}
float offset_m(const ContactScratch& scratch, std::size_t i) {
  return scratch.block(ContactBlock::kOffset)[i];
}

TEST(Normals, EveryContactGetsWhatTheMethodSaysInMetres) {
  const Workpiece workpiece(test::ball({48, 48, 48}, 50e-6, {23, 24, 22}, 18));
  const Eigen::Vector3f outward(0.1f, 0.2f, 1);
  HapticsSettings settings;
  for (const NormalMethod method :
       {NormalMethod::kLdm, NormalMethod::kLdmFast, NormalMethod::kLdmPaper}) {
    settings.normals = method;
    ContactScratch scratch(settings);
    for (const Cell& c : test::surface_cells(workpiece)) {
      add(scratch, c, outward);
    }
    normals(workpiece, settings, nullptr, scratch, 0);
    for (std::size_t i = 0; i < scratch.contacts.size(); ++i) {
      const Contact contact = scratch.contacts[i];
      const SurfaceEstimate e = estimate_surface(workpiece, contact.cell, settings, outward);
      ASSERT_EQ(contact.normal, e.normal);
      ASSERT_FLOAT_EQ(offset_m(scratch, i), e.offset * 50e-6f);
    }
  }
}

TEST(Normals, WhereTheSolidNamesNoSideTheToolDoes) {
  // A wall of one voxel across z, the burr above it.
  const Workpiece workpiece(test::block({24, 24, 24}, 50e-6, {2, 2, 12}, {22, 22, 13}));
  const HapticsSettings settings;
  ContactScratch scratch(settings);
  for (const float side : {1.0f, -1.0f}) {
    scratch.contacts.clear();
    add(scratch, {12, 12, 12}, {0, 0, side});
    normals(workpiece, settings, nullptr, scratch, 0);
    EXPECT_EQ(scratch.contacts[0].normal, Eigen::Vector3f(0, 0, side));
    EXPECT_FLOAT_EQ(offset_m(scratch, 0), 25e-6f);
  }
}

TEST(Normals, WhatIsUndefinedStaysZero) {
  const Workpiece workpiece(test::block({24, 24, 24}, 50e-6, {12, 12, 12}, {13, 13, 13}));
  HapticsSettings settings;
  settings.normals = NormalMethod::kLdmPaper;
  ContactScratch scratch(settings);
  add(scratch, {12, 12, 12});
  normals(workpiece, settings, nullptr, scratch, 0);
  EXPECT_EQ(scratch.contacts[0].normal, Eigen::Vector3f(0, 0, 0));
  EXPECT_EQ(offset_m(scratch, 0), 0.0f);
}

}  // namespace
}  // namespace sulcus::normals_test
