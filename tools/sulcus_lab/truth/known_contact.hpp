#pragma once

#include "haptics/contact/broad_phase.hpp"
#include "haptics/contact/contact_force.hpp"
#include "haptics/contact/evaluate_contact.hpp"
#include "haptics/contact/narrow_phase.hpp"

namespace sulcus::lab {

/// evaluate_contact with a surface that is known in place of a method: `surface(cell)` gives the
/// `normal` there, unit and outward, and its `offset_m` from the voxel's centre along that. Voxels
/// nearer to the burr than `reach_m` take part; the settings' capacity holds them.
template <class Surface>
ContactResult evaluate_known(const Workpiece& solid, const ContactQuery& query, double reach_m,
                             ContactScratch& scratch, const Surface& surface) {
  ContactResult result;
  broad_phase(solid, query.burr.capsule, query.world_from_tool, reach_m, scratch);
  NarrowPhase phase(solid, query.burr.field, query.world_from_tool, reach_m, scratch);
  ContactForce force(solid, query);
  for (bool more = true; more;) {
    const std::size_t first = scratch.contacts.size();
    more = phase.next();
    for (std::size_t i = first; i < scratch.contacts.size(); ++i) {
      const auto known = surface(cell_of_key(scratch.contacts.keys()[i]));
      scratch.contacts.set_vector(Contacts::kNormal, i, known.normal);
      scratch.block(ContactBlock::kOffset)[i - scratch.block.first()] = known.offset_m;
    }
    force.measure(scratch);
  }
  const MeasureSums all = force.measured(scratch);
  result.contacts = all.counted;
  force.sum(all, scratch, result);
  if (query.outputs != Outputs::kForce) add_weight_derivative(query.settings.scaling, all, result);
  return result;
}

}  // namespace sulcus::lab
