#include "tools/sulcus_lab/ticks/ticks_sweeps.hpp"

#include <algorithm>
#include <deque>

#include "engine/shapes/build_shape.hpp"

namespace sulcus::lab {

namespace {

constexpr double kPlate = 1.5e-3, kTilt = 0.3490658503988659;  // m, rad
/// Along y, where the tilted plate is level; from above its face.
const TickGround kPlateGround{{0.0, -0.2e-3}, {0.0, 0.2e-3}, 1.0e-3};

Workpiece plate_in(int cells) {
  Scene scene;
  scene.workpiece.shape = ShapeKind::kPlate;
  scene.workpiece.plate_thickness_m = kPlate;
  scene.workpiece.plate_tilt = kTilt;
  scene.workpiece.cells = Eigen::Vector3i::Constant(cells);
  scene.tissues = tick_tissues(1.0);
  return Workpiece(build_shape(scene));
}

void add_runs(Workpiece& workpiece, const TickPath& path, int wanted, int bodies,
              const TicksPlan& plan, std::vector<TickRun>& runs) {
  for (const NormalMethod method : plan.methods) {
    for (const TickCache cache : {TickCache::kFresh, TickCache::kKept}) {
      TickTask task{workpiece, path.burr, path.poses, wanted};
      task.lead = static_cast<int>(path.poses.size());
      task.ticks = ticks_of(plan, cache, wanted);
      task.bodies = bodies;
      runs.push_back({task, {method, cache}, {}});
    }
  }
}

/// `size_of`: of a task, what is swept.
template <class SizeOf>
std::vector<SweepRow> rows_of(const std::vector<TickRun>& runs, const SizeOf& size_of) {
  std::vector<SweepRow> rows;
  rows.reserve(runs.size());
  for (const TickRun& run : runs) {
    rows.push_back({size_of(run.task), run.setting, run.task.wanted, run.summary});
  }
  return rows;
}

}  // namespace

std::vector<SweepRow> measure_cells(std::span<const int> cells, std::span<const int> contacts,
                                    const TicksPlan& plan,
                                    const std::function<void(const std::string&)>& progress) {
  std::vector<Workpiece> plates;
  plates.reserve(cells.size());
  for (const int n : cells) {
    progress(std::to_string(n) + " cells along an axis: the plate");
    plates.push_back(plate_in(n));
  }
  std::deque<TickPath> paths;  // runs refer to them
  std::vector<TickRun> runs;
  for (const int wanted : contacts) {
    paths.push_back(find_tick_path(plates.front(), kPlateGround, wanted));
    for (Workpiece& plate : plates) add_runs(plate, paths.back(), wanted, 1, plan, runs);
  }
  repeat_runs(runs, progress);
  return rows_of(runs, [](const TickTask& task) { return task.start.grid().cells.x(); });
}

std::vector<SweepRow> measure_bodies(Workpiece& workpiece, const TickGround& ground,
                                     std::span<const int> bodies, int contacts,
                                     const TicksPlan& plan,
                                     const std::function<void(const std::string&)>& progress) {
  progress("bodies: poses");
  const TickPath path = find_tick_path(workpiece, ground, contacts);
  std::vector<TickRun> runs;
  for (const int n : bodies) add_runs(workpiece, path, contacts, n, plan, runs);
  repeat_runs(runs, progress);
  return rows_of(runs, [](const TickTask& task) { return task.bodies; });
}

double growth_of(std::span<const SweepRow> rows) {
  double growth = 0.0;
  const auto by_size = [](const SweepRow& a, const SweepRow& b) { return a.size < b.size; };
  if (rows.empty()) return growth;
  const auto [smallest, largest] = std::minmax_element(rows.begin(), rows.end(), by_size);
  for (const SweepRow& row : rows) {
    if (row.size != smallest->size) continue;
    for (const SweepRow& other : rows) {
      if (other.size == largest->size && other.wanted == row.wanted &&
          other.setting == row.setting) {
        growth = std::max(growth, other.summary.us_mean / row.summary.us_mean);
      }
    }
  }
  return growth;
}

}  // namespace sulcus::lab
