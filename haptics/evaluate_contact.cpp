#include "haptics/evaluate_contact.hpp"

#include <optional>

#include "engine/core/fault.hpp"
#include "haptics/broad_phase.hpp"
#include "haptics/contact_force.hpp"
#include "haptics/narrow_phase.hpp"
#include "haptics/normals.hpp"

namespace sulcus {

namespace {

/// The contacts, their normals and their depths, block by block, so that what only these stages
/// read of a block stays in the caches however many contacts there are. False where there are more
/// than the capacity: which are the deepest is known only once all have been found.
bool find_in_blocks(const Workpiece& solid, const ContactQuery& query, double reach_m,
                    const KeptNormals* kept, ContactScratch& scratch, ContactResult& result,
                    ContactForce& force) {
  Contacts& contacts = scratch.contacts;
  StageClock& clock = scratch.clock;
  NarrowPhase phase = [&] {
    const auto timed = clock.time(Stage::kNarrowPhase);
    return NarrowPhase(solid, query.burr.field, query.world_from_tool, reach_m, scratch, result);
  }();
  for (bool more = true; more;) {
    const std::size_t first = contacts.size();
    {
      const auto timed = clock.time(Stage::kNarrowPhase);
      more = phase.next();
    }
    if (contacts.size() > scratch.capacity) return false;
    {
      const auto timed = clock.time(Stage::kNormals);
      normals(solid, query.settings, kept, scratch, first);
    }
    const auto timed = clock.time(Stage::kContactForce);
    if (more) force.measure(contacts);
  }
  return true;
}

/// Stage by stage, of the deepest that the capacity holds.
void find_deepest(const Workpiece& solid, const ContactQuery& query, double reach_m,
                  const KeptNormals* kept, ContactScratch& scratch, ContactResult& result) {
  {
    const auto timed = scratch.clock.time(Stage::kNarrowPhase);
    result.tested = 0;
    narrow_phase(solid, query.burr.field, query.world_from_tool, reach_m, scratch, result);
  }
  const auto timed = scratch.clock.time(Stage::kNormals);
  normals(solid, query.settings, kept, scratch);
}

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
                               ContactScratch& scratch, const KeptNormals* kept) noexcept {
  ContactResult result;
  const Scaling scaling = query.settings.scaling;
  const double reach_m = contact_reach_m(solid, scaling, query.asked);
  {
    const auto timed = scratch.clock.time(Stage::kBroadPhase);
    if (!broad_phase(solid, query.burr.capsule, query.world_from_tool, reach_m, scratch)) {
      result.faults |= kFaultContactsFull;
    }
    result.leaves = static_cast<std::uint32_t>(scratch.leaves.size());
  }
  std::optional<ContactForce> force(std::in_place, solid, query.burr, query.world_from_tool,
                                    scaling, query.asked);
  if (!find_in_blocks(solid, query, reach_m, kept, scratch, result, *force)) {
    find_deepest(solid, query, reach_m, kept, scratch, result);
    force.emplace(solid, query.burr, query.world_from_tool, scaling, query.asked);
  }
  const auto timed = scratch.clock.time(Stage::kContactForce);
  force->sum(query.tissues, query.twist, scratch.contacts, result);
  return result;
}

ContactResult evaluate_contact(const Body& body, const ContactQuery& query,
                               ContactScratch& scratch) noexcept {
  ContactQuery own{query.burr,
                   body.grid_from(query.world_from_tool),
                   query.tissues.subspan(body.first_tissue),
                   query.settings,
                   body.removal ? query.twist : nullptr,
                   query.asked};
  const KeptNormals* const kept = body.kept ? &*body.kept : nullptr;
  if (body.is_in_world()) return evaluate_contact(body.solid, own, scratch, kept);
  const Pose& place = body.world_from_grid;
  Twist twist;
  if (own.twist) {
    twist = {place.inverse_direction(query.twist->linear_m_per_s),
             place.inverse_direction(query.twist->angular_rad_per_s),
             query.twist->spindle_rad_per_s};
    own.twist = &twist;
  }
  ContactResult result = evaluate_contact(body.solid, own, scratch, kept);
  result.wrench = in_world(result.wrench, place);
  result.tangential = in_world(result.tangential, place);
  if (query.asked != Asked::kForce) result.stiffness = in_world(result.stiffness, place);
  return result;
}

}  // namespace sulcus
