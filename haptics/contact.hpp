#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/core/pose.hpp"
#include "engine/normals/normal_method.hpp"
#include "engine/scene/scene.hpp"
#include "haptics/stage_clock.hpp"

namespace sulcus {

/// A surface voxel that the burr may touch, and what the stages find out about it.
struct Contact {
  // [narrow_phase]
  std::uint32_t voxel = 0;  // VoxelGrid::linear
  Eigen::Vector3i cell = Eigen::Vector3i::Zero();
  float distance_m = 0.0f;  // of the voxel's centre to the burr, negative inside
  // [normals]
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit, out of the tooth; zero: none
  float offset_m = 0.0f;  // of the surface from the voxel's centre along the normal
  // [contact_force]
  Eigen::Vector3d arm_m = Eigen::Vector3d::Zero();  // world, from the torque reference
  float depth_m = 0.0f;         // where depth is measured, positive inside the burr
  float weight = 0.0f;          // 0: dropped
  double normal_force_N = 0.0;  // |F_n|, after scaling
  double power_W = 0.0;         // beta |F_n| |v_t|; 0 without cutting
};

/// Force and torque on the tool, world axes, torque about the burr's reference point.
struct Wrench {
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_Nm = Eigen::Vector3d::Zero();
};

/// Velocity of the burr's tip and turning of the handpiece, world; the spindle comes on top.
struct Twist {
  Eigen::Vector3d linear_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_rad_per_s = Eigen::Vector3d::Zero();
};

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// What one evaluation of the contact found. The contacts are in the scratch it was given.
struct ContactResult {
  Wrench wrench;                          // normal and tangential part
  Matrix6d stiffness = Matrix6d::Zero();  // -d(wrench)/d(translation, rotation), normals held
  std::uint32_t contacts = 0;             // voxels that take part in the force
  std::uint32_t tested = 0;               // voxels whose distance was asked for
  std::uint32_t leaves = 0;               // leaves that the capsule reaches
  std::uint32_t faults = 0;               // bits of Fault
};

/// All the memory a contact evaluation uses, taken once when the scene loads. One per thread.
struct ContactScratch {
  explicit ContactScratch(const HapticsSettings& settings, StageClock stage_clock = StageClock{})
      : clock(stage_clock), capacity(static_cast<std::size_t>(settings.max_contacts)) {
    leaves.reserve(kMaxLeaves);
    hollow.reserve(kMaxLeaves);
    contacts.reserve(2 * capacity);
    queries.reserve(capacity);
    estimates.reserve(capacity);
    prepare_normals();
  }
  std::size_t memory_bytes() const {
    return (leaves.capacity() + hollow.capacity()) * sizeof(std::uint32_t) +
           contacts.capacity() * sizeof(Contact) + queries.capacity() * sizeof(VoxelQuery) +
           estimates.capacity() * sizeof(SurfaceEstimate);
  }

  static constexpr std::size_t kMaxLeaves = 1 << 16;
  StageClock clock;
  std::size_t capacity;               // contacts that are kept
  std::vector<std::uint32_t> leaves;  // [broad_phase] leaf numbers
  std::vector<std::uint32_t> hollow;  // [broad_phase] internal nodes without children left
  std::vector<Contact> contacts;      // [narrow_phase] and on
  std::vector<VoxelQuery> queries;    // [normals] one for each contact
  std::vector<SurfaceEstimate> estimates;
};

}  // namespace sulcus
