#include "app/playback/recorded_heat.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

HeatLog recorded_heat_log(const RecordingReader& reader) {
  const std::vector<TickRecord> rows = reader.ticks();
  const std::vector<CuttingRecord> cutting = reader.cutting();
  HeatLog log(reader.header().rate_hz, rows.empty() ? 0 : rows.front().tick);
  for (std::size_t row = 0; row < cutting.size(); ++row) log.add(rows[row], cutting[row]);
  for (const Edit& edit : reader.edits()) log.add(edit);
  return log;
}

namespace {

const Scene& with_heat(const Scene& scene, const std::string& option) {
  if (scene.heat) return scene;
  throw InputError(scene.file, option, "a scene without [heat]", "the recording of one with it");
}

}  // namespace

RecordedHeat::RecordedHeat(const RecordingReader& reader, const Scene& scene,
                           const VoxelModel& start, const std::string& option)
    : log_(recorded_heat_log(reader)), tooth_(with_heat(scene, option), start) {}

void RecordedHeat::advance_to_end() { advance(std::numeric_limits<double>::infinity()); }

ColourScale temperature_scale(const HeatSettings& heat) {
  const double most_K = 2.0 * kPulpLimit_K;
  return {.name = "Temperature, \u00B0C",
          .low = heat.start_C - most_K,
          .high = heat.start_C + most_K,
          .beyond_low = "and less",
          .beyond_high = "and more",
          .kind = ColourScale::Kind::kAroundZero,
          .inside = true};
}

VoxelValues temperatures(const ToothHeat& tooth, const VoxelModel& now,
                         const std::optional<Section>& section) {
  const VoxelGrid& grid = now.grid;
  std::optional<int> layer;  // of leaves, along the section's axis
  if (section) {
    const Eigen::Vector3d at_index =
        grid.index_from_world(section->at_m * Eigen::Vector3d::Unit(section->axis));
    layer = static_cast<int>(std::floor((at_index[section->axis] + 0.5) / kLeafEdge));
  }
  VoxelValues values(grid);
  for (std::uint32_t leaf = 0; leaf < now.leaves.size(); ++leaf) {
    if (!any(now.leaves[leaf])) continue;
    const Cell origin = grid.leaf_origin(leaf);
    const bool is_cut = layer && origin[section->axis] / kLeafEdge == *layer;
    const LeafBits shown = is_cut ? now.leaves[leaf] : surface_of_leaf(now, leaf);
    for_each_voxel(shown, [&](int place) {
      const Cell c = origin + cell_in_leaf(place);
      if (const auto at_C = tooth.temperature_C(c.cast<double>())) {
        values[c] = static_cast<float>(*at_C);
      }
    });
  }
  return values;
}

}  // namespace sulcus
