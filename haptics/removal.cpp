#include "haptics/removal.hpp"

#include "engine/recording/tick_record.hpp"

namespace sulcus {

std::uint32_t removal(Workpiece& workpiece, std::span<const TissueSettings> tissues, double dt_s,
                      std::uint64_t tick, const ContactScratch& scratch, RemovalState& state,
                      std::vector<Edit>& edits) noexcept {
  std::uint32_t faults = 0;
  const double voxel_m3 = workpiece.grid().voxel_volume_m3();

  /// Gives a voxel energy; what it has over when it goes flows back into the pool.
  const auto spend = [&](const Contact& contact, double energy_J) {
    const std::uint8_t tissue = workpiece.tissue(contact.cell);
    const double needed_J = tissues[tissue].specific_energy_J_per_m3 * voxel_m3;
    const double stored_J = state.part_cut.energy(contact.voxel) + energy_J;
    if (stored_J < needed_J) {
      if (!state.part_cut.set_energy(contact.voxel, stored_J)) {
        state.pool_J += energy_J;
        faults |= kFaultCutStateFull;
      }
      return;
    }
    state.part_cut.set_energy(contact.voxel, 0.0);
    state.pool_J += stored_J - needed_J;
    state.removed_J += needed_J;
    ++state.removed_voxels[tissue];
    workpiece.remove(contact.cell);
    edits.push_back({tick, contact.voxel, 0, EditCause::kCut});
  };

  std::uint32_t standing = 0;
  for (const Contact& contact : scratch.contacts) {
    if (contact.power_W <= 0.0) continue;
    const double work_J = contact.power_W * dt_s;
    state.work_J += work_J;
    spend(contact, work_J);
    standing += workpiece.solid(contact.cell);
  }
  // A share that fells a voxel may leave something over again. Each round either fells one or
  // empties the pool; a few rounds reach the end of all but a flood, which waits for the next tick.
  for (int round = 0; round < 4 && state.pool_J > 0.0 && standing > 0; ++round) {
    const double share_J = state.pool_J / standing;
    state.pool_J = 0.0;
    standing = 0;
    for (const Contact& contact : scratch.contacts) {
      if (contact.power_W <= 0.0 || !workpiece.solid(contact.cell)) continue;
      spend(contact, share_J);
      standing += workpiece.solid(contact.cell);
    }
  }
  return faults;
}

}  // namespace sulcus
