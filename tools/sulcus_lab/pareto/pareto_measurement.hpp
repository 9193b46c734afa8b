#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"
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

/// What a scene can choose: [haptics] normals and neighbourhood, and how fine the burr's field is.
struct ParetoSetting {
  NormalMethod method = NormalMethod::kLdm;
  int neighbourhood = 6;
  std::size_t field = 0;  // place among the burrs
};

/// A row of pareto.csv, and what is printed beside it. Errors in per cent are root mean squares
/// over the poses.
struct ParetoRow {
  ParetoSetting setting;
  double tick_us = 0.0;                                                 // evaluate_contact
  double normals_us = 0.0;                                              // the stage of that name
  double directions_pct = 0.0, own_weights_pct = 0.0, whole_pct = 0.0;  // see NetForceErrors
  double normal_error_deg = 0.0;                                        // mean over the contacts
  bool on_front = false;
};

/// The methods of a scene at NS 1 to 6, ours at 8 and 12 too, with each of the fields.
std::vector<ParetoSetting> pareto_settings(std::size_t fields);

/// Runs every setting at the poses. `burrs`: the same burr with different fields.
///
/// Times are of this thread's processor time, best of three passes in which all settings have their
/// turn. Each tick is timed right after the same one, since a tick that follows another finds its
/// voxels in the caches. `exact` is timed at every tenth pose, as slow; errors are of all poses.
std::vector<ParetoRow> measure_pareto(KnownSurface& surface, std::span<const Burr> burrs,
                                      std::span<const PressedPose> poses,
                                      std::span<const ParetoSetting> settings,
                                      const std::function<void(const std::string&)>& progress);

/// Marks the rows than which none is both faster and at least as close to the true force, or as
/// fast and closer.
void mark_front(std::vector<ParetoRow>& rows);

}  // namespace sulcus::lab
