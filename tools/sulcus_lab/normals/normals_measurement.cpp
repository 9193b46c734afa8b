#include "tools/sulcus_lab/normals/normals_measurement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/realtime.hpp"
#include "tools/sulcus_lab/statistics.hpp"
#include "tools/sulcus_lab/truth/error_stats.hpp"

namespace sulcus::lab {

namespace {

constexpr int kTimedPasses = 3;
constexpr std::size_t kStretch = 50;  // neighbouring voxels that are timed in a row

/// What one run gathers in one zone, over all parts.
struct Tally {
  std::vector<float> errors_deg;
  std::size_t undefined = 0;
  std::optional<double> max_with_tool_deg;
  double ns = 0.0;
  std::size_t timed = 0;

  void add(const Tally& other) {
    errors_deg.insert(errors_deg.end(), other.errors_deg.begin(), other.errors_deg.end());
    undefined += other.undefined;
    // None is less than any.
    max_with_tool_deg = std::max(max_with_tool_deg, other.max_with_tool_deg);
    ns += other.ns;
    timed += other.timed;
  }
  double ns_per_normal() const {
    return timed > 0 ? ns / static_cast<double>(timed) : std::numeric_limits<double>::quiet_NaN();
  }
};

/// The voxels of one zone of one part.
struct Block {
  std::size_t zone;  // place in the table
  std::vector<TruthVoxel> voxels;
};

/// `limit` of `count` places, evenly spread in stretches of `stretch`; all where the limit is 0 or
/// not reached.
std::vector<std::size_t> spread(std::size_t count, std::size_t limit, std::size_t stretch) {
  std::vector<std::size_t> places;
  if (limit == 0 || limit >= count) limit = count;
  const std::size_t stretches = std::max<std::size_t>(1, limit / stretch);
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t first = s * count / stretches, next = (s + 1) * count / stretches;
    const std::size_t last = std::min(next, first + (limit + stretches - 1) / stretches);
    for (std::size_t place = first; place < last; ++place) places.push_back(place);
  }
  return places;
}

/// A limit for a whole shape as the share of `part` of `whole` voxels; 0 stays 0.
std::size_t share(int limit, std::size_t part, std::size_t whole) {
  if (limit == 0) return 0;
  return std::max<std::size_t>(
      1, static_cast<std::size_t>(limit) * part / std::max<std::size_t>(1, whole));
}

std::vector<Cell> cells_of(const std::vector<TruthVoxel>& voxels,
                           const std::vector<std::size_t>& places) {
  std::vector<Cell> cells;
  cells.reserve(places.size());
  for (const std::size_t place : places) cells.push_back(voxels[place].cell);
  return cells;
}

/// The runs on the blocks of one part; adds to `tallies[run][zone]`.
class PartMeasurement {
 public:
  PartMeasurement(const TruthShape& part, std::span<const MethodRun> runs,
                  const std::vector<Block>& blocks, std::size_t voxels_of_shape)
      : part_(part),
        runs_(runs),
        blocks_(blocks),
        voxels_of_shape_(voxels_of_shape),
        workpiece_{VoxelModel(part.model)},
        methods_(workpiece_,
                 std::any_of(runs.begin(), runs.end(),
                             [](const MethodRun& r) { return !info_of(r.method).finds_sign; }),
                 part.tool_direction) {}

  void errors(std::vector<std::vector<Tally>>& tallies) const {
    std::vector<SurfaceEstimate> estimates;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      const MethodInfo& info = info_of(runs_[r].method);
      for (const Block& block : blocks_) {
        const auto places =
            spread(block.voxels.size(), limit_of(runs_[r], info.error_voxels, block), 1);
        const VoxelSample sample = methods_.sample(cells_of(block.voxels, places));
        methods_.estimate(info.method, runs_[r].neighbourhood, sample, estimates);
        Tally& tally = tallies[r][block.zone];
        for (std::size_t v = 0; v < places.size(); ++v) {
          const TruthVoxel& truth = block.voxels[places[v]];
          const auto error = error_deg(
              info.finds_sign ? estimates[v] : turned_outward(estimates[v], truth), truth, part_);
          if (error) {
            tally.errors_deg.push_back(*error);
          } else {
            ++tally.undefined;
          }
        }
        if (info.method == Method::kLdm || info.method == Method::kLdmFast) {
          with_tool(runs_[r], block, places, sample, tally);
        }
      }
    }
  }

  void times(std::vector<std::vector<Tally>>& tallies) const {
    struct Timed {
      VoxelSample sample;
      double best_ns = std::numeric_limits<double>::infinity();
    };
    std::vector<std::vector<Timed>> timed(runs_.size());
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      const int limit = info_of(runs_[r].method).timed_voxels;
      for (const Block& block : blocks_) {
        const auto places = spread(block.voxels.size(), limit_of(runs_[r], limit, block), kStretch);
        timed[r].push_back({methods_.sample(cells_of(block.voxels, places))});
      }
    }
    std::vector<SurfaceEstimate> estimates;
    for (int pass = 0; pass < kTimedPasses; ++pass) {
      for (std::size_t r = 0; r < runs_.size(); ++r) {
        for (Timed& t : timed[r]) {
          const std::uint64_t begin = thread_cpu_ns();
          methods_.estimate(runs_[r].method, runs_[r].neighbourhood, t.sample, estimates);
          t.best_ns = std::min(t.best_ns, static_cast<double>(thread_cpu_ns() - begin));
        }
      }
    }
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      for (std::size_t b = 0; b < blocks_.size(); ++b) {
        tallies[r][blocks_[b].zone].ns += timed[r][b].best_ns;
        tallies[r][blocks_[b].zone].timed += timed[r][b].sample.cells.size();
      }
    }
  }

 private:
  void with_tool(const MethodRun& run, const Block& block, const std::vector<std::size_t>& places,
                 VoxelSample sample, Tally& tally) const {
    for (std::size_t v = 0; v < places.size(); ++v) {
      const Eigen::Vector3d& squarely = block.voxels[places[v]].normal;
      sample.queries[v].outward = part_.tool_direction.value_or(squarely).cast<float>();
    }
    std::vector<SurfaceEstimate> estimates;
    methods_.estimate(run.method, run.neighbourhood, sample, estimates);
    for (std::size_t v = 0; v < places.size(); ++v) {
      const auto error = error_deg(estimates[v], block.voxels[places[v]], part_);
      tally.max_with_tool_deg =
          std::max<std::optional<double>>(tally.max_with_tool_deg, error.value_or(180.0f));
    }
  }

  std::size_t limit_of(const MethodRun& run, int limit, const Block& block) const {
    if (run.neighbourhood < info_of(run.method).slow_from_ns) return 0;
    return share(limit, block.voxels.size(), voxels_of_shape_);
  }

  const TruthShape& part_;
  std::span<const MethodRun> runs_;
  const std::vector<Block>& blocks_;
  std::size_t voxels_of_shape_;
  Workpiece workpiece_;
  NormalMethods methods_;
};

