#include "app/session/tick_rows.hpp"

#include <gtest/gtest.h>

#include "tests/support/shapes.hpp"

namespace sulcus::tick_rows_test {
namespace {

using Eigen::Vector3d;

/// A result of which no two numbers are the same.
TickResult numbered() {
  TickResult result;
  result.tick = 12;
  result.device = {{1, 2, 3}, {0.1, 0.2, 0.3, 0.4}};
  result.tool = {{4, 5, 6}, {0.5, 0.6, 0.7, 0.8}};
  result.contact.wrench = {{10, 11, 12}, {13, 14, 15}};
  result.contact.tangential = {{16, 17, 18}, {19, 20, 21}};
  result.contact.contacts = 22;
  result.contact.tested = 23;
  result.contact.leaves = 24;
  result.commanded = {{25, 26, 27}, {28, 29, 30}};
  result.sent = {{31, 32, 33}, {34, 35, 36}};
  result.spindle_rad_per_s = 37;
  result.evaluations = 38;
  result.removed = 39;
  result.faults = 40;
  return result;
}

Vector3d vector(const double (&v)[3]) { return {v[0], v[1], v[2]}; }

TEST(TickRows, ATicksRowHasWhatItDid) {
  const TickRecord row = tick_row(numbered(), 500.0);
  EXPECT_EQ(row.tick, 12u);
  EXPECT_DOUBLE_EQ(row.time_s, 0.024);
  EXPECT_EQ(vector(row.device_position_m), Vector3d(1, 2, 3));
  EXPECT_EQ(row.device_orientation[0], 0.1) << "w first";
  EXPECT_EQ(row.device_orientation[3], 0.4);
  EXPECT_EQ(vector(row.tool_position_m), Vector3d(4, 5, 6));
  EXPECT_EQ(row.tool_orientation[1], 0.6);
  EXPECT_EQ(vector(row.force_N), Vector3d(31, 32, 33));
  EXPECT_EQ(vector(row.torque_Nm), Vector3d(34, 35, 36));
  EXPECT_EQ(vector(row.contact_force_N), Vector3d(10, 11, 12));
  EXPECT_EQ(vector(row.contact_torque_Nm), Vector3d(13, 14, 15));
  EXPECT_EQ(row.contacts, 22u);
  EXPECT_EQ(row.tested, 23u);
  EXPECT_EQ(row.leaves, 24u);
  EXPECT_EQ(row.removed, 39u);
  EXPECT_EQ(row.faults, 40u);
}

TEST(TickRows, WhatAddsUpIsTheStates) {
  Scene scene;
  scene.cutting.emplace();
  SimulationState after =
      initial_state(scene, {Workpiece(test::block({8, 8, 8}, 1e-4, {0, 0, 0}, {8, 8, 8}))});
  after.workpiece().removal->work_J = 50;
  after.port.passivity.energy_J = 51;
  after.port.passivity.given_before_J = 52;
  after.port.passivity.dissipated_J = 53;
  const CuttingRecord cutting = cutting_row(numbered(), after);
  EXPECT_EQ(cutting.tick, 12u);
  EXPECT_EQ(vector(cutting.tangential_force_N), Vector3d(16, 17, 18));
  EXPECT_EQ(vector(cutting.tangential_torque_Nm), Vector3d(19, 20, 21));
  EXPECT_EQ(cutting.spindle_rad_per_s, 37.0);
  EXPECT_EQ(cutting.work_J, 50.0);
  const PortRecord port = port_row(numbered(), after);
  EXPECT_EQ(port.tick, 12u);
  EXPECT_EQ(vector(port.asked_force_N), Vector3d(25, 26, 27));
  EXPECT_EQ(vector(port.asked_torque_Nm), Vector3d(28, 29, 30));
  EXPECT_EQ(port.absorbed_J, 51.0);
  EXPECT_EQ(port.given_out_J, 52.0);
  EXPECT_EQ(port.dissipated_J, 53.0);
  EXPECT_EQ(port.evaluations, 38u);
}

}  // namespace
}  // namespace sulcus::tick_rows_test
