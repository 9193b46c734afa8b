#include "haptics/removal.hpp"

#include <limits>

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

std::uint32_t removal(Workpiece& workpiece, std::span<const TissueSettings> tissues, double dt_s,
                      std::uint64_t tick, const ContactScratch& scratch, RemovalState& state,
                      std::vector<Edit>& edits) noexcept {
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
    const CutState::Spent spent = state.part_cut.add_energy(key, work_J, needed_J);
    state.work_J += work_J;
    energy.work_J += work_J;
    state.heat_J += spent.over_J;
    energy.heat_J += spent.over_J;
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
