#include "haptics/evaluate_contact.hpp"

#include <optional>

#include "engine/recording/tick_record.hpp"
#include "haptics/broad_phase.hpp"
#include "haptics/contact_force.hpp"
#include "haptics/narrow_phase.hpp"
#include "haptics/normals.hpp"

namespace sulcus {

namespace {

/// The contacts, their normals and their depths, block by block, so that what only these stages
/// read of a block stays in the caches however many contacts there are. False where there are more
/// than the capacity: which are the deepest is known only once all have been found.
bool find_in_blocks(const Workpiece& workpiece, const Burr& burr, const Pose& world_from_tool,
                    double reach_m, const HapticsSettings& settings, const KeptNormals* kept,
                    ContactScratch& scratch, ContactResult& result, ContactForce& force) {
  Contacts& contacts = scratch.contacts;
  StageClock& clock = scratch.clock;
  NarrowPhase phase = [&] {
    const auto timed = clock.time(Stage::kNarrowPhase);
    return NarrowPhase(workpiece, burr.field, world_from_tool, reach_m, scratch, result);
  }();
  for (bool more = true; more;) {
    const std::size_t first = contacts.size();
    {
      const auto timed = clock.time(Stage::kNarrowPhase);
      more = phase.next();
    }
    if (contacts.size() > scratch.capacity) return false;
    {
      const auto timed = clock.time(Stage::kNormals);
      normals(workpiece, settings, kept, scratch, first);
    }
    const auto timed = clock.time(Stage::kContactForce);
    if (more) force.measure(contacts);
  }
  return true;
}

/// Stage by stage, of the deepest that the capacity holds.
void find_deepest(const Workpiece& workpiece, const Burr& burr, const Pose& world_from_tool,
                  double reach_m, const HapticsSettings& settings, const KeptNormals* kept,
                  ContactScratch& scratch, ContactResult& result) {
  {
    const auto timed = scratch.clock.time(Stage::kNarrowPhase);
    result.tested = 0;
    narrow_phase(workpiece, burr.field, world_from_tool, reach_m, scratch, result);
  }
  const auto timed = scratch.clock.time(Stage::kNormals);
  normals(workpiece, settings, kept, scratch);
}

}  // namespace

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
  std::optional<ContactForce> force(std::in_place, workpiece, burr, world_from_tool,
                                    settings.scaling, asked);
  if (!find_in_blocks(workpiece, burr, world_from_tool, reach_m, settings, kept, scratch, result,
                      *force)) {
    find_deepest(workpiece, burr, world_from_tool, reach_m, settings, kept, scratch, result);
    force.emplace(workpiece, burr, world_from_tool, settings.scaling, asked);
  }
  const auto timed = scratch.clock.time(Stage::kContactForce);
  force->sum(tissues, twist, scratch.contacts, result);
  return result;
}

}  // namespace sulcus
