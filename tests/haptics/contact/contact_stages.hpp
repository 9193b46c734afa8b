#pragma once

#include <vector>

#include "haptics/contact/broad_phase.hpp"
#include "haptics/contact/contact_force.hpp"
#include "haptics/contact/narrow_phase.hpp"
#include "tests/support/tools.hpp"

// The stages of an evaluation by themselves, over all blocks.

namespace sulcus::test {

/// A contact as the narrow phase finds it.
struct FoundContact {
  Cell cell;
  float distance_m;
  std::uint32_t key() const { return voxel_key(cell); }
};

struct Found {
  std::vector<FoundContact> contacts;
  std::uint32_t tested = 0;
};

/// Those beyond the scratch's capacity too, or only the deepest.
inline Found collide(const Workpiece& workpiece, const Burr& burr, const Pose& pose, double reach_m,
                     ContactScratch& scratch, bool deepest = false) {
  Found found;
  broad_phase(workpiece, burr.capsule, pose, reach_m, scratch);
  NarrowPhase phase(workpiece, burr.field, pose, reach_m, scratch);
  if (deepest) phase.begin_with_deepest();
  for (bool more = true; more;) {
    scratch.contacts.clear();
    more = phase.next();
    for (std::size_t i = 0; i < scratch.contacts.size(); ++i) {
      found.contacts.push_back(
          {cell_of_key(scratch.contacts.keys()[i]), scratch.block(ContactBlock::kDistance)[i]});
    }
  }
  found.tested = phase.tested();
  return found;
}

/// A contact by itself: `distance_m` of its centre to the burr, whose gradient there is minus
/// `outward`.
inline void add_contact(ContactScratch& scratch, const Contact& contact, float distance_m,
                        const Eigen::Vector3f& outward = Eigen::Vector3f::Zero(),
                        float offset_m = 0.0f) {
  const std::size_t i = scratch.contacts.size();
  scratch.contacts.push_back(contact);
  scratch.block.set_end(i + 1);
  scratch.block(ContactBlock::kDistance)[i] = distance_m;
  scratch.block.set_vector(ContactBlock::kOutward, i, outward);
  scratch.block(ContactBlock::kOffset)[i] = offset_m;
}

/// Forces of contacts whose normals and offsets `surface(cell)` names, in voxels.
template <class Surface>
ContactResult force_of(const Workpiece& workpiece, const Burr& burr, const Pose& pose,
                       double reach_m, Scaling scaling, Outputs outputs, ContactScratch& scratch,
                       const Surface& surface) {
  ContactResult result;
  const std::vector<TissueSettings> tissues = one_tissue();
  broad_phase(workpiece, burr.capsule, pose, reach_m, scratch);
  NarrowPhase phase(workpiece, burr.field, pose, reach_m, scratch);
  HapticsSettings settings;
  settings.scaling = scaling;
  const ContactQuery query{burr, pose, tissues, settings, nullptr, outputs};
  ContactForce force(workpiece, query);
  for (bool more = true; more;) {
    const std::size_t first = scratch.contacts.size();
    more = phase.next();
    for (std::size_t i = first; i < scratch.contacts.size(); ++i) {
      const auto [normal, offset] = surface(cell_of_key(scratch.contacts.keys()[i]));
      scratch.contacts.set_vector(Contacts::kNormal, i, normal);
      scratch.block(ContactBlock::kOffset)[i - scratch.block.first()] =
          offset * static_cast<float>(workpiece.grid().voxel_m);
    }
    force.measure(scratch);
  }
  const MeasureSums all = force.measured(scratch);
  result.contacts = all.counted;
  force.sum(all, scratch, result);
  if (outputs != Outputs::kForce) add_weight_derivative(scaling, all, result);
  return result;
}

}  // namespace sulcus::test
