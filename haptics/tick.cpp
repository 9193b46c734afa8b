#include "haptics/tick.hpp"

#include <algorithm>
#include <cmath>

#include "haptics/device/device_port.hpp"
#include "haptics/move_tool.hpp"
#include "haptics/normals.hpp"
#include "haptics/spindle.hpp"

namespace sulcus {

namespace {

/// `turning`: the spindle, unless the device is silent.
CuttingRecord make_cutting_record(const TickContext& context, const SimulationState& state,
                                  const Wrench& tangential, bool turning = true) {
  CuttingRecord record;
  record.tick = state.tick;
  std::copy_n(tangential.force_N.data(), 3, record.tangential_force_N);
  std::copy_n(tangential.torque_Nm.data(), 3, record.tangential_torque_Nm);
  record.spindle_rad_per_s = turning ? spindle_speed_now(context, state) : 0.0;
  record.work_J = state.work_J();
  return record;
}

/// The spindle under the torque with which the tooth brakes it.
void turn_spindle(const TickContext& context, const ContactResult& contact, double dt_s,
                  SimulationState& state) {
  const Eigen::Vector3d axis = state.tool.direction(Eigen::Vector3d::UnitY());
  state.spindle_rad_per_s =
      spindle_speed(*context.scene.spindle, context.burr.speed_rad_per_s, *state.spindle_rad_per_s,
                    -axis.dot(contact.tangential.torque_Nm), dt_s);
}

/// It stands while the device is silent, and runs up again after it.
void stop_spindle(const TickContext& context, SimulationState& state, TickScratch& scratch) {
  if (state.spindle_rad_per_s) state.spindle_rad_per_s = 0.0;
  if (context.scene.cutting) scratch.cutting = make_cutting_record(context, state, {}, false);
}

/// Removes from body `i` what the tangential force on it has paid for. Returns fault bits.
std::uint32_t cut_body(const TickContext& context, std::size_t i, SimulationState& state,
                       TickScratch& scratch) {
  Body& body = state.bodies[i];
  const ContactScratch& contact = scratch.bodies[i].contact;
  const std::size_t before = scratch.edits.size();
  const std::uint32_t faults = removal(
      body.solid, std::span(context.scene.tissues).subspan(body.first_tissue),
      1.0 / context.scene.haptics.rate_hz, state.tick, contact, *body.removal, scratch.edits);
  body.solid.switch_off(contact.hollow);
  const auto cut = std::span(scratch.edits).subspan(before);
  for (Edit& edit : cut) edit.body = static_cast<std::uint16_t>(i);
  if (body.kept) body.kept->drop(cut);
  return faults;
}

/// Whether what each contact does can be reckoned with, of all bodies that are cut.
bool has_finite_powers(const SimulationState& state, const TickScratch& scratch) {
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    const Contacts& contacts = scratch.bodies[i].contact.contacts;
    if (state.bodies[i].removal && !has_finite_powers(contacts)) return false;
  }
  return true;
}

/// Cuts all bodies, and brakes the spindle by it. Where a power is not finite, nothing of either.
void cut(const TickContext& context, SimulationState& state, TickScratch& scratch,
         ContactResult& contact) {
  const auto timed = scratch.clock().time(Stage::kRemoval);
  if (!has_finite_powers(state, scratch)) contact.faults |= kFaultNotFinite;
  if (contact.faults & kFaultNotFinite) {
    contact.wrench = contact.tangential = {};
    scratch.cutting = make_cutting_record(context, state, {});
    return;
  }
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    if (state.bodies[i].removal) contact.faults |= cut_body(context, i, state, scratch);
  }
  scratch.cutting = make_cutting_record(context, state, contact.tangential);
  if (state.spindle_rad_per_s) {
    turn_spindle(context, contact, 1.0 / context.scene.haptics.rate_hz, state);
  }
}

/// Keeps the normals that were found, and counts who was touched.
void keep(const TickContext& context, SimulationState& state, TickScratch& scratch) {
  const auto timed = scratch.clock().time(Stage::kNormals);
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    Body& body = state.bodies[i];
    auto& [contact, found] = scratch.bodies[i];
    if (body.kept) {
      keep_normals(body.solid, context.scene.haptics, state.tick, contact, *body.kept);
    }
    if (found.contacts > 0) ++body.touched_ticks;
    const double force_N = found.wrench.force_N.norm();
    if (std::isfinite(force_N)) body.peak_force_N = std::max(body.peak_force_N, force_N);
  }
}

