#include "haptics/evaluate_contact.hpp"

#include "engine/recording/tick_record.hpp"
#include "haptics/broad_phase.hpp"
#include "haptics/contact_force.hpp"
#include "haptics/narrow_phase.hpp"
#include "haptics/normals.hpp"

namespace sulcus {

ContactResult evaluate_contact(const Workpiece& workpiece, std::span<const TissueSettings> tissues,
                               const Burr& burr, const Pose& world_from_tool, const Twist* twist,
                               const HapticsSettings& settings, const KeptNormals* kept,
                               ContactScratch& scratch, Asked asked) noexcept {
  ContactResult result;
  const double reach_m = contact_reach_m(workpiece, settings.scaling, asked);
  {
    const auto timed = scratch.clock.time(Stage::kBroadPhase);
    if (!broad_phase(workpiece, burr.capsule, world_from_tool, reach_m, scratch)) {
      result.faults |= kFaultContactsFull;
    }
    result.leaves = static_cast<std::uint32_t>(scratch.leaves.size());
  }
  {
    const auto timed = scratch.clock.time(Stage::kNarrowPhase);
    narrow_phase(workpiece, burr.field, world_from_tool, reach_m, scratch, result);
  }
  {
    const auto timed = scratch.clock.time(Stage::kNormals);
    normals(workpiece, settings, kept, scratch);
  }
  {
    const auto timed = scratch.clock.time(Stage::kContactForce);
    contact_force(workpiece, tissues, burr, world_from_tool, twist, settings.scaling, scratch,
                  result, asked);
  }
  return result;
}

}  // namespace sulcus
