#include "haptics/normals.hpp"

#include <gtest/gtest.h>

#include "engine/normals/normal_method.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/tools.hpp"

namespace sulcus {
namespace {

Contact contact_at(const Workpiece& workpiece, const Cell& c) {
  Contact contact;
  contact.cell = c;
  contact.voxel = workpiece.grid().linear(c);
  return contact;
}

/// A round burr, and where it is above the middle of the grid (or below it).
const Burr& ball_burr() {
  static const Burr burr = make_burr(test::small_burr(), 50e-6);
  return burr;
}
Pose above(double side = 1.0) {
  Pose pose;
  pose.position = Eigen::Vector3d(0, 0, side * 40e-6);
  pose.orientation =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), side * Eigen::Vector3d::UnitZ());
  return pose;
}

TEST(Normals, EveryContactGetsWhatTheMethodSaysInMetres) {
  const Workpiece workpiece(test::ball({48, 48, 48}, 50e-6, {23, 24, 22}, 18));
  HapticsSettings settings;
  for (const NormalMethod method :
       {NormalMethod::kLdm, NormalMethod::kLdmFast, NormalMethod::kLdmPaper}) {
    settings.normals = method;
    ContactScratch scratch(settings);
    for (const Cell& c : test::surface_cells(workpiece)) {
      scratch.contacts.push_back(contact_at(workpiece, c));
    }
    normals(workpiece, ball_burr().field, above(), settings, scratch);
    for (const Contact& contact : scratch.contacts) {
      const SurfaceEstimate e = estimate_surface(workpiece, contact.cell, settings);
      ASSERT_EQ(contact.normal, e.normal);
      ASSERT_FLOAT_EQ(contact.offset_m, e.offset * 50e-6f);
    }
  }
}

TEST(Normals, WhereTheSolidNamesNoSideTheToolDoes) {
  // A wall of one voxel across z, the burr above it.
  const Workpiece workpiece(test::block({24, 24, 24}, 50e-6, {2, 2, 12}, {22, 22, 13}));
  const HapticsSettings settings;
  ContactScratch scratch(settings);
  scratch.contacts.push_back(contact_at(workpiece, {12, 12, 12}));
  for (const double side : {1.0, -1.0}) {
    scratch.contacts[0].normal.setZero();
    normals(workpiece, ball_burr().field, above(side), settings, scratch);
    EXPECT_EQ(scratch.contacts[0].normal, Eigen::Vector3f(0, 0, static_cast<float>(side)));
    EXPECT_FLOAT_EQ(scratch.contacts[0].offset_m, 25e-6f);
  }
}

TEST(Normals, WhatIsUndefinedStaysZero) {
  const Workpiece workpiece(test::block({24, 24, 24}, 50e-6, {12, 12, 12}, {13, 13, 13}));
  HapticsSettings settings;
  settings.normals = NormalMethod::kLdmPaper;
  ContactScratch scratch(settings);
  scratch.contacts.push_back(contact_at(workpiece, {12, 12, 12}));
  normals(workpiece, ball_burr().field, above(), settings, scratch);
  EXPECT_EQ(scratch.contacts[0].normal, Eigen::Vector3f(0, 0, 0));
  EXPECT_EQ(scratch.contacts[0].offset_m, 0.0f);
}

}  // namespace
}  // namespace sulcus
