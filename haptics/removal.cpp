#include "haptics/removal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/fault.hpp"
#include "engine/core/hash.hpp"
#include "haptics/state_fields.hpp"

namespace sulcus {

namespace {

constexpr std::size_t kAhead = 16;  // so many contacts ahead their memory is asked for

}  // namespace

std::uint64_t RemovalState::hash() const {
  const std::uint64_t numbers =
      fields::hash_of([this](auto& archive) { fields::removal(archive, *this); });
  return hash_bytes(&numbers, sizeof(numbers), part_cut.hash());
}

bool has_finite_powers(const Contacts& contacts) noexcept {
  const float* const power_W = contacts(Contacts::kPower);
  bool finite = true;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    finite &= power_W[i] <= std::numeric_limits<float>::max();
  }
  return finite;
}

std::array<double, 256> RemovalState::stored_by_tissue_J(const Workpiece& workpiece) const {
  std::array<double, 256> stored_J{};
  for (std::size_t tissue = 0; tissue < stored_J.size(); ++tissue) {
    stored_J[tissue] = by_tissue[tissue].carried_J;
  }
  part_cut.for_each([&](std::uint32_t key, double energy_J) {
    stored_J[workpiece.tissue(cell_of_key(key))] += energy_J;
  });
  return stored_J;
}

namespace {

/// Cuts voxels that carry fractions.
class FillCut {
 public:
  FillCut(Workpiece& workpiece, std::uint64_t tick, RemovalState& state, std::vector<Edit>& edits)
      : workpiece_(workpiece), tick_(tick), state_(state), edits_(edits) {}

  /// Spends energy on what lies in the burr at a contact: its column, along the axis that its
  /// normal is nearest to, from its voxel inward, to the contact's depth and while it is of the
  /// same tissue.
  struct Spent {
    double removed_J = 0.0;  // on levels that are gone
    Cell cell;               // where it ended
  };
  Spent cut(const Contact& contact, double level_J, double energy_J) noexcept {
    int axis = 0;
    const float along = contact.normal.cwiseAbs().maxCoeff(&axis);
    if (!(along > 0.0f)) return {0.0, contact.cell};
    const double inside = kFullLevel * static_cast<double>(contact.depth_m) /
                          (workpiece_.grid().voxel_m * static_cast<double>(along));
    const auto room = static_cast<int>(std::min(std::lround(inside), long{kMostLevels}));
    int levels = static_cast<int>(std::min(energy_J / level_J, static_cast<double>(room)));
    Cell cell = contact.cell;
    const int inward = contact.normal[axis] > 0.0f ? -1 : 1;
    int gone = 0;
    while (levels > 0 && stands(cell, contact.tissue)) {
      const int taken = lower(cell, levels, contact.tissue);
      if (taken == 0) break;
      gone += taken;
      levels -= taken;
      if (!workpiece_.solid(cell)) cell[axis] += inward;
    }
    return {gone * level_J, cell};
  }
  bool stands(const Cell& cell, std::uint8_t tissue) const noexcept {
    return workpiece_.solid(cell) && workpiece_.tissue(cell) == tissue;
  }
  /// What waited in voxels that have gone since it was last asked for, J.
  double take_waited_J() noexcept { return std::exchange(waited_J_, 0.0); }
  std::uint32_t faults() const { return faults_; }

 private:
  static constexpr int kMostLevels = 8 * kFullLevel;  // of a contact, in a tick

  /// Takes up to so many levels off a solid voxel. Returns how many; none where there is no room
  /// for what that changes.
  int lower(const Cell& cell, int levels, std::uint8_t tissue) noexcept {
    const int level = workpiece_.level(cell), taken = std::min(levels, level);
    const auto left = static_cast<FillLevel>(level - taken);
    if (edits_.size() == edits_.capacity() || (left != 0 && !workpiece_.set_level(cell, left))) {
      faults_ |= kFaultCutStateFull;
      return 0;
    }
    if (left == 0) {
      workpiece_.remove(cell);
      ++state_.removed_voxels[tissue];
      // What waited in it waits for nothing any more.
      waited_J_ += state_.part_cut.energy(voxel_key(cell));
      state_.part_cut.set_energy(voxel_key(cell), 0.0);
    }
    edits_.push_back({tick_, workpiece_.grid().linear(cell), 0, EditCause::kCut, left});
    return taken;
  }

