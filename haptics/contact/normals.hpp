#pragma once

#include "engine/volume/workpiece.hpp"
#include "haptics/contact/contact.hpp"
#include "haptics/contact/normal_cache.hpp"

namespace sulcus {

/// Normal and surface offset of the contacts from `first` on, by the scene's method
/// (engine/normals), with the tool hint at each voxel: the cached normal, or else a new one. What
/// is undefined stays zero; there contact_force takes the hint itself. Adds what it finds to what
/// was found for the contacts before. A normal depends on the solid and on the hint alone: with a
/// cache and without it they are the same bits (a test).
///
/// New estimates stay in the scratch for keep_normals. Without a cache (null) they already have the
/// tool's veto: they must not be cached.
void normals(const Workpiece& workpiece, const HapticsSettings& settings, const NormalCache* cache,
             ContactScratch& scratch, std::size_t first) noexcept;

/// Caches what an evaluation has found, for the next one in the same tick. Changes no result: the
/// workpiece stays as it is until the tick's last evaluation.
void keep_found(const HapticsSettings& settings, std::uint64_t tick, const ContactScratch& scratch,
                NormalCache& cache) noexcept;

/// Once a tick, after its last evaluation and before anything is cut: caches what was found, and
/// notes which leaves were in contact.
void keep_normals(const HapticsSettings& settings, std::uint64_t tick,
                  const ContactScratch& scratch, NormalCache& cache) noexcept;

}  // namespace sulcus
