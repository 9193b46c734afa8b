#pragma once

#include <span>

#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/body.hpp"
#include "haptics/contact/contact.hpp"
#include "haptics/contact/normal_cache.hpp"

namespace sulcus {

/// What an evaluation of the contact is of. The referred objects outlive it.
struct ContactQuery {
  const Burr& burr;
  Pose world_from_tool;
  std::span<const TissueSettings> tissues;  // the scene's, by label
  const HapticsSettings& settings;
  const Twist* twist = nullptr;  // the tool's motion, for the tangential forces of cutting; or none
  Outputs outputs = Outputs::kForce;
};

/// The contact of the burr with a solid, both in the space of its grid: contacts (in `scratch`),
/// wrench and, where it is asked for, stiffness. Broad phase, narrow phase, normals, forces.
/// Changes no state and no result by being called, so a coupling may call it any number of times in
/// a tick; cutting happens once, after it. `cache` is read only, and may be null. Does not
/// allocate. Contacts go through the stages block by block; beyond the capacity the deepest count,
/// and kFaultContactsFull is set.
ContactResult evaluate_contact(const Workpiece& solid, const ContactQuery& query,
                               ContactScratch& scratch,
                               const NormalCache* cache = nullptr) noexcept;

/// With a body, in world axes. One that cannot be cut gets no tangential force. Forces are those of
/// a body by itself: under `count` and `smooth` a contact's stiffness is its share of this body's
/// contacts, so that two bodies hold as two.
ContactResult evaluate_contact(const Body& body, const ContactQuery& query,
                               ContactScratch& scratch) noexcept;

}  // namespace sulcus
