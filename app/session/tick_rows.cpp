#include "app/session/tick_rows.hpp"

#include <algorithm>

namespace sulcus {

namespace {

void put(const Eigen::Vector3d& v, double (&to)[3]) { std::copy_n(v.data(), 3, to); }

void put(const Pose& pose, double (&position)[3], double (&orientation)[4]) {
  put(pose.position, position);
  orientation[0] = pose.orientation.w();
  std::copy_n(pose.orientation.vec().data(), 3, orientation + 1);
}

}  // namespace

TickRecord tick_row(const TickResult& result, double rate_hz) {
  TickRecord row;
  row.tick = result.tick;
  const double dt_s = 1.0 / rate_hz;
  row.time_s = static_cast<double>(result.tick) * dt_s;
  put(result.device, row.device_position_m, row.device_orientation);
  put(result.tool, row.tool_position_m, row.tool_orientation);
  put(result.sent.force_N, row.force_N);
  put(result.sent.torque_Nm, row.torque_Nm);
  put(result.contact.wrench.force_N, row.contact_force_N);
  put(result.contact.wrench.torque_Nm, row.contact_torque_Nm);
  row.contacts = result.contact.contacts;
  row.tested = result.contact.tested;
  row.leaves = result.contact.leaves;
  row.removed = result.removed;
  row.faults = result.faults;
  return row;
}

CuttingRecord cutting_row(const TickResult& result, const SimulationState& after) {
  CuttingRecord row;
  row.tick = result.tick;
  put(result.contact.tangential.force_N, row.tangential_force_N);
  put(result.contact.tangential.torque_Nm, row.tangential_torque_Nm);
  row.spindle_rad_per_s = result.spindle_rad_per_s;
  row.work_J = after.work_J();
  return row;
}

PortRecord port_row(const TickResult& result, const SimulationState& after) {
  PortRecord row;
  row.tick = result.tick;
  put(result.commanded.force_N, row.asked_force_N);
  put(result.commanded.torque_Nm, row.asked_torque_Nm);
  row.absorbed_J = after.port.passivity.energy_J;
  row.given_out_J = after.port.passivity.given_out_J();
  row.dissipated_J = after.port.passivity.dissipated_J;
  row.evaluations = result.evaluations;
  return row;
}

}  // namespace sulcus
