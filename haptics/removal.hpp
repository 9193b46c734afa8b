#pragma once

#include <array>
#include <span>
#include <vector>

#include "engine/volume/edit.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact/contact.hpp"
#include "haptics/cut_state.hpp"

namespace sulcus {

/// Where the work on a tissue has gone, J: it is what was removed, stored and carried, and heat.
struct TissueEnergy {
  double work_J = 0.0;     // of the tangential force on its voxels, all ticks
  double removed_J = 0.0;  // spent on its voxels that are gone
  double heat_J = 0.0;     // what the voxel that it was done on could not take
  double carried_J = 0.0;  // had been stored in its voxels of loose pieces

  bool operator==(const TissueEnergy&) const = default;
};

/// What cutting keeps from one tick to the next, and the energy it has accounted for.
struct RemovalState {
  explicit RemovalState(const CuttingSettings& settings)
      : part_cut(static_cast<std::uint32_t>(settings.max_cut_voxels)) {}

  CutState part_cut;
  // Of all tissues, as in TissueEnergy.
  double carried_J = 0.0, heat_J = 0.0, work_J = 0.0, removed_J = 0.0;
  std::array<std::uint64_t, 256> removed_voxels{};  // by tissue label
  std::array<TissueEnergy, 256> by_tissue{};        // by tissue label

  /// In part-cut voxels, those of loose pieces too: with removed_J and heat_J it makes up work_J.
  /// Walks all part-cut voxels.
  double stored_J() const { return part_cut.total_energy() + carried_J; }
  /// The same of each tissue, by label; `workpiece` is what is cut.
  std::array<double, 256> stored_by_tissue_J(const Workpiece& workpiece) const;
  std::uint64_t hash() const;
};

/// Whether `removal` may have them: one power that is not a number would stay in every sum.
bool has_finite_powers(const Contacts& contacts) noexcept;

/// Volume removal [Kim and Park 2019, eq. 6] as conservation of energy: the work of each contact's
/// tangential force in a tick, or of it the share that `removing` has for its tissue, is spent on
/// its own voxel, which goes when it has received its tissue's specific cutting energy times its
/// volume. (The paper divides by fracture toughness, which orders dental tissues wrongly, and does
/// not say what becomes of a part of a voxel.) What a voxel does not need when it goes, or has no
/// room for in the table, cuts no other: like the rest beside that share it is heat within the
/// tick, and counted. So removed + stored + heat = work, in all and for each tissue. `removing`: by
/// tissue, beside `tissues`; empty: all of the work removes. Removed voxels are appended to
/// `edits`, which has room for every contact. Returns fault bits.
///
/// With fractions the work lowers fills instead: of the contact's voxel, and once that is gone of
/// those of its tissue beneath it, along the axis its normal is nearest to; never more than what of
/// the contact's column lies in the burr, its depth times the area that it stands for. A 255th of a
/// voxel is the least that goes; the energy for less waits in the table. Each voxel that changed is
/// appended to `edits`, with its level; where there is no more room the work is heat.
std::uint32_t removal(Workpiece& workpiece, std::span<const TissueSettings> tissues, double dt_s,
                      std::uint64_t tick, const ContactScratch& scratch,
                      std::span<const double> removing, RemovalState& state,
                      std::vector<Edit>& edits) noexcept;

/// Takes voxels (VoxelGrid::linear) of pieces that were cut loose out of the workpiece, and what
/// cutting had stored in them out of the table. Those that are not solid any more are skipped.
/// Appended to `edits`, which has room for them.
void remove_loose(Workpiece& workpiece, std::span<const std::uint32_t> voxels, std::uint64_t tick,
                  RemovalState& state, std::vector<Edit>& edits) noexcept;

}  // namespace sulcus
