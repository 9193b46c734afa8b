#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/core/instruction_set.hpp"
#include "engine/volume/leaf_bits.hpp"
#include "haptics/contact/contact_frame.hpp"
#include "haptics/contact/contacts.hpp"
#include "haptics/contact/edge_gain.hpp"

namespace sulcus {

/// The arrays of Contacts, as the kernels see them.
struct ContactArrays {
  std::size_t size = 0;
  const std::uint32_t* keys = nullptr;
  const std::uint8_t* tissues = nullptr;
  float* of[Contacts::kQuantities]{};
};

/// Those of ContactBlock.
struct BlockArrays {
  float* of[ContactBlock::kQuantities]{};
};

/// From contact `first` on.
ContactArrays arrays_of(Contacts& contacts, std::size_t first = 0) noexcept;
BlockArrays arrays_of(ContactBlock& block, std::size_t first) noexcept;

/// So many contacts are looked up at a time where their normals are kept.
inline constexpr std::size_t kCachedBlock = 64;

/// How a contact's depth and weight are measured.
struct ForceSettings {
  bool at_surface = false;    // depth at the fitted surface point: Scaling::kSmooth, and fractions
  bool weighs_depth = false;  // weights by depth: Scaling::kSmooth; only with `at_surface`
  float fade_below = 0.0f;    // cosine between the normal and the tool's
  // Distance from the burr within which normals count for the spread; 0: it is not wanted. Only
  // with `at_surface`.
  float spread_reach_m = 0.0f;
  bool potential = false;                    // by potential.hpp instead of all this
  const float* stiffness_N_per_m = nullptr;  // by label; only of a potential
};

/// What `measure` adds up, in eight lanes; of whole groups, so that what is added in several calls
/// is what one gives.
struct MeasureLanes {
  using Lanes8 = double[8];
  alignas(64) Lanes8 weights{}, energy{}, near{}, normal[3]{}, products[6]{};
  std::uint32_t counted = 0;
  float deepest_m = 0.0f;
};

struct MeasureSums {
  double weights = 0.0;
  double energy = 0.0;        // of a potential: sum of K w d^2, J
  std::uint32_t counted = 0;  // contacts with weight
  float deepest_m = 0.0f;     // of them
  NormalSpread spread;
};

/// What every contact's force needs, and the tool's motion, single precision, world.
struct ForceTerms {
  const float* stiffness_N_per_m = nullptr;  // by label, already divided by the scaling's divisor
  bool cutting = false, with_stiffness = false;
  float axis_m[3]{};   // from the torque reference back to the tip: arms about the tip are longer
  float linear[3]{};   // velocity of the tip, m/s
  float turning[3]{};  // rad/s, spindle and handpiece
  float tangential_ratio = 0.0f, friction_speed_m_per_s = 0.0f;
  // Every normal N is turned towards the tool's outward direction g first: N + gain (g - N), unit.
  // Symmetric: xx, xy, xz, yy, yz, zz. Arms stay where depth was measured.
  bool blend_normals = false;
  float edge_blend[6]{};
  // By potential.hpp: the divisor is that of kShareOfForce; p U / W, J.
  bool potential = false;
  float push_per_weight = 0.0f;
};

/// Sums over all contacts. What is not asked for stays zero: the stiffness, and without cutting the
/// tangential part.
struct ForceSums {
  double wrench[6]{};      // force, torque
  double stiffness[21]{};  // upper triangle, row by row
  double weights[6]{};     // sum of w / d (N, arm x N): how the sum of weights grows against motion
                           // (of a potential a p-th of that, and the tool's direction for N)
  double tangential[6]{};  // the part of the wrench that drags along the surface
};

MeasureSums sums_of(const MeasureLanes& lanes) noexcept;

/// The inner loops of a tick over voxels in contact, in one instruction set. All give the same
/// bits: one order of operations, sums in eight lanes. Pure, no allocation. Counts are rounded up
/// to whole groups (Contacts::kGroup).
struct ContactKernels {
  const char* name;

  /// Keys of a leaf's voxels, in order, from its first one's. Where they go there is room for a
  /// group more. Returns how many.
  std::size_t (*leaf_keys)(const LeafBits& voxels, std::uint32_t first_key,
                           std::uint32_t* keys) noexcept;

  /// Of `count` voxels those whose centres are nearer to the burr than `reach_m`, in the same
  /// order: keys, distances, and minus the gradient there, world, of any length [Kim and Park 2019,
  /// III-A]. The keys are read in whole groups; where they go there is room for all and a group
  /// more. Returns how many.
  std::size_t (*find_near)(const ContactFrame& frame, const std::uint32_t* keys, std::size_t count,
                           float reach_m, std::uint32_t* to_keys, float* to_distance_m,
                           float* const to_outward[3]) noexcept;

  /// Bounds from below on the distances at the centres of leaves, the keys of whose first voxels
  /// are given: by them leaves are skipped.
  void (*leaf_distances)(const ContactFrame& frame, const std::uint32_t* keys, std::size_t count,
                         float* distance_m) noexcept;

  /// Normals and offsets of up to kCachedBlock contacts from `first` on, from where each one's are
  /// kept: four numbers, the offset in voxels, all zero for none. In whole groups. Returns a bit
  /// for each whose normal points away from the tool's outward direction.
  std::uint64_t (*take_cached)(const float* const (&kept)[kCachedBlock], std::size_t count,
                               float voxel_m, const ContactArrays& contacts,
                               const BlockArrays& block, std::size_t first) noexcept;

  /// Where depth is measured, depth and weight of every contact, and a normal for those without.
  /// Where the spread is wanted, what forces may turn to as well.
  void (*measure)(const ContactFrame& frame, const ForceSettings& settings,
                  const ContactArrays& contacts, const BlockArrays& block,
                  MeasureLanes& lanes) noexcept;

  /// Normal force of every contact, its power where the tool cuts, its normal where that turns;
  /// and the sums. The frame is that of `measure`.
  void (*forces)(const ContactFrame& frame, const ForceTerms& terms, const ContactArrays& contacts,
                 ForceSums& sums) noexcept;
};

/// Compiled for a set; null where the processor or the build has none.
const ContactKernels* contact_kernels_of(InstructionSet set) noexcept;
/// Those of `instruction_set()`, found once.
const ContactKernels& contact_kernels() noexcept;

/// Where each set's are; null where the build has none.
const ContactKernels* avx2_contact_kernels() noexcept;
const ContactKernels* avx512_contact_kernels() noexcept;

}  // namespace sulcus
