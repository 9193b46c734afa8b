#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/volume/edit.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact/contact.hpp"
#include "haptics/cut_state.hpp"

namespace sulcus {

/// What cutting keeps from one tick to the next, and the energy it has accounted for.
struct RemovalState {
  explicit RemovalState(const CuttingSettings& settings)
      : part_cut(static_cast<std::uint32_t>(settings.max_cut_voxels)) {}

  CutState part_cut;
  double carried_J = 0.0;                           // had been stored in voxels of loose pieces
  double pool_J = 0.0;                              // work done that no voxel in contact could take
  double work_J = 0.0;                              // of the tangential force, all ticks
  double removed_J = 0.0;                           // spent on voxels that are gone
  std::array<std::uint64_t, 256> removed_voxels{};  // by tissue label

  /// In part-cut voxels, those of loose pieces too, and the pool, counted there: with removed_J it
  /// makes up work_J. Walks all part-cut voxels.
  double stored_J() const { return part_cut.total_energy() + carried_J + pool_J; }
  std::uint64_t hash() const;
};

/// Whether `removal` may have them: one power that is not a number would go into the pool, and with
/// it into every voxel that comes.
bool has_finite_powers(const Contacts& contacts) noexcept;

/// Volume removal [Kim and Park 2019, eq. 6] as conservation of energy: the work of each contact's
/// tangential force in a tick is spent on its voxel, which goes when it has received its tissue's
/// specific cutting energy times its volume. (The paper divides by fracture toughness, which orders
/// dental tissues wrongly.) What a voxel does not need goes in equal shares to the voxels in
/// contact that still stand, and what none can take, or less than a hundredth of the tick's work,
/// waits in the pool for the next contact; nothing is lost. Removed voxels are appended to `edits`,
/// which has room for every contact. Returns fault bits.
std::uint32_t removal(Workpiece& workpiece, std::span<const TissueSettings> tissues, double dt_s,
                      std::uint64_t tick, const ContactScratch& scratch, RemovalState& state,
                      std::vector<Edit>& edits) noexcept;

/// Takes voxels (VoxelGrid::linear) of pieces that were cut loose out of the workpiece, and what
/// cutting had stored in them out of the table. Those that are not solid any more are skipped.
/// Appended to `edits`, which has room for them.
void remove_loose(Workpiece& workpiece, std::span<const std::uint32_t> voxels, std::uint64_t tick,
                  RemovalState& state, std::vector<Edit>& edits) noexcept;

}  // namespace sulcus
