#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/sulcus_lab/normals/normal_methods.hpp"
#include "tools/sulcus_lab/ticks/ticks_cutting.hpp"
#include "tools/sulcus_lab/ticks/ticks_path.hpp"
#include "tools/sulcus_lab/ticks/ticks_run.hpp"

namespace sulcus::lab {

/// Times and counts of the best of the repetitions, that with the least mean.
struct TickSummary {
  double us_mean = std::numeric_limits<double>::infinity();
  double us_p50 = 0.0, us_p99 = 0.0, us_p999 = 0.0, us_max = 0.0;
  double contacts = 0.0, removed = 0.0;  // means of a tick
  int least = 0, most = 0;               // contacts
  double ticks_that_cut = 0.0;           // share of them
  double instructions = 0.0;             // of a tick; 0: not counted
  std::uint64_t force_hash = 0, faults = 0;

  /// Takes a repetition's place if that was faster.
  void keep_best(const TickSamples& samples);
};

struct StageTimes {
  double us_mean = 0.0, us_p99 = 0.0;
};
std::array<StageTimes, kStageCount> stage_times(const TickSamples& samples);

/// One setting on one task, and what came of it.
struct TickRun {
  TickTask task;
  TickSetting setting;
  TickSummary summary;
  std::array<StageTimes, kStageCount> stages{};
};

/// Three repetitions of all runs; in each every run has its turn, so that a change in the machine's
/// pace meets all alike.
void repeat_runs(std::span<TickRun> runs, const std::function<void(const std::string&)>& progress);

/// What the main table is measured with.
struct TicksPlan {
  std::vector<int> contacts;
  std::vector<NormalMethod> methods;
  int ticks = 2000;  // that count, at most; fewer with many contacts
  int lead = 300;    // before them while cutting
};
/// Ticks of a row: at most what the plan says, fewer with many contacts. Fresh and kept ticks come
/// again after a period of the path and need no more of them than 4e6 contacts and one period;
/// cutting, whose rarest ticks count, 1e7 contacts and 100 ticks.
int ticks_of(const TicksPlan& plan, TickCache cache, int contacts);

/// The rows of one number of contacts.
struct TicksGroup {
  int wanted = 0;
  TickPath path;
  std::vector<CuttingPlan> cutting;  // one for each method
  std::vector<TickRun> runs;         // method by method: fresh, kept, cutting; tasks refer in here
  const NormalMethods* pca = nullptr;
  VoxelSample pca_sample;        // up to 2,000 of the voxels in contact
  std::optional<double> pca_ns;  // per normal on them; none without PCL
};

/// What every method with every cache runs at one number of contacts, on voxels `workpiece`.
/// `pca`: null without PCL. The workpiece and `pca` outlive the group.
std::unique_ptr<TicksGroup> plan_group(Workpiece& workpiece, const NormalMethods* pca,
                                       const TickGround& ground, int wanted, const TicksPlan& plan,
                                       const std::function<void(const std::string&)>& progress);
/// Times all groups: in each of three repetitions every run of every group has its turn, and in
/// every group PCL's PCA at NS 6. Stages are timed in runs of their own, up to 300 ticks, best of
/// three.
void measure_groups(std::span<const std::unique_ptr<TicksGroup>> groups,
                    const std::function<void(const std::string&)>& progress);

}  // namespace sulcus::lab
