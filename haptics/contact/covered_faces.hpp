#pragma once

#include <span>

#include "haptics/contact/evaluate_contact.hpp"

namespace sulcus {

/// Of the contacts of a body from `first` on, takes out those whose empty sides all lie in the
/// solid of another body that is near: where two bodies meet there is no surface. One with an open
/// side left gets that side's normal, where the body's own points into the other solid; and where
/// it is far from that, a point half a voxel out. What the burr touches of two halves of a solid is
/// then what it touches of the whole, but for the fit of normals on slopes within a voxel of the
/// seam. Costs nothing with one body near.
void drop_covered(const Body& body, std::span<const NearBody> near, std::size_t first,
                  ContactScratch& scratch) noexcept;

}  // namespace sulcus
