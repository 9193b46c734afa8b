#include "haptics/move_tool.hpp"

#include <algorithm>

#include "engine/core/fault.hpp"
#include "haptics/contact/broad_phase.hpp"
#include "haptics/contact/evaluate_contact.hpp"
#include "haptics/contact/normals.hpp"
#include "haptics/coupling.hpp"
#include "haptics/free_distance.hpp"
#include "haptics/load_balance.hpp"
#include "haptics/tool_motion.hpp"
#include "haptics/way_through.hpp"

namespace sulcus {

namespace {

/// How fast a load pushes the tool on, at most: a hand does not let go of it.
constexpr double kFastestAdvance_m_per_s = 20e-3;

Motion motion_of(const DeviceReading& device) {
  return device.slides ? Motion::kSlides : Motion::kNone;
}

double voxel_m_of(const SimulationState& state) { return state.workpiece().solid.grid().voxel_m; }

/// How far beyond the burr a body may lie and still count for a contact: that lies within two of
/// its voxels of the burr, and what covers it may lie one further.
double contact_margin_m(const SimulationState& state) {
  double coarsest_m = 0.0;
  for (const Body& body : state.bodies) {
    coarsest_m = std::max(coarsest_m, body.solid.grid().voxel_m);
  }
  return 3.0 * coarsest_m;
}

/// free_distance to all bodies.
double free_distance_to_bodies(const TickContext& context, const SimulationState& state,
                               const Pose& tool, double wanted_m, TickScratch& scratch) noexcept {
  const Eigen::AlignedBox3d box =
      capsule_bounds(context.burr.capsule, tool, wanted_m + voxel_m_of(state));
  double way_m = wanted_m;
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    const Body& body = state.bodies[i];
    if (!body.bounds_world.intersects(box)) continue;
    way_m = std::min(way_m, free_distance(body.solid, context.burr, body.grid_from(tool), way_m,
                                          scratch.bodies[i].contact));
  }
  return way_m;
}

/// Of all bodies.
void keep_found(const HapticsSettings& settings, SimulationState& state,
                TickScratch& scratch) noexcept {
  const auto timed = scratch.clock().time(Stage::kNormals);
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    if (!state.bodies[i].normal_cache) continue;
    keep_found(settings, state.tick, scratch.bodies[i].contact, *state.bodies[i].normal_cache);
  }
}

void follow_coupling(const TickContext& context, const DeviceReading& device,
                     SimulationState& state, TickScratch& scratch, TickResult& result) noexcept {
  const CouplingSettings& settings = *context.scene.coupling;
  const CouplingSprings springs(settings, context.burr);
  Pose tool = state.has_pose ? state.tool : device.pose;
  const CoupledResult coupled = couple(
      springs, settings, context.burr.reference_m, 0.5 * voxel_m_of(state), device.before,
      device.pose, tool,
      [&](const Pose& pose) noexcept {
        const ContactResult contact = contact_with_bodies(context, state, pose, motion_of(device),
                                                          Outputs::kCoupling, scratch);
        keep_found(context.scene.haptics, state, scratch);
        return contact;
      },
      [&](const Pose& pose, double wanted_m) noexcept {
        return free_distance_to_bodies(context, state, pose, wanted_m, scratch);
      });
  state.tool = tool;
  result.contact = coupled.contact;
  result.commanded = pull_on_device(springs, device.pose, tool, context.burr.reference_m);
  result.evaluations = static_cast<std::uint64_t>(coupled.evaluations);
  if (coupled.lags) result.faults |= kFaultStepTooLong;
}

void follow_load(const TickContext& context, const DeviceReading& device, SimulationState& state,
                 TickScratch& scratch, TickResult& result) noexcept {
  Pose tool = device.pose;
  const TrajectorySettings& settings = context.scene.trajectory;
  const Eigen::Vector3d& along = settings.load_direction;
  // On binary voxels the force itself is no more even than 1 %.
  const double tolerance = state.workpiece().solid.has_fills() ? 0.001 : 0.01;
  const LoadSearch search{*settings.load_N, 0.5 * voxel_m_of(state),
                          kFastestAdvance_m_per_s / context.scene.haptics.rate_hz, tolerance};
  const auto evaluate = [&](double offset_m, Outputs outputs) {
    tool.position = device.pose.position + offset_m * along;
    const ContactResult& contact = result.contact =
        contact_with_bodies(context, state, tool, motion_of(device), outputs, scratch);
    ++result.evaluations;
    return Resistance{-along.dot(contact.wrench.force_N),
                      along.dot(contact.stiffness.topLeftCorner<3, 3>() * along)};
  };
  state.load_offset_m = balance_load(search, *state.load_offset_m, evaluate);
  state.tool = tool;
  result.commanded = result.contact.wrench;
}

/// Rigidly.
void go_to(const TickContext& context, const Pose& pose, Motion motion, SimulationState& state,
           TickScratch& scratch, TickResult& result) noexcept {
  result.contact = contact_with_bodies(context, state, pose, motion, Outputs::kForce, scratch);
  result.commanded = result.contact.wrench;
  result.evaluations = 1;
  state.tool = pose;
}

