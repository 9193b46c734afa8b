#pragma once

#include <vector>

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus::lab {

/// Way of a tool in a tick at 10 mm/s and 1 kHz, m.
inline constexpr double kTickStep = 10e-6;

/// A round burr as a scene has it, its field "auto". Beyond the 5 mm that a scene may ask for, a
/// bare ball of that size, with neither neck nor shank. InputError as make_burr and plan_field.
Burr round_burr(double diameter_m, double voxel_m);

/// Where a tool goes to and fro: over the workpiece, its axis along +z, between two places in x and
/// y. It comes down on them from the tip's height `top_m`, at which nothing is touched.
struct TickGround {
  Eigen::Vector2d from_m, to_m;
  double top_m;
};

/// Poses of a tool that moves to and fro with about as many voxels in contact at each of them.
struct TickPath {
  double diameter_m = 0.0;
  Burr burr;
  std::vector<Pose> poses;  // one period, kTickStep apart; the first follows the last
  double depth_m = 0.0;     // mean, of the tip below where it first touches
  double contacts = 0.0;    // mean over the poses under `smooth`, normals by ldm_fast
  int least = 0, most = 0;
};

/// Finds a burr, and heights for it, so that `wanted` voxels are in contact. The burr is 1.4 times
/// as wide as a flat patch of that many, which its cap then just holds; it grows where the ground
/// is too narrow. Heights are bisected at places 0.1 mm apart, straight lines lie between, and a
/// shift of all takes the mean to what is wanted. InputError (`--contacts`) where even a burr of
/// 16 mm does not reach so many.
TickPath find_tick_path(const Workpiece& workpiece, const TickGround& ground, int wanted);

/// The settings that contacts are counted with, and room for them.
HapticsSettings counting_settings(int wanted);

}  // namespace sulcus::lab
