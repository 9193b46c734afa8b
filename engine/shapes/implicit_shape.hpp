#pragma once

#include <bit>
#include <concepts>
#include <cstdint>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace sulcus {

/// The parts of a built-in shape; a scene maps them to its own tissues by name.
enum class Part : std::uint8_t { kEnamel, kDentine, kPulp, kCaries };
inline constexpr int kPartCount = 4;

/// Those of the parts that a region may be of.
class PartSet {
 public:
  static constexpr PartSet all() { return PartSet((1u << kPartCount) - 1u); }
  static constexpr PartSet only(Part part) { return PartSet(bit(part)); }

  constexpr bool has(Part part) const { return (bits_ & bit(part)) != 0; }
  constexpr PartSet without(Part part) const { return PartSet(bits_ & ~bit(part)); }
  /// Lowest of those that it has; it must have one.
  constexpr Part first() const { return static_cast<Part>(std::countr_zero(bits_)); }
  constexpr bool operator==(const PartSet&) const = default;

 private:
  explicit constexpr PartSet(unsigned bits) : bits_(bits) {}
  static constexpr unsigned bit(Part part) { return 1u << static_cast<unsigned>(part); }

  unsigned bits_;
};

/// A solid given by an implicit function, in metres, so that the truth about its surface is known.
/// - value: negative inside, zero on the surface; |value(p) - value(q)| <= lipschitz() |p - q|.
/// - gradient: of value, analytic; along the outward normal on the surface.
/// - parts_within: those of the parts `among` that solid points no further than `radius` from p may
///   be of; one at least. Of radius 0 it is the one of p itself, for p inside. `among` is what a
///   ball around this one has left: what that rules out is not looked at again.
/// All are pure and may be called from any thread.
template <class S>
concept ImplicitShape = requires(const S& shape, const Eigen::Vector3d& p, double radius,
                                 PartSet among) {
  { shape.value(p) } -> std::convertible_to<double>;
  { shape.gradient(p) } -> std::convertible_to<Eigen::Vector3d>;
  { shape.lipschitz() } -> std::convertible_to<double>;
  { shape.parts_within(p, radius, among) } -> std::same_as<PartSet>;
  { shape.bounds() } -> std::convertible_to<Eigen::AlignedBox3d>;
};

}  // namespace sulcus
