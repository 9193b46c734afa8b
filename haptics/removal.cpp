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

/// Cuts voxels that carry fractions: first each contact's own voxel, then, where that is gone, the
/// first voxel beneath it, and so on, so that the order of the contacts, which is the grid's, does
/// not matter. But where columns along different axes meet in a voxel that has not enough for both.
class FillCut {
 public:
  FillCut(Workpiece& workpiece, std::span<const TissueSettings> tissues, std::uint64_t tick,
          RemovalState& state, std::vector<Edit>& edits)
      : workpiece_(workpiece),
        tissues_(tissues),
        level_m3_(workpiece.grid().voxel_volume_m3() / kFullLevel),
        tick_(tick),
        state_(state),
        edits_(edits) {}

  /// Spends energy on the contact's own voxel. What of it is left waits there: less than a level,
  /// or where the voxel is gone, what more of the contact's column lies in the burr. All else is
  /// heat. Returns whether it is gone.
  bool cut_own(const Contact& contact, double spent_J) noexcept {
    const std::uint32_t key = contact.key();
    double left_J = state_.part_cut.energy(key) + spent_J;
    state_.part_cut.set_energy(key, 0.0);
    const double level_J = energy_of_level_J(contact);
    const int room = levels_in_burr(contact), levels = levels_of(left_J, level_J, room);
    const int gone = lower(contact.cell, levels, contact.tissue);
    spend(contact, gone * level_J);
    left_J += std::exchange(waited_J_, 0.0) - gone * level_J;
    const bool is_gone = !workpiece_.solid(contact.cell);
    const double most_J = is_gone ? (room - gone + 1) * level_J : level_J;
    if (left_J < most_J) {
      wait(contact, contact.cell, left_J);
    } else {
      // Beyond the burr nothing is cut.
      const double kept_J = is_gone ? (room - gone) * level_J : 0.0;
      wait(contact, contact.cell, kept_J);
      heat(contact, left_J - kept_J);
    }
    return is_gone;
  }
  /// Spends what waits in the contact's voxel that is gone on the `n`th voxel inward of it, along
  /// the axis that the normal is nearest to, if it is of the same tissue. Where the normal is as
  /// near to another axis, as on an edge, half is spent along each. What is gone already is passed
  /// over. Returns whether there is more to cut beneath.
  bool cut_beneath(const Contact& contact, int n) noexcept {
    if (workpiece_.solid(contact.cell)) return false;
    double left_J = state_.part_cut.energy(contact.key());
    if (!(left_J > 0.0)) return false;
    state_.part_cut.set_energy(contact.key(), 0.0);
    const double level_J = energy_of_level_J(contact);
    const int room = levels_in_burr(contact);
    const Columns columns = columns_of(contact);
    int open = 0;  // to the nth
    for (int k = 0; k < columns.count; ++k) open += first_solid(columns, k, n - 1) == 0 ? 1 : 0;
    int gone = 0;
    bool more = false;
    const int levels = levels_of(left_J, level_J, room) / std::max(open, 1);
    for (int k = 0; k < columns.count; ++k) {
      if (first_solid(columns, k, n - 1) != 0) continue;
      const Cell cell = columns.cell(k, n);
      if (stands(cell, contact.tissue)) gone += lower(cell, levels, contact.tissue);
      more |= !workpiece_.solid(cell);
    }
    spend(contact, gone * level_J);
    left_J += std::exchange(waited_J_, 0.0) - gone * level_J;
    if (more && n <= room / kFullLevel) {
      wait(contact, contact.cell, left_J);
      return true;
    }
    // Less than a level waits where each column ends.
    const double share_J = left_J / columns.count;
    for (int k = 0; k < columns.count; ++k) {
      const Cell end = columns.cell(k, first_solid(columns, k, n));
      const bool may_wait = share_J < level_J && stands(end, contact.tissue);
      may_wait ? wait(contact, end, share_J) : heat(contact, share_J);
    }
    return false;
  }
  /// Of the contact, J.
  void heat(const Contact& contact, double heat_J) noexcept {
    state_.heat_J += heat_J;
    state_.by_tissue[contact.tissue].heat_J += heat_J;
  }
  std::uint32_t faults() const { return faults_; }

 private:
  static constexpr int kMostLevels = 8 * kFullLevel;  // of a contact, in a tick
  /// Components of a normal that are equal but for rounding.
  static constexpr float kEqualAxes = 1.0f - 1e-4f;

