#pragma once

#include <concepts>
#include <cstdint>
#include <limits>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sulcus {

/// The parts of a built-in shape; a scene maps them to its own tissues by name.
enum class Part : std::uint8_t { kEnamel, kDentine, kPulp, kCaries };

/// A solid given by an implicit function, in metres, so that the truth about its surface is known.
/// - value: negative inside, zero on the surface; |value(p) - value(q)| <= lipschitz() |p - q|.
/// - gradient: of value, analytic; along the outward normal on the surface.
/// - part: what p is made of, for p inside.
/// - part_margin: a lower bound of the distance from p to where `part` changes (inside the solid);
///   0 where nothing is known, infinite for a solid of one part.
/// All are pure and may be called from any thread.
template <class S>
concept ImplicitShape = requires(const S& shape, const Eigen::Vector3d& p) {
  { shape.value(p) } -> std::convertible_to<double>;
  { shape.gradient(p) } -> std::convertible_to<Eigen::Vector3d>;
  { shape.lipschitz() } -> std::convertible_to<double>;
  { shape.part(p) } -> std::same_as<Part>;
  { shape.part_margin(p) } -> std::convertible_to<double>;
  { shape.bounds() } -> std::convertible_to<Eigen::AlignedBox3d>;
};

}  // namespace sulcus
