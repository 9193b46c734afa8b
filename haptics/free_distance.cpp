#include "haptics/free_distance.hpp"

#include <algorithm>

#include "haptics/contact/broad_phase.hpp"
#include "haptics/contact/narrow_phase.hpp"

namespace sulcus {

namespace {

constexpr double kNear = 8.0;  // voxels: so far every voxel's distance is asked for

double way_to(const Workpiece& workpiece, const Burr& burr, const Pose& world_from_tool,
              double wanted_m, ContactScratch& scratch) noexcept {
  // Depth is measured at surface points, up to 0.87 voxel beyond the voxels' centres.
  const double skin_m = workpiece.grid().voxel_m;
  const double near_m = std::min(wanted_m, kNear * workpiece.grid().voxel_m);
  if (!broad_phase(workpiece, burr.capsule, world_from_tool, near_m + skin_m, scratch)) return 0.0;
  NarrowPhase phase(workpiece, burr.field, world_from_tool, near_m + skin_m, scratch);
  double way_m = near_m;
  bool is_near = false;
  const float* const distance_m = scratch.block(ContactBlock::kDistance);
  for (bool more = true; more;) {
    scratch.contacts.clear();
    more = phase.next();
    for (std::size_t i = 0; i < scratch.contacts.size(); ++i) {
      way_m = std::min(way_m, static_cast<double>(distance_m[i]) - skin_m);
      is_near = true;
    }
  }
  if (is_near) return std::max(0.0, way_m);
  // Further away leaves are enough, as far as none is reached.
  while (way_m < wanted_m) {
    const double further_m = std::min(2.0 * way_m, wanted_m);
    if (!broad_phase(workpiece, burr.capsule, world_from_tool, further_m + skin_m, scratch) ||
        !scratch.leaves.empty()) {
      break;
    }
    way_m = further_m;
  }
  return way_m;
}

}  // namespace

double free_distance(const Workpiece& workpiece, const Burr& burr, const Pose& world_from_tool,
                     double wanted_m, ContactScratch& scratch) noexcept {
  const double way_m = way_to(workpiece, burr, world_from_tool, wanted_m, scratch);
  scratch.clear_results();  // what is near is not in contact: removal would take it for that
  return way_m;
}

}  // namespace sulcus
