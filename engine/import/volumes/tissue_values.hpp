#pragma once

#include <cstdint>

#include "engine/import/volumes/lattice.hpp"

namespace sulcus {

/// Depth in lattice steps down to which partial volume has mixed the solid's grey values with the
/// air's: two to three voxels in CT.
inline constexpr float kPartialVolumeDepth = 2.5f;

/// Grey values by which tissues can be told, out of `grey` on the same lattice as `solid`.
///
/// At a surface a scanner mixes solid and air, so that enamel goes through dentine's grey values on
/// its way out, and thresholds alone put a shell of dentine around the crown. No tissue is darker
/// at the surface than a little under it for another reason, so a point less deep than
/// kPartialVolumeDepth takes the greatest value on the way up the gradient of depth, from itself to
/// that depth. Empty points within reach of the surface take the value from under it, so that an
/// interpolation at the surface reads tissue on both sides. Deeper points keep their own.
Lattice<float> tissue_values(const Lattice<float>& grey, const Lattice<std::uint8_t>& solid);

}  // namespace sulcus
