#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/assessment/ray_stack.hpp"

namespace sulcus {

/// Of each ray of a lattice: whether it is in a set.
using RayMask = std::vector<char>;

/// From each ray to the nearest of the set, mm, by their centres, exactly; infinite where the set
/// is empty [Felzenszwalb and Huttenlocher 2012].
std::vector<double> distances_to(const RayMask& set, const RayLattice& lattice);

/// The rays of the set that a disc of this radius within the set can cover: what is narrower goes.
RayMask opened(const RayMask& set, double radius_mm, const RayLattice& lattice);

/// A part of a set that hangs together by its sides, by places.
using RayComponent = std::vector<std::size_t>;
/// Those of at least so many rays, the largest first.
std::vector<RayComponent> components(const RayMask& set, std::size_t least,
                                     const RayLattice& lattice);

}  // namespace sulcus
