#include "haptics/contact/evaluate_contact.hpp"

#include "engine/core/fault.hpp"
#include "haptics/contact/broad_phase.hpp"
#include "haptics/contact/contact_force.hpp"
#include "haptics/contact/narrow_phase.hpp"
#include "haptics/contact/normals.hpp"

namespace sulcus {

namespace {

/// A quantity of the grid's space in world axes.
Wrench in_world(const Wrench& wrench, const Pose& world_from_grid) {
  return {world_from_grid.direction(wrench.force_N), world_from_grid.direction(wrench.torque_Nm)};
}

Matrix6d in_world(const Matrix6d& stiffness, const Pose& world_from_grid) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = world_from_grid.orientation.toRotationMatrix();
  turn.bottomRightCorner<3, 3>() = turn.topLeftCorner<3, 3>();
  return turn * stiffness * turn.transpose();
}

}  // namespace

ContactResult evaluate_contact(const Workpiece& solid, const ContactQuery& query,
                               ContactScratch& scratch, const NormalCache* cache) noexcept {
  ContactResult result;
  StageClock& clock = scratch.clock;
  const double reach_m = contact_reach_m(solid, query.settings.scaling, query.outputs);
  {
    const auto timed = clock.time(Stage::kBroadPhase);
    if (!broad_phase(solid, query.burr.capsule, query.world_from_tool, reach_m, scratch)) {
      result.faults |= kFaultContactsFull;
    }
    result.leaves = static_cast<std::uint32_t>(scratch.leaves.size());
  }
  NarrowPhase phase = [&] {
    const auto timed = clock.time(Stage::kNarrowPhase);
    return NarrowPhase(solid, query.burr.field, query.world_from_tool, reach_m, scratch);
  }();
  ContactForce force(solid, query.burr, query.world_from_tool, query.settings.scaling,
                     query.outputs);
  for (bool more = true; more;) {
    const std::size_t first = scratch.contacts.size();
    {
      const auto timed = clock.time(Stage::kNarrowPhase);
      more = phase.next();
      if (scratch.contacts.size() > scratch.capacity) {
        // Which are the deepest is known only once all have been found.
        result.faults |= kFaultContactsFull;
        phase.begin_with_deepest();
        force.begin();
        more = true;
        continue;
      }
    }
    {
      const auto timed = clock.time(Stage::kNormals);
      normals(solid, query.settings, cache, scratch, first);
    }
    const auto timed = clock.time(Stage::kContactForce);
    if (more) force.measure(scratch);
  }
  const auto timed = clock.time(Stage::kContactForce);
  result.tested = phase.tested();
  force.sum(query.tissues, query.twist, scratch, result);
  return result;
}

ContactResult evaluate_contact(const Body& body, const ContactQuery& query,
                               ContactScratch& scratch) noexcept {
  ContactQuery own{query.burr,
                   body.grid_from(query.world_from_tool),
                   query.tissues.subspan(body.first_tissue),
                   query.settings,
                   body.removal ? query.twist : nullptr,
                   query.outputs};
  const NormalCache* const cache = body.normal_cache ? &*body.normal_cache : nullptr;
  if (body.is_in_world()) return evaluate_contact(body.solid, own, scratch, cache);
  const Pose& place = body.world_from_grid;
  Twist twist;
  if (own.twist) {
    twist = {place.inverse_direction(query.twist->linear_m_per_s),
             place.inverse_direction(query.twist->angular_rad_per_s),
             query.twist->spindle_rad_per_s};
    own.twist = &twist;
  }
  ContactResult result = evaluate_contact(body.solid, own, scratch, cache);
  result.wrench = in_world(result.wrench, place);
  result.tangential = in_world(result.tangential, place);
  if (query.outputs != Outputs::kForce) result.stiffness = in_world(result.stiffness, place);
  return result;
}

}  // namespace sulcus
