#include "haptics/removal.hpp"

#include <limits>

#include "engine/core/fault.hpp"
#include "engine/core/hash.hpp"
#include "haptics/state_fields.hpp"

namespace sulcus {

namespace {

constexpr double kLittle = 0.01;    // of a tick's work
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

std::uint32_t removal(Workpiece& workpiece, std::span<const TissueSettings> tissues, double dt_s,
                      std::uint64_t tick, const ContactScratch& scratch, RemovalState& state,
                      std::vector<Edit>& edits) noexcept {
  std::uint32_t faults = 0;
  const double voxel_m3 = workpiece.grid().voxel_volume_m3();

  const Contacts& contacts = scratch.contacts;
  const float* const power_W = contacts(Contacts::kPower);
  // Gives a voxel energy; what it has over when it goes flows back into the pool. Whether it still
  // stands.
  const auto spend = [&](std::size_t i, double energy_J) {
    const std::uint32_t key = contacts.keys()[i];
    const std::uint8_t tissue = contacts.tissues()[i];
    const double needed_J = tissues[tissue].specific_energy_J_per_m3 * voxel_m3;
    const CutState::Spent spent = state.part_cut.add_energy(key, energy_J, needed_J);
    state.pool_J += spent.over_J;
    if (!spent.full) {
      if (spent.over_J > 0.0) faults |= kFaultCutStateFull;
      return true;
    }
    state.removed_J += needed_J;
    ++state.removed_voxels[tissue];
    const Cell cell = cell_of_key(key);
    workpiece.remove(cell);
    edits.push_back({tick, workpiece.grid().linear(cell), 0, EditCause::kCut});
    return false;
  };

  const auto stands = [&](std::size_t i) {
    return workpiece.solid(cell_of_key(contacts.keys()[i]));
  };
  std::uint32_t standing = 0;
  const double before_J = state.work_J;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (const std::size_t next = i + kAhead; next < contacts.size() && power_W[next] > 0.0f) {
      state.part_cut.prefetch(contacts.keys()[next]);
    }
    if (!(power_W[i] > 0.0f)) continue;
    const double work_J = static_cast<double>(power_W[i]) * dt_s;
    state.work_J += work_J;
    standing += spend(i, work_J);
  }
  // A share that fells a voxel may leave something over again. Each round either fells one or
  // empties the pool; a few rounds reach the end of all but a flood, which waits for the next tick.
  // So does what is too little to be worth going over all contacts again.
  const double little_J = kLittle * (state.work_J - before_J);
  for (int round = 0; round < 4 && state.pool_J > little_J && standing > 0; ++round) {
    const double share_J = state.pool_J / standing;
    state.pool_J = 0.0;
    standing = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (power_W[i] > 0.0f && stands(i)) standing += spend(i, share_J);
    }
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
    state.carried_J += state.part_cut.energy(key);
    state.part_cut.set_energy(key, 0.0);
    edits.push_back({tick, voxel, 0, EditCause::kLoose});
  }
}

}  // namespace sulcus
