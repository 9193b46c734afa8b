#pragma once

#include "engine/volume/workpiece.hpp"
#include "haptics/contact.hpp"
#include "haptics/kept_normals.hpp"

namespace sulcus {

/// Normal and surface offset of every contact by the scene's method (engine/normals), which is told
/// the burr's distance gradient at the voxel: what is kept where it stands, else found now, in the
/// tier that the state says (KeptNormals). `kept` may be null: nothing is kept, and every normal is
/// of the scene's method. What is undefined stays zero; contact_force takes the gradient itself
/// there. What was found is left in the scratch for `keep_normals`, which goes with `kept`: without
/// it the tool has had its say in it.
///
/// Of contacts from `first` on alone; adds to what was found for those before.
void normals(const Workpiece& workpiece, const HapticsSettings& settings, const KeptNormals* kept,
             ContactScratch& scratch, std::size_t first) noexcept;

/// Keeps what an evaluation has found, so that the next in the same tick does not find it again.
/// Changes no result: the workpiece stays as it is until the contact is done with.
void keep_found(const HapticsSettings& settings, std::uint64_t tick, const ContactScratch& scratch,
                KeptNormals& kept) noexcept;

/// After the contact has been evaluated, once a tick and before anything is cut: keeps what was
/// found, and refines up to `settings.refine_per_tick` normals from ldm_fast to ldm, in the order
/// of the contacts. The forces of this tick are not changed.
void keep_normals(const Workpiece& workpiece, const HapticsSettings& settings, std::uint64_t tick,
                  ContactScratch& scratch, KeptNormals& kept) noexcept;

}  // namespace sulcus
