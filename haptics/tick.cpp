#include "haptics/tick.hpp"

#include <algorithm>
#include <array>

#include "haptics/broad_phase.hpp"
#include "haptics/evaluate_contact.hpp"
#include "haptics/normals.hpp"

namespace sulcus {

namespace {

bool is_finite(const Pose& pose) {
  return pose.position.allFinite() && pose.orientation.coeffs().allFinite();
}

/// Takes the tool to the device's pose; its motion since the last tick. For the small turns of one
/// tick twice the vector part of the turn's quaternion is its angle.
Twist move_tool(SimulationState& state, const Pose& to, double dt_s) {
  Twist twist;
  if (state.has_pose) {
    Eigen::Quaterniond turn = to.orientation * state.tool.orientation.conjugate();
    if (turn.w() < 0.0) turn.coeffs() = -turn.coeffs();
    twist.linear_m_per_s = (to.position - state.tool.position) / dt_s;
    twist.angular_rad_per_s = 2.0 * turn.vec() / dt_s;
  }
  state.tool = to;
  state.has_pose = true;
  return twist;
}

/// Contact with the bodies that the burr is near: the workpiece, so far.
ContactResult contact_with_bodies(const TickContext& context, const Workpiece& workpiece,
                                  const SimulationState& state, const Twist& twist,
                                  ContactScratch& scratch) {
  std::array<std::uint16_t, 1> near{};
  scratch.forget();
  {
    const auto timed = scratch.clock.time(Stage::kBroadPhase);
    const Eigen::AlignedBox3d box =
        capsule_bounds(context.burr.capsule, state.tool, workpiece.grid().voxel_m);
    if (context.bodies.find(context.bodies.bodies, box, near) == 0) return {};
  }
  return evaluate_contact(workpiece, context.scene.tissues, context.burr, state.tool,
                          state.removal ? &twist : nullptr, context.scene.haptics,
                          state.kept ? &*state.kept : nullptr, scratch);
}

/// What the hand gets: the contact's wrench, or nothing and a fault where it is not finite. Limits
/// belong to a device; a trajectory has none.
Wrench device_edge(ContactResult& contact) {
  if (contact.wrench.force_N.allFinite() && contact.wrench.torque_Nm.allFinite()) {
    return contact.wrench;
  }
  contact.faults |= kFaultNotFinite;
  contact.wrench = {};
  return {};
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

TickRecord tick(const TickContext& context, Device& device, Workpiece& workpiece,
                SimulationState& state, TickScratch& scratch) noexcept {
  const double dt_s = 1.0 / context.scene.haptics.rate_hz;
  scratch.edits.clear();

  Pose device_pose = device.pose(state.tick);
  ContactResult contact;
  if (is_finite(device_pose)) {
    const Twist twist = move_tool(state, device_pose, dt_s);
    contact = contact_with_bodies(context, workpiece, state, twist, scratch.contact);
    if (state.kept) {
      const auto timed = scratch.contact.clock.time(Stage::kNormals);
      keep_normals(workpiece, context.scene.haptics, state.tick, scratch.contact, *state.kept);
    }
    if (state.removal) {
      const auto timed = scratch.contact.clock.time(Stage::kRemoval);
      contact.faults |= removal(workpiece, context.scene.tissues, dt_s, state.tick, scratch.contact,
                                *state.removal, scratch.edits);
      workpiece.switch_off(scratch.contact.hollow);
      if (state.kept) state.kept->drop(scratch.edits);
    }
  } else {
    device_pose = state.tool;  // the tool stays; the fault stops the run
    contact.faults = kFaultNotFinite;
  }
  const Wrench sent = device_edge(contact);
  device.apply(sent);

  TickRecord record = make_record(state, device_pose, dt_s, contact, sent);
  record.removed = static_cast<std::uint32_t>(scratch.edits.size());
  ++state.tick;
  return record;
}

}  // namespace sulcus
