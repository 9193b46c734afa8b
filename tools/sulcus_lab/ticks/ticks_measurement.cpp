#include "tools/sulcus_lab/ticks/ticks_measurement.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

#include "engine/core/realtime.hpp"
#include "haptics/contact/evaluate_contact.hpp"
#include "tools/sulcus_lab/statistics.hpp"

namespace sulcus::lab {

namespace {

constexpr int kRepetitions = 3, kStageTicks = 300;
constexpr std::size_t kPcaVoxels = 2000, kStretch = 50;
constexpr int kNeighbourhood = 6;

template <class T>
double mean_of(const std::vector<T>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Voxels in contact at some of the poses, those in a stretch neighbours, so that PCA finds its
/// points in the caches as a tick does.
std::vector<Cell> contact_cells(const Workpiece& workpiece, const TickPath& path, int wanted) {
  const HapticsSettings settings = counting_settings(wanted);
  ContactScratch scratch(settings);
  const std::vector<TissueSettings> tissues = tick_tissues(1.0);
  std::vector<Cell> cells;
  for (const std::size_t at : {std::size_t{0}, path.poses.size() / 2}) {
    evaluate_contact(workpiece, {path.burr, path.poses[at], tissues, settings}, scratch);
    std::vector<Cell> found;
    for (const Contact contact : scratch.contacts) {
      if (contact.weight > 0.0f) found.push_back(contact.cell);
    }
    const std::size_t stretches = std::max<std::size_t>(1, kPcaVoxels / 2 / kStretch);
    if (found.size() <= stretches * kStretch) {
      cells.insert(cells.end(), found.begin(), found.end());
      continue;
    }
    for (std::size_t s = 0; s < stretches; ++s) {
      const auto first = found.begin() + static_cast<std::ptrdiff_t>(s * found.size() / stretches);
      cells.insert(cells.end(), first, first + static_cast<std::ptrdiff_t>(kStretch));
    }
  }
  return cells;
}

/// One repetition of all runs.
void take_turns(std::span<TickRun> runs, int repetition,
                const std::function<void(const std::string&)>& progress) {
  for (TickRun& run : runs) {
    progress(std::to_string(run.task.wanted) + " contacts, " +
             std::string(method_name(run.setting)) + ", " + std::string(cache_name(run.setting)) +
             ", " + std::to_string(repetition + 1) + " of " + std::to_string(kRepetitions));
    run.summary.keep_best(run_ticks(run.task, run.setting));
  }
}

void time_pca(TicksGroup& group) {
  if (!group.pca) return;
  std::vector<SurfaceEstimate> estimates;
  const std::uint64_t begin = thread_cpu_ns();
  group.pca->estimate(Method::kPca, kNeighbourhood, group.pca_sample, estimates);
  const double ns = static_cast<double>(thread_cpu_ns() - begin) /
                    static_cast<double>(group.pca_sample.cells.size());
  group.pca_ns = std::min(group.pca_ns.value_or(ns), ns);
}

void time_stages(TickRun& run) {
  TickTask task = run.task;
  task.ticks = std::min(task.ticks, kStageTicks);
  double best_us = std::numeric_limits<double>::infinity();
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    const TickSamples samples = run_ticks(task, run.setting, thread_cpu_ns);
    const double mean_us = mean(samples.us);
    if (mean_us >= best_us) continue;
    best_us = mean_us;
    run.stages = stage_times(samples);
  }
}

}  // namespace

void TickSummary::keep_best(const TickSamples& samples) {
  const double mean_us = mean(samples.us);
  if (mean_us >= us_mean) return;
  us_mean = mean_us;
  us_p50 = quantile(samples.us, 0.5);
  us_p99 = quantile(samples.us, 0.99);
  us_p999 = quantile(samples.us, 0.999);
  us_max = quantile(samples.us, 1.0);
  contacts = mean_of(samples.contacts);
  removed = mean_of(samples.removed);
  const auto [fewest, greatest] =
      std::minmax_element(samples.contacts.begin(), samples.contacts.end());
  least = static_cast<int>(*fewest);
  most = static_cast<int>(*greatest);
  const auto count = static_cast<double>(samples.us.size());
  ticks_that_cut = static_cast<double>(std::count_if(samples.removed.begin(), samples.removed.end(),
                                                     [](std::uint32_t n) { return n > 0; })) /
                   count;
  instructions = static_cast<double>(samples.instructions) / count;
  force_hash = samples.force_hash;
  faults = samples.faults;
}

std::array<StageTimes, kStageCount> stage_times(const TickSamples& samples) {
  std::array<StageTimes, kStageCount> times;
  for (std::size_t s = 0; s < times.size(); ++s) {
    times[s] = {mean(samples.stage_us[s]), quantile(samples.stage_us[s], 0.99)};
  }
  return times;
}

void repeat_runs(std::span<TickRun> runs, const std::function<void(const std::string&)>& progress) {
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    take_turns(runs, repetition, progress);
  }
}

int ticks_of(const TicksPlan& plan, TickCache cache, int contacts) {
  const bool cutting = cache == TickCache::kCutting;
  const double enough = (cutting ? 1e7 : 4e6) / contacts;
  return std::min(plan.ticks, std::max(cutting ? 100 : 80, static_cast<int>(enough)));
}

std::unique_ptr<TicksGroup> plan_group(Workpiece& workpiece, const NormalMethods* pca,
                                       const TickGround& ground, int wanted, const TicksPlan& plan,
                                       const std::function<void(const std::string&)>& progress) {
  auto group = std::make_unique<TicksGroup>();
  group->wanted = wanted;
  progress(std::to_string(wanted) + " contacts: poses");
  group->path = find_tick_path(workpiece, ground, wanted);
  const int cutting_ticks = plan.lead + ticks_of(plan, TickCache::kCutting, wanted);
  const double energy = find_specific_energy(workpiece, group->path, wanted, cutting_ticks);
  for (const NormalMethod method : plan.methods) {
    group->cutting.push_back(plan_cutting(workpiece, group->path, wanted, cutting_ticks, energy,
                                          haptics_of({method, TickCache::kCutting}, wanted)));
  }

  for (std::size_t m = 0; m < plan.methods.size(); ++m) {
    for (std::size_t c = 0; c < kTickCacheNames.size(); ++c) {
      const TickSetting setting{plan.methods[m], static_cast<TickCache>(c)};
      TickTask task{workpiece, group->path.burr, group->path.poses, wanted};
      task.lead = static_cast<int>(group->path.poses.size());
      task.ticks = ticks_of(plan, setting.cache, wanted);
      if (setting.cache == TickCache::kCutting) {
        task.poses = group->cutting[m].poses;
        task.lead = plan.lead;
        task.specific_energy_J_per_m3 = energy;
      }
      group->runs.push_back({task, setting, {}});
    }
  }
  if (pca) {
    group->pca = pca;
    group->pca_sample = pca->sample(contact_cells(workpiece, group->path, wanted));
  }
  return group;
}

void measure_groups(std::span<const std::unique_ptr<TicksGroup>> groups,
                    const std::function<void(const std::string&)>& progress) {
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    for (const auto& group : groups) {
      time_pca(*group);
      take_turns(group->runs, repetition, progress);
    }
  }
  for (const auto& group : groups) {
    for (TickRun& run : group->runs) {
      progress(std::to_string(group->wanted) + " contacts: stages, " +
               std::string(method_name(run.setting)) + ", " + std::string(cache_name(run.setting)));
      time_stages(run);
    }
  }
}

}  // namespace sulcus::lab