/// Whether a step takes the burr further into what it cuts than a tick can remove: a layer of
/// voxels, which are the contacts. How far it goes is measured along the burr's surface normal, at
/// the contacts that do work: at the rim of a groove as deep as d, a round burr of radius R goes
/// sqrt(2 d / R - (d / R)^2) of its step into the solid.
///
/// That a voxel is the bound was measured: 281 grooves along a tilted box, drawn at random from
/// voxels of 25 to 70 um, R 0.25 to 1 mm, d 0.08 to 0.5 R, steps of 0.3 to 40 voxels, 40,000 to
/// 300,000 rpm and 0.003 to 1 J/mm3; removed volume against that at the same speed with up to 16
/// times the rate. It falls short, in the median, by 0.1 % where the burr goes in by up to 0.7
/// voxel, 0.5 % to 1 voxel, 2 % from there to 1.8, 9 % to 3.6, 31 % to 6, 50 % to 11.
bool outruns_removal(const Burr& burr, const Pose& tool, const Eigen::Vector3d& step_world,
                     const Body& body, const Contacts& contacts) noexcept {
  const VoxelGrid& grid = body.solid.grid();
  if (!body.removal || step_world.norm() <= grid.voxel_m) return false;
  const float* const power_W = contacts(Contacts::kPower);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (!(power_W[i] > 0.0f)) continue;
    const Eigen::Vector3d centre =
        body.world_from_grid.point(grid.centre_world(cell_of_key(contacts.keys()[i])));
    const Eigen::Vector3d field = burr.field.field_from_tool(tool.inverse_point(centre));
    Eigen::Vector3f outward_tool;
    burr.field.sample_with_gradient(field.cast<float>(), outward_tool);
    if (tool.direction(outward_tool.cast<double>()).dot(step_world) > grid.voxel_m) return true;
  }
  return false;
}

/// Faults of the tool's way from where it was.
std::uint32_t faults_of_way(const TickContext& context, const SimulationState& state,
                            const TickScratch& scratch, const Pose& before,
                            const ContactResult& contact) noexcept {
  const Eigen::Vector3d from = middle_of_head(context.burr, before);
  const Eigen::Vector3d to = middle_of_head(context.burr, state.tool);
  // A jump is a fault of its own.
  const bool steps = step_of(context.burr, before, state.tool) <= kLongestStep_m;
  const Eigen::AlignedBox3d way = Eigen::AlignedBox3d(from).extend(to);
  std::uint32_t faults = 0;
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    const Body& body = state.bodies[i];
    const bool is_on_way = body.solid_bounds_world.intersects(way);
    const VoxelModel& solid = body.solid.model();
    if (is_on_way && steps && goes_through(solid, body.world_from_grid, from, to)) {
      faults |= kFaultStepTooLong;
    }
    if (steps && !context.scene.coupling &&
        outruns_removal(context.burr, state.tool, to - from, body,
                        scratch.bodies[i].contact.contacts)) {
      faults |= kFaultStepTooLong;
    }
    if (is_on_way && is_inside(solid, body.world_from_grid, to)) faults |= kFaultToolInside;
  }
  const Eigen::Vector3d normal_force_N = contact.wrench.force_N - contact.tangential.force_N;
  const double deeper = -normal_force_N.dot(to - from);  // as a way, times the force
  if (steps && !context.scene.coupling && deeper > voxel_m_of(state) * normal_force_N.norm()) {
    faults |= kFaultStepTooLong;
  }
  return faults;
}

}  // namespace

Eigen::Vector3d middle_of_head(const Burr& burr, const Pose& tool) noexcept {
  return tool.point(Eigen::Vector3d(0.0, 0.5 * burr.head_length_m, 0.0));
}

double spindle_speed_now(const TickContext& context, const SimulationState& state) noexcept {
  return state.spindle_rad_per_s.value_or(context.burr.speed_rad_per_s * state.pedal);
}

ContactResult contact_with_bodies(const TickContext& context, const SimulationState& state,
                                  const Pose& tool, Motion motion, Outputs outputs,
                                  TickScratch& scratch) noexcept {
  const double dt_s = 1.0 / context.scene.haptics.rate_hz;
  const Pose& before = state.has_pose ? state.tool : tool;
  const Twist twist = motion_between(before, tool, dt_s, spindle_speed_now(context, state));
  const bool drags =
      motion == Motion::kSlides && step_of(context.burr, before, tool) <= kLongestStep_m;
  const ContactQuery query{
      context.burr, tool, context.scene.tissues, context.scene.haptics, drags ? &twist : nullptr,
      outputs};
  scratch.clear_results();
  const Eigen::AlignedBox3d box =
      capsule_bounds(context.burr.capsule, tool, contact_margin_m(state));
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    if (!state.bodies[i].solid_bounds_world.intersects(box)) continue;
    auto& [contact, result] = scratch.bodies[i];
    scratch.near.push_back({&state.bodies[i], &contact, &result});
  }
  return evaluate_contact(scratch.near, query);
}

void move_tool(const TickContext& context, const DeviceReading& device, SimulationState& state,
               TickScratch& scratch, TickResult& result) noexcept {
  const Pose before = state.has_pose ? state.tool : device.pose;
  if (device.silent && state.has_pose) {
    go_to(context, state.tool, Motion::kNone, state, scratch, result);
    if (context.scene.coupling) {
      const CouplingSprings springs(*context.scene.coupling, context.burr);
      result.commanded = pull_on_device(springs, device.pose, state.tool, context.burr.reference_m);
    }
  } else if (state.load_offset_m) {
    follow_load(context, device, state, scratch, result);
  } else if (context.scene.coupling) {
    follow_coupling(context, device, state, scratch, result);
  } else {
    go_to(context, device.pose, motion_of(device), state, scratch, result);
  }
  state.has_pose = true;
  result.faults |=
      result.contact.faults | faults_of_way(context, state, scratch, before, result.contact);
}

}  // namespace sulcus
