#include "haptics/contact/evaluate_contact.hpp"

#include <algorithm>

#include "engine/core/fault.hpp"
#include "haptics/contact/broad_phase.hpp"
#include "haptics/contact/contact_force.hpp"
#include "haptics/contact/covered_faces.hpp"
#include "haptics/contact/far_fills.hpp"
#include "haptics/contact/narrow_phase.hpp"
#include "haptics/contact/normals.hpp"

namespace sulcus {

namespace {

/// Which contacts a solid has, up to their depths; `drop_covered(first)` takes out of those from
/// `first` on what is no surface; none is beside it where it is `alone`.
template <class DropCovered>
MeasureSums find_contacts(const Workpiece& solid, const ContactQuery& query,
                          ContactScratch& scratch, const NormalCache* cache,
                          const DropCovered& drop_covered, bool alone,
                          ContactResult& result) noexcept {
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
  ContactForce force(solid, query);
  // Behind a coupling normals beside the burr count, too; beside a body surfaces are cut off.
  const bool drops_far = solid.has_fills() && alone && query.outputs != Outputs::kCoupling;
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
      if (drops_far) drop_far_fills(solid, first, scratch);
      normals(solid, query.settings, cache, scratch, first);
      drop_covered(first);
    }
    const auto timed = clock.time(Stage::kContactForce);
    if (more) force.measure(scratch);
  }
  const auto timed = clock.time(Stage::kContactForce);
  result.tested = phase.tested();
  const MeasureSums sums = force.measured(scratch);
  result.contacts = sums.counted;
  result.deepest_m = sums.deepest_m;
  return sums;
}

/// A quantity of the grid's space in world axes, and back.
Wrench in_world(const Wrench& wrench, const Pose& world_from_grid) {
  return {world_from_grid.direction(wrench.force_N), world_from_grid.direction(wrench.torque_Nm)};
}
NormalSpread turned(const NormalSpread& spread, const Eigen::Matrix3d& turn) {
  NormalSpread to{spread.weight, {}, {}};
  Eigen::Map<Eigen::Vector3d>(to.normal) = turn * Eigen::Map<const Eigen::Vector3d>(spread.normal);
  Eigen::Matrix3d products;
  for (int a = 0, entry = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) products(a, b) = products(b, a) = spread.products[entry++];
  }
  products = turn * products * turn.transpose();
  for (int a = 0, entry = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) to.products[entry++] = products(a, b);
  }
  return to;
}
void turn_to_world(const Pose& world_from_grid, ContactResult& result) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = world_from_grid.orientation.toRotationMatrix();
  turn.bottomRightCorner<3, 3>() = turn.topLeftCorner<3, 3>();
  result.wrench = in_world(result.wrench, world_from_grid);
  result.tangential = in_world(result.tangential, world_from_grid);
  result.stiffness = turn * result.stiffness * turn.transpose();
  result.weight_growth = turn * result.weight_growth;
}

void add(const MeasureSums& sums, MeasureSums& to) {
  to.weights += sums.weights;
  to.energy += sums.energy;
  to.counted += sums.counted;
  to.deepest_m = std::max(to.deepest_m, sums.deepest_m);
  to.spread.weight += sums.spread.weight;
  for (int a = 0; a < 3; ++a) to.spread.normal[a] += sums.spread.normal[a];
  for (int entry = 0; entry < 6; ++entry) to.spread.products[entry] += sums.spread.products[entry];
}

/// A query in the space of a body's grid.
struct LocalQuery {
  LocalQuery(const Body& body, const ContactQuery& world) : query(in_grid(body, world)) {
    if (!query.twist || body.is_in_world()) return;
    const Pose& place = body.world_from_grid;
    twist = {place.inverse_direction(world.twist->linear_m_per_s),
             place.inverse_direction(world.twist->angular_rad_per_s),
             world.twist->spindle_rad_per_s};
    query.twist = &twist;
  }
  LocalQuery(const LocalQuery&) = delete;

  static ContactQuery in_grid(const Body& body, const ContactQuery& world) {
    return {world.burr,
            body.grid_from(world.world_from_tool),
            world.tissues.subspan(body.first_tissue),
            world.settings,
            body.removal ? world.twist : nullptr,
            world.outputs};
  }

  ContactQuery query;
  Twist twist;
};

}  // namespace

ContactResult evaluate_contact(const Workpiece& solid, const ContactQuery& query,
                               ContactScratch& scratch, const NormalCache* cache) noexcept {
  ContactResult result;
  const MeasureSums all = find_contacts(
      solid, query, scratch, cache, [](std::size_t) {}, true, result);
  const auto timed = scratch.clock.time(Stage::kContactForce);
  ContactForce(solid, query).sum(all, scratch, result);
  if (query.outputs != Outputs::kForce) {
    add_weight_derivative(query.settings.scaling, all, result);
  }
  result.energy_J = energy_J(query.settings.scaling, all);
  return result;
}

ContactResult evaluate_contact(std::span<const NearBody> near, const ContactQuery& query) noexcept {
  MeasureSums all;
  for (const NearBody& at : near) {
    const Body& body = *at.body;
    const LocalQuery local(body, query);
    *at.result = {};
    MeasureSums sums = find_contacts(
        body.solid, local.query, *at.scratch, body.normal_cache ? &*body.normal_cache : nullptr,
        [&](std::size_t first) { drop_covered(body, near, first, *at.scratch); }, near.size() < 2,
        *at.result);
    if (!body.is_in_world()) {
      sums.spread = turned(sums.spread, body.world_from_grid.orientation.toRotationMatrix());
    }
    add(sums, all);
  }
  ContactResult result;
  for (const NearBody& at : near) {
    const Body& body = *at.body;
    const auto timed = at.scratch->clock.time(Stage::kContactForce);
    const LocalQuery local(body, query);
    const ContactForce force(body.solid, local.query);
    if (body.is_in_world()) {
      force.sum(all, *at.scratch, *at.result);
    } else {
      MeasureSums here = all;
      here.spread =
          turned(all.spread, body.world_from_grid.orientation.toRotationMatrix().transpose());
      force.sum(here, *at.scratch, *at.result);
      turn_to_world(body.world_from_grid, *at.result);
    }
    result += *at.result;
  }
  if (query.outputs != Outputs::kForce) {
    add_weight_derivative(query.settings.scaling, all, result);
  }
  result.energy_J = energy_J(query.settings.scaling, all);
  return result;
}

}  // namespace sulcus
