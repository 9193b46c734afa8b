#pragma once

#include <span>

#include "engine/volume/workpiece.hpp"
#include "haptics/body.hpp"
#include "haptics/contact/contact.hpp"
#include "haptics/contact/normal_cache.hpp"

namespace sulcus {

/// The contact of the burr with a solid, both in the space of its grid: contacts (in `scratch`),
/// wrench and, where it is asked for, stiffness. Broad phase, narrow phase, normals, forces.
/// Changes no state and no result by being called, so a coupling may call it any number of times in
/// a tick; cutting happens once, after it. `cache` is read only, and may be null. Does not
/// allocate. Contacts go through the stages block by block; beyond the capacity the deepest count,
/// and kFaultContactsFull is set.
ContactResult evaluate_contact(const Workpiece& solid, const ContactQuery& query,
                               ContactScratch& scratch,
                               const NormalCache* cache = nullptr) noexcept;

/// A body that the burr may touch, memory for its contact, and, set by the evaluation, what it does
/// to the tool; world axes.
struct NearBody {
  const Body* body = nullptr;
  ContactScratch* scratch = nullptr;
  ContactResult* result = nullptr;
};

/// With bodies, in world axes. One that cannot be cut gets no tangential force. Their contacts are
/// those of one solid: one sum divides the stiffness of all, and a face that lies on another one of
/// them is no surface. Tissues of a query: those of the scene.
ContactResult evaluate_contact(std::span<const NearBody> near, const ContactQuery& query) noexcept;

}  // namespace sulcus
