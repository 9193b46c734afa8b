#pragma once

#include <cstdint>
#include <vector>

#include "engine/core/pose.hpp"
#include "tools/sulcus_lab/pareto/net_force.hpp"

namespace sulcus::lab {

/// A burr pressed into a known surface, and the force that it should feel.
struct PressedPose {
  Pose world_from_tool;
  TrueForce truth;
};

/// `count` poses at random points of the surface above `lowest_z_m`, evenly over its area. The tool
/// lies along the outward normal there, tilted at random by up to 30 degrees, its head's centre
/// straight out, and it is pressed in along the normal until the deepest point of the surface is
/// `depth_m` inside the burr. Where that takes it into a fissure the walls stop it first, so no
/// pose is deeper anywhere. Same seed, same poses.
std::vector<PressedPose> pressed_poses(KnownSurface& surface, const Burr& burr,
                                       double head_radius_m, double depth_m, double lowest_z_m,
                                       int count, std::uint64_t seed,
                                       const HapticsSettings& settings);

}  // namespace sulcus::lab
