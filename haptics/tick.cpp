#include "haptics/tick.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/fault.hpp"
#include "haptics/contact/normals.hpp"
#include "haptics/cutting_law.hpp"
#include "haptics/device/device_port.hpp"
#include "haptics/move_tool.hpp"
#include "haptics/spindle.hpp"

namespace sulcus {

namespace {

/// Takes pieces that were cut loose out of the workpiece.
void remove_loose_pieces(std::span<const std::uint32_t> loose, SimulationState& state,
                         TickScratch& scratch) {
  const auto timed = scratch.clock().time(Stage::kRemoval);
  Body& workpiece = state.workpiece();
  remove_loose(workpiece.solid, loose, state.tick, *workpiece.removal, scratch.edits);
  if (workpiece.normal_cache) workpiece.normal_cache->drop(scratch.edits);
}

/// Whether force and torque can be reckoned with, and the power of every contact that cuts.
bool is_finite(const SimulationState& state, const TickScratch& scratch,
               const ContactResult& contact) {
  if (!contact.wrench.force_N.allFinite() || !contact.wrench.torque_Nm.allFinite()) return false;
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    const Contacts& contacts = scratch.bodies[i].contact.contacts;
    if (state.bodies[i].removal && !has_finite_powers(contacts)) return false;
  }
  return true;
}

/// A contact that is not finite counts as none, and ends the run.
void refuse_not_finite(const SimulationState& state, TickScratch& scratch, TickResult& result) {
  const auto timed = scratch.clock().time(Stage::kContactForce);
  if (is_finite(state, scratch, result.contact)) return;
  result.faults |= kFaultNotFinite;
  result.contact.wrench = result.contact.tangential = {};
}

/// Caches the normals that were found, and counts which bodies are in contact.
void keep_results(const TickContext& context, SimulationState& state, TickScratch& scratch) {
  const auto timed = scratch.clock().time(Stage::kNormals);
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    Body& body = state.bodies[i];
    auto& [contact, result] = scratch.bodies[i];
    if (body.normal_cache) {
      keep_normals(context.scene.haptics, state.tick, contact, *body.normal_cache);
    }
    if (result.contacts > 0) ++body.touched_ticks;
    const double force_N = result.wrench.force_N.norm();
    if (std::isfinite(force_N)) body.peak_force_N = std::max(body.peak_force_N, force_N);
  }
}

/// Removes from body `i` what the tangential force on it has paid for. Returns fault bits.
std::uint32_t cut_body(const TickContext& context, std::size_t i, SimulationState& state,
                       TickScratch& scratch) {
  Body& body = state.bodies[i];
  const ContactScratch& contact = scratch.bodies[i].contact;
  const std::size_t before = scratch.edits.size();
  std::span<const double> removing(scratch.removing);
  if (!removing.empty()) removing = removing.subspan(body.first_tissue);
  const std::uint32_t faults =
      removal(body.solid, std::span(context.scene.tissues).subspan(body.first_tissue),
              1.0 / context.scene.haptics.rate_hz, state.tick, contact, removing, *body.removal,
              scratch.edits);
  body.solid.switch_off(contact.emptied_nodes);
  const auto cut = std::span(scratch.edits).subspan(before);
  for (Edit& edit : cut) edit.body = static_cast<std::uint16_t>(i);
  if (body.normal_cache) body.normal_cache->drop(cut);
  return faults;
}

/// What share of this tick's work removes, where the law says that it is not all.
void set_removing(const TickContext& context, const TickResult& result, TickScratch& scratch) {
  if (scratch.removing.empty()) return;
  const SaturatingLaw law(context.scene.burr);
  const ContactResult& contact = result.contact;
  const double load_N = (contact.wrench.force_N - contact.tangential.force_N).norm();
  const double rim_m_per_s = result.spindle_rad_per_s * context.burr.rim_radius_m;
  for (std::size_t t = 0; t < scratch.removing.size(); ++t) {
    const double energy_J_per_m3 = context.scene.tissues[t].specific_energy_J_per_m3;
    scratch.removing[t] = law.share(energy_J_per_m3, load_N, rim_m_per_s);
  }
}

/// Cuts all bodies, which brakes the spindle.
void cut(const TickContext& context, SimulationState& state, TickScratch& scratch,
         TickResult& result) {
  const auto timed = scratch.clock().time(Stage::kRemoval);
  set_removing(context, result, scratch);
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    if (state.bodies[i].removal) result.faults |= cut_body(context, i, state, scratch);
  }
  if (!state.spindle_rad_per_s) return;
  const Eigen::Vector3d axis = state.tool.direction(Eigen::Vector3d::UnitY());
  state.spindle_rad_per_s = spindle_speed(
      *context.scene.spindle, context.burr.speed_rad_per_s * state.pedal, *state.spindle_rad_per_s,
      -axis.dot(result.contact.tangential.torque_Nm), 1.0 / context.scene.haptics.rate_hz);
}

std::uint32_t cut_of_workpiece(std::span<const Edit> edits) {
  return static_cast<std::uint32_t>(std::ranges::count_if(edits, [](const Edit& edit) {
    return edit.body == 0 && edit.cause == EditCause::kCut && edit.is_gone();
  }));
}

}  // namespace

TickResult tick(const TickContext& context, Device& device, SimulationState& state,
                TickScratch& scratch, std::span<const std::uint32_t> loose) noexcept {
  TickResult result;
  result.tick = state.tick;
  scratch.edits.clear();
  if (!loose.empty()) remove_loose_pieces(loose, state, scratch);

  const DeviceReading reading = read_pose(context, device, state.tick, state.port);
  result.device = reading.pose;
  result.faults = reading.faults;
  state.pedal = device.pedal();
  result.spindle_rad_per_s = reading.silent ? 0.0 : spindle_speed_now(context, state);
  if (state.port.has_pose && (reading.faults & kFaultNotFinite) == 0) {  // else the tool stays
    move_tool(context, reading, state, scratch, result);
    refuse_not_finite(state, scratch, result);
    keep_results(context, state, scratch);
    const bool cuts = context.scene.cutting && !reading.silent;
    if (cuts && (result.faults & kFaultNotFinite) == 0) cut(context, state, scratch, result);
  }
  // It stands while the device is silent, and runs up again after it.
  if (reading.silent && state.spindle_rad_per_s) state.spindle_rad_per_s = 0.0;
  result.sent = render_wrench(context, reading, result.commanded, state.port, result.faults);
  device.apply(result.sent);

  result.tool = state.tool;
  result.removed = cut_of_workpiece(scratch.edits);
  ++state.tick;
  return result;
}

void warm_caches(const TickContext& context, const SimulationState& state,
                 TickScratch& scratch) noexcept {
  if (!state.has_pose) return;
  contact_with_bodies(context, state, state.tool, Motion::kSlides,
                      context.scene.coupling ? Outputs::kCoupling : Outputs::kForce, scratch);
}

}  // namespace sulcus
