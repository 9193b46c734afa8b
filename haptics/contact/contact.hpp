#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/core/pose.hpp"
#include "engine/normals/normal_method.hpp"
#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"
#include "haptics/contact/contacts.hpp"
#include "haptics/contact/normal_cache.hpp"
#include "haptics/stage_clock.hpp"

namespace sulcus {

/// Force and torque on the tool, world axes, torque about the burr's reference point.
struct Wrench {
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_Nm = Eigen::Vector3d::Zero();
};

/// Velocity of the burr's tip and turning of the handpiece, world; on top of it the spindle, about
/// the burr's axis from tip to shank.
struct Twist {
  Eigen::Vector3d linear_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_rad_per_s = Eigen::Vector3d::Zero();
  double spindle_rad_per_s = 0.0;
};

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// What one evaluation of the contact found. The contacts are in the scratch it was given.
struct ContactResult {
  Wrench wrench;      // normal and tangential part
  Wrench tangential;  // that part alone; zero without cutting
  /// -d(wrench)/d(translation, rotation), normals, arms and count held; under `smooth` and
  /// `potential` with the weights' derivatives, under `potential` with how directions turn, and
  /// then not always positive.
  Matrix6d stiffness = Matrix6d::Zero();
  /// How the sum of weights grows against a motion, where it divides; zero elsewhere.
  Vector6d weight_growth = Vector6d::Zero();
  double energy_J = 0.0;       // of the contact, under `potential`
  float deepest_m = 0.0f;      // depth of a contact, at most
  std::uint32_t contacts = 0;  // voxels that take part in the force
  std::uint32_t tested = 0;    // voxels whose distance was asked for
  std::uint32_t leaves = 0;    // leaves that the capsule reaches
  std::uint32_t faults = 0;    // bits of Fault

  /// What two bodies do to the tool together, but for the energy, which is that of both.
  ContactResult& operator+=(const ContactResult& other) noexcept;
};

/// What an evaluation is to give.
enum class Outputs {
  kForce,
  kForceAndStiffness,
  kCoupling,  // both, for a tool on a virtual coupling: over edges the forces turn with it
};

/// What an evaluation of the contact is of. The referred objects outlive it.
struct ContactQuery {
  const Burr& burr;
  Pose world_from_tool;
  std::span<const TissueSettings> tissues;  // the scene's, by label
  const HapticsSettings& settings;
  const Twist* twist = nullptr;  // the tool's motion, for the tangential forces of cutting; or none
  Outputs outputs = Outputs::kForce;
};

/// All the memory a contact evaluation uses, taken once when the scene loads. One per thread.
struct ContactScratch {
  explicit ContactScratch(const HapticsSettings& settings, StageClock stage_clock = StageClock{});
  std::size_t memory_bytes() const;
  /// Clears the results of the last evaluation.
  void clear_results() noexcept;

  static constexpr std::size_t kMaxLeaves = 1 << 16;

  StageClock clock;
  std::size_t capacity;                      // contacts that are kept
  std::vector<std::uint32_t> leaves;         // [broad_phase] leaf numbers
  std::vector<std::uint32_t> emptied_nodes;  // [broad_phase] internal nodes without children left
  // [narrow_phase]
  std::vector<std::uint32_t> leaf_keys;   // of the leaves' first voxels
  std::vector<float> leaf_distances_m;    // at their centres
  std::vector<std::uint32_t> block_keys;  // of voxels to be tested
  std::vector<std::uint64_t> by_depth;    // where there are too many
  Contacts contacts;                      // [narrow_phase], [normals], [contact_force]
  ContactBlock block;                     // the same, up to the depths
  std::vector<NormalCache::Place>
      cached_leaves;  // [normals] leaves with contacts and a cached normal
  // [normals] Found anew, contacts by number.
  std::vector<VoxelQuery> queries;
  std::vector<std::uint32_t> queried;
  std::vector<SurfaceEstimate> estimates;
  std::vector<std::uint32_t> vetoed;  // by the tool, or without a normal
  std::vector<VoxelQuery> tool_queries;
  std::vector<SurfaceEstimate> tool_estimates;
};

}  // namespace sulcus
