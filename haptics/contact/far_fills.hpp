#pragma once

#include <cstddef>

#include "engine/volume/workpiece.hpp"
#include "haptics/contact/contact.hpp"

namespace sulcus {

/// Takes out of the contacts from `first` on those of part-filled voxels whose surfaces cannot lie
/// in the burr, by their own columns (farthest_surface): normals cost most of a tick. Changes no
/// force where only points in the burr count. Needs fractions.
void drop_far_fills(const Workpiece& workpiece, std::size_t first,
                    ContactScratch& scratch) noexcept;

/// Moves contact `from` to `to`, with what the stages up to the normals know of it.
void move_contact(ContactScratch& scratch, std::size_t from, std::size_t to) noexcept;

}  // namespace sulcus