  Workpiece& workpiece_;
  std::uint64_t tick_;
  RemovalState& state_;
  std::vector<Edit>& edits_;
  double waited_J_ = 0.0;
  std::uint32_t faults_ = 0;
};

/// As `removal`, of a workpiece with fractions.
std::uint32_t remove_fills(Workpiece& workpiece, std::span<const TissueSettings> tissues,
                           double dt_s, std::uint64_t tick, const ContactScratch& scratch,
                           std::span<const double> removing, RemovalState& state,
                           std::vector<Edit>& edits) noexcept {
  FillCut cut(workpiece, tick, state, edits);
  std::uint32_t faults = 0;
  const double level_m3 = workpiece.grid().voxel_volume_m3() / kFullLevel;
  const Contacts& contacts = scratch.contacts;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact contact = contacts[i];
    if (!(contact.power_W > 0.0f)) continue;
    TissueEnergy& energy = state.by_tissue[contact.tissue];
    const double level_J = tissues[contact.tissue].specific_energy_J_per_m3 * level_m3;
    const double work_J = static_cast<double>(contact.power_W) * dt_s;
    state.work_J += work_J;
    energy.work_J += work_J;
    const double spent_J = removing.empty() ? work_J : work_J * removing[contact.tissue];
    double left_J = state.part_cut.energy(contact.key()) + spent_J;
    state.part_cut.set_energy(contact.key(), 0.0);
    const FillCut::Spent spent = cut.cut(contact, level_J, left_J);
    state.removed_J += spent.removed_J;
    energy.removed_J += spent.removed_J;
    left_J += cut.take_waited_J() - spent.removed_J;
    // Less than a level waits in the voxel that it is to be taken from; all else is heat.
    double heat_J = left_J;
    if (left_J < level_J && cut.stands(spent.cell, contact.tissue)) {
      const std::uint32_t key = voxel_key(spent.cell);
      const bool kept = state.part_cut.set_energy(key, state.part_cut.energy(key) + left_J);
      if (kept) heat_J = 0.0;
      if (!kept) faults |= kFaultCutStateFull;
    }
    heat_J += work_J - spent_J;
    state.heat_J += heat_J;
    energy.heat_J += heat_J;
  }
  return faults | cut.faults();
}

}  // namespace

std::uint32_t removal(Workpiece& workpiece, std::span<const TissueSettings> tissues, double dt_s,
                      std::uint64_t tick, const ContactScratch& scratch,
                      std::span<const double> removing, RemovalState& state,
                      std::vector<Edit>& edits) noexcept {
  if (workpiece.has_fills()) {
    return remove_fills(workpiece, tissues, dt_s, tick, scratch, removing, state, edits);
  }
  std::uint32_t faults = 0;
  const double voxel_m3 = workpiece.grid().voxel_volume_m3();
  const Contacts& contacts = scratch.contacts;
  const float* const power_W = contacts(Contacts::kPower);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (const std::size_t next = i + kAhead; next < contacts.size() && power_W[next] > 0.0f) {
      state.part_cut.prefetch(contacts.keys()[next]);
    }
    if (!(power_W[i] > 0.0f)) continue;
    const std::uint32_t key = contacts.keys()[i];
    const std::uint8_t tissue = contacts.tissues()[i];
    TissueEnergy& energy = state.by_tissue[tissue];
    const double work_J = static_cast<double>(power_W[i]) * dt_s;
    const double needed_J = tissues[tissue].specific_energy_J_per_m3 * voxel_m3;
    const double spent_J = removing.empty() ? work_J : work_J * removing[tissue];
    const CutState::Spent spent = state.part_cut.add_energy(key, spent_J, needed_J);
    const double heat_J = spent.over_J + (work_J - spent_J);
    state.work_J += work_J;
    energy.work_J += work_J;
    state.heat_J += heat_J;
    energy.heat_J += heat_J;
    if (!spent.full) {
      if (spent.over_J > 0.0) faults |= kFaultCutStateFull;
      continue;
    }
    state.removed_J += needed_J;
    energy.removed_J += needed_J;
    ++state.removed_voxels[tissue];
    const Cell cell = cell_of_key(key);
    workpiece.remove(cell);
    edits.push_back({tick, workpiece.grid().linear(cell), 0, EditCause::kCut});
  }
  return faults;
}

void remove_loose(Workpiece& workpiece, std::span<const std::uint32_t> voxels, std::uint64_t tick,
                  RemovalState& state, std::vector<Edit>& edits) noexcept {
  for (const std::uint32_t voxel : voxels) {
    const Cell cell = workpiece.grid().cell_of_linear(voxel);
    if (!workpiece.solid(cell)) continue;
    workpiece.remove(cell);
    const std::uint32_t key = voxel_key(cell);
    const double energy_J = state.part_cut.energy(key);
    state.carried_J += energy_J;
    state.by_tissue[workpiece.tissue(cell)].carried_J += energy_J;
    state.part_cut.set_energy(key, 0.0);
    edits.push_back({tick, voxel, 0, EditCause::kLoose});
  }
}

}  // namespace sulcus
