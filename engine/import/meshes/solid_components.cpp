#include "engine/import/meshes/solid_components.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace sulcus {
namespace {

/// Disjoint sets of runs; the root of a set is its first run, so that numbering needs no sort.
class RunSets {
 public:
  explicit RunSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t root(std::uint32_t run) {
    while (parent_[run] != run) {
      parent_[run] = parent_[parent_[run]];
      run = parent_[run];
    }
    return run;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Joins the runs of two rows that touch: those whose ranges along x overlap.
void join_rows(const std::vector<SolidRun>& runs, std::uint32_t a, std::uint32_t a_end,
               std::uint32_t b, std::uint32_t b_end, RunSets& sets) {
  while (a < a_end && b < b_end) {
    if (runs[a].begin < runs[b].end && runs[b].begin < runs[a].end) sets.join(a, b);
    if (runs[a].end < runs[b].end) {
      ++a;
    } else {
      ++b;
    }
  }
}

}  // namespace

std::uint32_t SolidComponents::largest() const {
  return static_cast<std::uint32_t>(std::ranges::max_element(voxels) - voxels.begin());
}

SolidComponents find_components(std::span<const float> values, const Eigen::Vector3i& sizes,
                                float least, bool strictly) {
  const auto solid = [&](float v) { return strictly ? v > least : v >= least; };
  SolidComponents found;
  const auto rows = static_cast<std::size_t>(sizes.y()) * static_cast<std::size_t>(sizes.z());
  std::vector<std::uint32_t> first_run(rows + 1, 0);
  const float* row = values.data();
  for (std::size_t r = 0; r < rows; ++r, row += sizes.x()) {
    first_run[r] = static_cast<std::uint32_t>(found.runs.size());
    for (int i = 0; i < sizes.x();) {
      if (!solid(row[i])) {
        ++i;
        continue;
      }
      SolidRun run{i, i, static_cast<int>(r % static_cast<std::size_t>(sizes.y())),
                   static_cast<int>(r / static_cast<std::size_t>(sizes.y())), 0};
      while (i < sizes.x() && solid(row[i])) ++i;
      run.end = i;
      found.runs.push_back(run);
    }
  }
  first_run[rows] = static_cast<std::uint32_t>(found.runs.size());

  RunSets sets(found.runs.size());
  const auto ny = static_cast<std::size_t>(sizes.y());
  for (std::size_t r = 0; r < rows; ++r) {
    if (r % ny != 0) {
      join_rows(found.runs, first_run[r - 1], first_run[r], first_run[r], first_run[r + 1], sets);
    }
    if (r >= ny) {
      join_rows(found.runs, first_run[r - ny], first_run[r - ny + 1], first_run[r],
                first_run[r + 1], sets);
    }
  }
  for (std::uint32_t run = 0; run < found.runs.size(); ++run) {
    SolidRun& r = found.runs[run];
    const std::uint32_t root = sets.root(run);
    if (root == run) {
      r.component = static_cast<std::uint32_t>(found.voxels.size());
      found.voxels.push_back(0);
    } else {
      r.component = found.runs[root].component;
    }
    found.voxels[r.component] += static_cast<std::uint64_t>(r.end - r.begin);
  }
  return found;
}

}  // namespace sulcus