  double energy_of_level_J(const Contact& contact) const noexcept {
    return tissues_[contact.tissue].specific_energy_J_per_m3 * level_m3_;
  }
  /// Levels of the contact's column that lie in the burr.
  int levels_in_burr(const Contact& contact) const noexcept {
    const float along = contact.normal.cwiseAbs().maxCoeff();
    if (!(along > 0.0f)) return 0;
    const double inside = kFullLevel * static_cast<double>(contact.depth_m) /
                          (workpiece_.grid().voxel_m * static_cast<double>(along));
    return static_cast<int>(std::clamp(std::lround(inside), 0L, long{kMostLevels}));
  }
  static int levels_of(double energy_J, double level_J, int most) noexcept {
    return static_cast<int>(std::min(energy_J / level_J, static_cast<double>(most)));
  }
  bool stands(const Cell& cell, std::uint8_t tissue) const noexcept {
    return workpiece_.solid(cell) && workpiece_.tissue(cell) == tissue;
  }
  void spend(const Contact& contact, double spent_J) noexcept {
    state_.removed_J += spent_J;
    state_.by_tissue[contact.tissue].removed_J += spent_J;
  }
  /// Adds to what waits in a voxel, where the table has room for it.
  void wait(const Contact& contact, const Cell& cell, double energy_J) noexcept {
    const std::uint32_t key = voxel_key(cell);
    if (state_.part_cut.set_energy(key, state_.part_cut.energy(key) + energy_J)) return;
    faults_ |= kFaultCutStateFull;
    heat(contact, energy_J);
  }
  /// Those beneath a contact, as its normal says.
  struct Columns {
    Cell from;
    std::array<Cell, 3> inward;
    int count = 0;
    Cell cell(int k, int n) const { return from + n * inward[static_cast<std::size_t>(k)]; }
  };
  static Columns columns_of(const Contact& contact) noexcept {
    Columns columns;
    columns.from = contact.cell;
    const Eigen::Vector3f sizes = contact.normal.cwiseAbs();
    for (int axis = 0; axis < 3; ++axis) {
      if (sizes[axis] < kEqualAxes * sizes.maxCoeff()) continue;
      const Cell along = Cell::Unit(axis);
      columns.inward[static_cast<std::size_t>(columns.count++)] =
          contact.normal[axis] > 0.0f ? Cell(-along) : along;
    }
    return columns;
  }
  /// Which of a column's first `n` voxels beneath the contact is solid; 0: none.
  int first_solid(const Columns& columns, int k, int n) const noexcept {
    for (int m = 1; m <= n; ++m) {
      if (workpiece_.solid(columns.cell(k, m))) return m;
    }
    return 0;
  }
  /// Takes up to so many levels off a voxel. Returns how many; none where there is no room for what
  /// that changes.
  int lower(const Cell& cell, int levels, std::uint8_t tissue) noexcept {
    const int level = workpiece_.level(cell), taken = std::min(levels, level);
    if (taken == 0) return 0;
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
  std::span<const TissueSettings> tissues_;
  double level_m3_;
  std::uint64_t tick_;
  RemovalState& state_;
  std::vector<Edit>& edits_;
  double waited_J_ = 0.0;  // in voxels that have gone since it was last asked for
  std::uint32_t faults_ = 0;
};

/// As `removal`, of a workpiece with fractions.
std::uint32_t remove_fills(Workpiece& workpiece, std::span<const TissueSettings> tissues,
                           double dt_s, std::uint64_t tick, const ContactScratch& scratch,
                           std::span<const double> removing, RemovalState& state,
                           std::vector<Edit>& edits) noexcept {
  FillCut cut(workpiece, tissues, tick, state, edits);
  const Contacts& contacts = scratch.contacts;
  bool more = false;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact contact = contacts[i];
    if (!(contact.power_W > 0.0f)) continue;
    const double work_J = static_cast<double>(contact.power_W) * dt_s;
    state.work_J += work_J;
    state.by_tissue[contact.tissue].work_J += work_J;
    const double spent_J = removing.empty() ? work_J : work_J * removing[contact.tissue];
    cut.heat(contact, work_J - spent_J);
    more |= cut.cut_own(contact, spent_J);
  }
  for (int n = 1; more; ++n) {
    more = false;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Contact contact = contacts[i];
      if (contact.power_W > 0.0f) more |= cut.cut_beneath(contact, n);
    }
  }
  return cut.faults();
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
