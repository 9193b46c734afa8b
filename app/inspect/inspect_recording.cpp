#include <algorithm>
#include <cstdio>
#include <vector>

#include "app/inspect/inspect.hpp"
#include "app/playback/recorded_run.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/units.hpp"
#include "engine/volume/filled_volume.hpp"

namespace sulcus {

void inspect_recording(const std::string& file) {
  const RecordingReader reader(file);
  const RecordingHeader& header = reader.header();
  const Scene scene = recorded_scene(reader, file);
  say("recording        %s\n", scene.title.c_str());
  say("scene_sha256     %s\n", header.scene_sha256.c_str());
  say("build            %s\n", header.build.c_str());
  say("rate             %g Hz\n", header.rate_hz);
  const std::vector<TickRecord> rows = reader.ticks();
  say("ticks            %zu (%.3f s)\n", rows.size(),
      static_cast<double>(rows.size()) / header.rate_hz);
  const std::vector<Edit> edits = reader.edits();
  const auto loose = std::ranges::count(edits, EditCause::kLoose, &Edit::cause);
  const auto others = std::ranges::count_if(edits, [](const Edit& e) { return e.body != 0; });
  say("removed voxels   %zd cut", static_cast<std::ptrdiff_t>(edits.size()) - loose - others);
  if (scene.loose_pieces) say(", %zd in pieces cut loose", loose);
  if (!scene.bodies.empty()) say(", %zd of other bodies", others);
  say("\n");
  if (reader.has_fills()) say("lowered levels   %zu\n", reader.fill_count());
  const VoxelGrid& grid = reader.grid();
  say("cells            %d x %d x %d of %g mm\n", grid.cells.x(), grid.cells.y(), grid.cells.z(),
      grid.voxel_m / kMillimetre);
  const VoxelModel start = reader.workpiece();
  say("solid voxels     %llu at the start, %.4f mm3\n",
      static_cast<unsigned long long>(start.solid_count()),
      filled_voxels(start) * grid.voxel_volume_m3() * 1e9);
  if (!header.parent.empty()) say("goes on from     %s\n", header.parent.c_str());
  for (const RecordingGap& gap : reader.gaps()) {
    say("not recorded     ticks %llu to %llu\n", static_cast<unsigned long long>(gap.first),
        static_cast<unsigned long long>(gap.end - 1));
  }
  if (!header.repaired.empty()) say("repaired         %s\n", header.repaired.c_str());
  say("state            %s\n", reader.missing().empty() ? "whole" : reader.missing().c_str());
}

}  // namespace sulcus