std::vector<Block> blocks_of(const TruthShape& part, std::vector<std::string>& zones) {
  std::vector<Block> blocks;
  const std::vector<std::string> own =
      part.zones.empty() ? std::vector<std::string>{""} : part.zones;
  for (std::size_t z = 0; z < own.size(); ++z) {
    const auto at = std::find(zones.begin(), zones.end(), own[z]);
    Block block{static_cast<std::size_t>(at - zones.begin()), {}};
    if (at == zones.end()) zones.push_back(own[z]);
    for (const TruthVoxel& voxel : part.voxels) {
      if (part.zones.empty() || voxel.zone == static_cast<int>(z)) block.voxels.push_back(voxel);
    }
    // Leaf by leaf, as a tick's contacts come.
    std::stable_sort(block.voxels.begin(), block.voxels.end(),
                     [&](const TruthVoxel& a, const TruthVoxel& b) {
                       return part.model.grid.leaf_of(a.cell) < part.model.grid.leaf_of(b.cell);
                     });
    if (!block.voxels.empty()) blocks.push_back(std::move(block));
  }
  return blocks;
}

NormalsRow row_of(const MethodRun& run, std::string zone, const Tally& tally) {
  const ErrorStats stats = error_stats(tally.errors_deg);
  NormalsRow row;
  row.method = run.method;
  row.neighbourhood = run.neighbourhood;
  row.zone = std::move(zone);
  row.voxels = tally.errors_deg.size() + tally.undefined;
  row.mean_deg = stats.mean;
  row.p95_deg = stats.p95;
  row.max_deg = stats.max;
  row.undefined = tally.undefined;
  row.max_with_tool_deg = tally.max_with_tool_deg;
  row.ns_per_normal = tally.ns_per_normal();
  return row;
}

void set_ratios(std::vector<NormalsRow>& rows) {
  for (NormalsRow& row : rows) {
    const auto ldm = std::find_if(rows.begin(), rows.end(), [&](const NormalsRow& other) {
      return other.method == Method::kLdm && other.neighbourhood == row.neighbourhood &&
             other.zone == row.zone;
    });
    row.ratio_to_ldm = ldm == rows.end() ? std::numeric_limits<double>::quiet_NaN()
                                         : row.ns_per_normal / ldm->ns_per_normal;
  }
}

}  // namespace

std::vector<NormalsRow> measure_normals(std::span<const TruthShape> parts,
                                        std::span<const MethodRun> runs,
                                        const std::function<void(const std::string&)>& progress) {
  std::vector<std::string> zones;
  std::vector<std::vector<Block>> blocks;
  std::size_t voxels = 0;
  for (const TruthShape& part : parts) {
    blocks.push_back(blocks_of(part, zones));
    voxels += part.voxels.size();
  }
  std::vector<std::vector<Tally>> tallies(runs.size(), std::vector<Tally>(zones.size()));
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::string what = parts[p].name;
    if (parts.size() > 1) {
      what += ", " + std::to_string(p + 1) + " of " + std::to_string(parts.size());
    }
    const PartMeasurement measurement(parts[p], runs, blocks[p], voxels);
    progress(what + ": errors");
    measurement.errors(tallies);
    progress(what + ": times");
    measurement.times(tallies);
  }

  std::vector<NormalsRow> rows;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    Tally whole;
    for (const Tally& tally : tallies[r]) whole.add(tally);
    rows.push_back(row_of(runs[r], "all", whole));
    for (std::size_t z = 0; z < zones.size(); ++z) {
      if (!zones[z].empty()) rows.push_back(row_of(runs[r], zones[z], tallies[r][z]));
    }
  }
  set_ratios(rows);
  return rows;
}

std::vector<CostRow> costs_of(std::span<const NormalsRow> rows) {
  std::vector<CostRow> costs;
  for (const NormalsRow& row : rows) {
    if (row.zone != "all") continue;
    costs.push_back({row.method, row.neighbourhood, readouts(row.method, row.neighbourhood),
                     row.ns_per_normal});
  }
  return costs;
}

CostGrowth growth_of(Method method, const std::vector<CostRow>& costs) {
  std::vector<std::pair<double, double>> times, reads;
  for (const CostRow& cost : costs) {
    if (cost.method != method) continue;
    const double edge = 2.0 * cost.neighbourhood + 1.0;
    times.emplace_back(edge, cost.ns_per_normal);
    reads.emplace_back(edge, cost.readouts);
  }
  return {log_slope(times), log_slope(reads)};
}

}  // namespace sulcus::lab
