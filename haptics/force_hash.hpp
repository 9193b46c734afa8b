#pragma once

#include <cstdint>

#include "engine/core/hash.hpp"

namespace sulcus {

/// Hash over the forces and torques that were sent, tick after tick: `before` is that of the ticks
/// before, 0 at first. What `force_hash` of a summary is.
inline std::uint64_t force_hash_after(std::uint64_t before, const double (&force_N)[3],
                                      const double (&torque_Nm)[3]) noexcept {
  return hash_bytes(torque_Nm, sizeof torque_Nm, hash_bytes(force_N, sizeof force_N, before));
}

}  // namespace sulcus