/// Takes pieces that were cut loose out of the workpiece.
void let_go(std::span<const std::uint32_t> loose, SimulationState& state, TickScratch& scratch) {
  const auto timed = scratch.clock().time(Stage::kRemoval);
  Body& workpiece = state.workpiece();
  remove_loose(workpiece.solid, loose, state.tick, *workpiece.removal, scratch.edits);
  if (workpiece.kept) workpiece.kept->drop(scratch.edits);
}

/// A contact that is not finite counts as none, and ends the run.
void refuse_infinite(ContactResult& contact) {
  if (contact.wrench.force_N.allFinite() && contact.wrench.torque_Nm.allFinite()) return;
  contact.faults |= kFaultNotFinite;
  contact.wrench = contact.tangential = {};
}

PortRecord make_port_record(const SimulationState& state, const MovedTool& moved) {
  PortRecord record;
  record.tick = state.tick;
  std::copy_n(moved.asked.force_N.data(), 3, record.asked_force_N);
  std::copy_n(moved.asked.torque_Nm.data(), 3, record.asked_torque_Nm);
  record.absorbed_J = state.port.passivity.energy_J;
  record.given_out_J = state.port.passivity.given_out_J();
  record.dissipated_J = state.port.passivity.dissipated_J;
  record.evaluations = static_cast<std::uint64_t>(moved.evaluations);
  return record;
}

void write_pose(const Pose& pose, double position[3], double orientation[4]) {
  std::copy_n(pose.position.data(), 3, position);
  const Eigen::Quaterniond& q = pose.orientation;
  orientation[0] = q.w();
  std::copy_n(q.vec().data(), 3, orientation + 1);
}

TickRecord make_record(const SimulationState& state, const Pose& device_pose, double dt_s,
                       const ContactResult& contact, const Wrench& sent) {
  TickRecord record;
  record.tick = state.tick;
  record.time_s = static_cast<double>(state.tick) * dt_s;
  write_pose(device_pose, record.device_position_m, record.device_orientation);
  write_pose(state.tool, record.tool_position_m, record.tool_orientation);
  std::copy_n(sent.force_N.data(), 3, record.force_N);
  std::copy_n(sent.torque_Nm.data(), 3, record.torque_Nm);
  std::copy_n(contact.wrench.force_N.data(), 3, record.contact_force_N);
  std::copy_n(contact.wrench.torque_Nm.data(), 3, record.contact_torque_Nm);
  record.contacts = contact.contacts;
  record.tested = contact.tested;
  record.leaves = contact.leaves;
  record.faults = contact.faults;
  return record;
}

}  // namespace

void rehearse(const TickContext& context, const SimulationState& state,
              TickScratch& scratch) noexcept {
  if (!state.has_pose) return;
  contact_with_bodies(context, state, state.tool, true,
                      context.scene.coupling ? Asked::kCoupled : Asked::kForce, scratch);
}

TickRecord tick(const TickContext& context, Device& device, SimulationState& state,
                TickScratch& scratch, std::span<const std::uint32_t> loose) noexcept {
  const double dt_s = 1.0 / context.scene.haptics.rate_hz;
  scratch.edits.clear();
  if (!loose.empty()) let_go(loose, state, scratch);

  const DeviceReading reading = read_pose(context, device, state.tick, state.port);
  MovedTool moved;
  ContactResult& contact = moved.contact;
  if (state.port.has_pose && (reading.faults & kFaultNotFinite) == 0) {
    moved = move_tool(context, reading, state, scratch);
    refuse_infinite(contact);
    keep(context, state, scratch);
    if (context.scene.cutting && !reading.silent) cut(context, state, scratch, contact);
  } else if (context.scene.cutting) {  // the tool stays
    scratch.cutting = make_cutting_record(context, state, {});
  }
  if (reading.silent) stop_spindle(context, state, scratch);
  contact.faults |= reading.faults;
  const Wrench sent = render_wrench(context, reading, moved.asked, state.port, contact.faults);
  device.apply(sent);

  TickRecord record = make_record(state, reading.pose, dt_s, contact, sent);
  scratch.port = make_port_record(state, moved);
  record.removed =
      static_cast<std::uint32_t>(std::ranges::count_if(scratch.edits, [](const Edit& edit) {
        return edit.body == 0 && edit.cause == EditCause::kCut;
      }));
  ++state.tick;
  return record;
}

}  // namespace sulcus
