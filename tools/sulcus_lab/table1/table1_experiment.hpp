#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/scene/scene.hpp"
#include "haptics/contact/contact.hpp"

namespace sulcus::lab {

// One run of a scene, and beside it the offline reference on the same contacts.
//
//   tick t:  workpiece, pose, twist --+--> tick with the scene's method --> force, cut voxels --> t
//   + 1
//                                     +--> the same evaluation with `exact`            (compared)
//                                     +--> the same with analytic normals, where known (compared)
//
// The evaluations see the same workpiece, and find the same voxels in contact; what differs is what
// they take for the surface there: the normals under `count`, which measures depth at the voxels'
// centres; normals and surface points under `smooth`. Only the scene's method cuts.

/// One tick whose wrenches were compared.
struct ComparedTick {
  std::uint64_t tick = 0;
  std::uint32_t contacts = 0;  // that the scene's method lets take part
  Wrench ours, exact;
  Wrench truth;  // of no meaning unless Table1Run::has_truth
};

/// Angles between normals as felt (the tool's where a method gives none), over contacts.
struct MeanAngle {
  double sum_deg = 0.0, max_deg = 0.0;
  std::uint64_t count = 0;
  void add(const Eigen::Vector3f& a, const Eigen::Vector3f& b);
  double mean_deg() const { return count > 0 ? sum_deg / static_cast<double>(count) : 0.0; }
};

struct Table1Run {
  // [the scene's own run, undisturbed]
  std::vector<std::uint32_t> contacts;                              // of every tick
  double leaves_mean = 0.0, tested_mean = 0.0, tick_us_mean = 0.0;  // thread CPU time
  std::uint64_t removed_voxels = 0;
  // [the run beside the reference]
  std::vector<ComparedTick> compared;
  bool has_truth = false;
  /// Contacts by the axes in the direction of projection of their pattern (neighbour_pattern.hpp):
  /// none (opposing faces only), one, two, three.
  std::array<std::uint64_t, 4> by_axes{};
  std::uint64_t normals = 0;             // contacts that were evaluated, in all compared ticks
  double ours_us = 0.0, exact_us = 0.0;  // for those normals, thread CPU time
  MeanAngle ours_to_exact, ours_to_truth, exact_to_truth;
};

/// Runs a scene twice: alone, for the times and counts, then beside the reference on every
/// `every`-th tick. Truth: the workpiece is the built-in molar and nothing cuts it. `progress` is
/// told what goes on, a few times a second. InputError as the scene's workpiece, burr and
/// trajectory; std::runtime_error when a tick ends in a fault.
Table1Run run_table1_experiment(const Scene& scene, int every,
                                const std::function<void(const std::string&)>& progress);

}  // namespace sulcus::lab
