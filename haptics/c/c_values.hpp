#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "engine/core/pose.hpp"
#include "engine/volume/edit.hpp"
#include "haptics/c/scene_run.hpp"
#include "haptics/c/sulcus.h"

// What the faces to C and Python say of a run, as sulcus.h has it.

namespace sulcus {

/// None where a number is not finite, the place beyond 10 m, or the orientation not of length 1.
inline std::optional<Pose> pose_from(std::span<const double, 7> p) noexcept {
  constexpr double kFarthest_m = 10.0, kRotation = 1e-3, kExactly = 1e-12;
  if (!std::ranges::all_of(p, [](double number) { return std::isfinite(number); })) return {};
  Pose pose{{p[0], p[1], p[2]}, Eigen::Quaterniond(p[3], p[4], p[5], p[6])};
  if (pose.position.cwiseAbs().maxCoeff() > kFarthest_m) return {};
  const double off = std::abs(pose.orientation.norm() - 1.0);
  if (!(off <= kRotation)) return {};
  if (off > kExactly) pose.orientation.normalize();
  return pose;
}

inline SulcusContact contact_of(const FeltContact& felt) noexcept {
  SulcusContact contact{};
  for (int a = 0; a < 3; ++a) contact.position_m[a] = felt.position_world[a];
  for (int a = 0; a < 3; ++a) contact.normal[a] = felt.normal_world[a];
  contact.depth_m = felt.depth_m;
  contact.force_N = felt.force_N;
  contact.voxel = felt.voxel;
  contact.body = felt.body;
  contact.tissue = felt.tissue;
  return contact;
}

inline SulcusEdit edit_of(const Edit& edit) noexcept {
  return {edit.tick, edit.voxel, edit.body, static_cast<std::uint8_t>(edit.cause), edit.level};
}

}  // namespace sulcus
