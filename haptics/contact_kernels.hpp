#pragma once

#include <cstddef>
#include <cstdint>

#include "haptics/contact_frame.hpp"
#include "haptics/contacts.hpp"
#include "haptics/edge_gain.hpp"

namespace sulcus {

/// The arrays of Contacts, as the kernels see them.
struct ContactArrays {
  std::size_t size = 0;
  const std::uint32_t* keys = nullptr;
  const std::uint8_t* tissues = nullptr;
  float* of[Contacts::kQuantities]{};
};

ContactArrays arrays_of(Contacts& contacts) noexcept;

/// How a contact's depth and weight are measured.
struct ForceSettings {
  bool at_surface = false;  // depth at the fitted surface point, and weights: Scaling::kSmooth
  float fade_below = 0.0f;  // cosine between the normal and the tool's
  // Distance from the burr within which normals count for the spread; 0: it is not wanted. Only
  // with `at_surface`.
  float spread_reach_m = 0.0f;
};

struct MeasureSums {
  double weights = 0.0;
  std::uint32_t counted = 0;  // contacts with weight
  NormalSpread spread;
};

/// What every contact's force needs, and the tool's motion, single precision, world.
struct ForceTerms {
  const float* stiffness_N_per_m = nullptr;  // by label, already divided by the scaling's divisor
  bool cutting = false, with_stiffness = false;
  float axis_m[3]{};   // from the torque reference back to the tip: arms about the tip are longer
  float linear[3]{};   // velocity of the tip, m/s
  float turning[3]{};  // rad/s, spindle and handpiece
  float tangential_ratio = 0.0f, slow_edge_m_per_s = 0.0f;
};

/// Sums over all contacts. What is not asked for stays zero: the stiffness, and without cutting the
/// tangential part.
struct ForceSums {
  double wrench[6]{};      // force, torque
  double stiffness[21]{};  // upper triangle, row by row
  double weights[6]{};     // sum of w / d (N, arm x N): how the sum of weights grows against motion
  double tangential[6]{};  // the part of the wrench that drags along the surface
};

/// The inner loops of a tick over voxels in contact, in one instruction set. All give the same
/// bits: eight lanes, one order of operations. Pure, no allocation. Counts are rounded up to whole
/// groups of eight.
struct ContactKernels {
  const char* name;

  /// Of `count` voxels those whose centres are nearer to the burr than `reach_m`, in the same
  /// order: keys, distances, and minus the gradient there, world, of any length [Kim and Park 2019,
  /// III-A]. The keys are read in whole groups; where they go there is room for all and eight more.
  /// Returns how many.
  std::size_t (*find_near)(const ContactFrame& frame, const std::uint32_t* keys, std::size_t count,
                           float reach_m, std::uint32_t* to_keys, float* to_distance_m,
                           float* const to_outward[3]) noexcept;

  /// Bounds from below on the distances at the centres of leaves, the keys of whose first voxels
  /// are given: what a leaf may be passed over by.
  void (*leaf_distances)(const ContactFrame& frame, const std::uint32_t* keys, std::size_t count,
                         float* distance_m) noexcept;

  /// Arm, depth and weight of every contact, and a normal for those without. Where the spread is
  /// wanted, the outward direction becomes that of the tool where depth is measured, unit.
  MeasureSums (*measure)(const ContactFrame& frame, const ForceSettings& settings,
                         const ContactArrays& contacts) noexcept;

  /// Turns every normal N towards the tool's outward direction g: N + gain (g - N), unit. `gain`:
  /// symmetric, xx, xy, xz, yy, yz, zz.
  void (*turn)(const float (&gain)[6], const ContactArrays& contacts) noexcept;

  /// Normal force and power of every contact, and the sums.
  void (*forces)(const ForceTerms& terms, const ContactArrays& contacts, ForceSums& sums) noexcept;
};

const ContactKernels& plain_contact_kernels() noexcept;
/// Null where the processor or the build has none.
const ContactKernels* avx2_contact_kernels() noexcept;
/// The fastest that this processor runs, found once.
const ContactKernels& contact_kernels() noexcept;

}  // namespace sulcus
