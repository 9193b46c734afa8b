#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// The 64 patterns of the six neighbours [Kim and Park 2019, IV-C and IV-D]. Bits of a pattern, as
/// in its PDP: an exposed face at -x, +x, -y, +y, -z, +z.
///
/// Direction of projection of a pattern: exposed faces less the opposing pairs, components -1, 0 or
/// 1. 26 directions remain. 37 patterns hold an opposing pair (the paper counts 38); 8 cancel to
/// nothing, 7 of them with exposed faces: zero, for which the paper has no rule.
const std::array<Eigen::Vector3i, 64>& projection_directions();

/// PDP of a solid voxel.
std::uint8_t exposed_faces(const Workpiece& workpiece, const Cell& c) noexcept;

}  // namespace sulcus
