#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace sulcus {

/// Cuts a polygon into triangles of its corners by clipping ears [Meisters 1975]: one less than two
/// of its corners, turned as it is, so that what shares its edges still does. Right for every
/// simple polygon that is nearly plane, concave ones as well; a convex one becomes a fan. One that
/// crosses itself is cut all the same, somehow.
/// At most the square of the corners in time. `polygon`: indices of at least 3 different positions.
void cut_polygon(const std::vector<Eigen::Vector3f>& positions,
                 std::span<const std::uint32_t> polygon,
                 std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace sulcus
