#include "haptics/contact/contact.hpp"

#include <algorithm>

#include "haptics/contact/contact_kernels.hpp"

namespace sulcus {

ContactResult& ContactResult::operator+=(const ContactResult& other) noexcept {
  wrench.force_N += other.wrench.force_N;
  wrench.torque_Nm += other.wrench.torque_Nm;
  tangential.force_N += other.tangential.force_N;
  tangential.torque_Nm += other.tangential.torque_Nm;
  stiffness += other.stiffness;
  weight_growth += other.weight_growth;
  contacts += other.contacts;
  deepest_m = std::max(deepest_m, other.deepest_m);
  tested += other.tested;
  leaves += other.leaves;
  faults |= other.faults;
  return *this;
}

ContactScratch::ContactScratch(const HapticsSettings& settings, StageClock stage_clock)
    : clock(stage_clock),
      capacity(static_cast<std::size_t>(settings.max_contacts)),
      contacts(capacity + ContactBlock::kVoxels) {
  leaves.reserve(kMaxLeaves);
  emptied_nodes.reserve(kMaxLeaves);
  leaf_keys.reserve(kMaxLeaves);
  leaf_distances_m.reserve(kMaxLeaves);
  block_keys.resize(ContactBlock::kVoxels + Contacts::kGroup);
  cached_leaves.reserve(kMaxLeaves);
  queries.reserve(capacity);
  queried.reserve(capacity);
  estimates.reserve(capacity);
  vetoed.reserve(capacity);
  tool_queries.reserve(capacity);
  tool_estimates.reserve(capacity);
  by_depth.reserve(capacity + ContactBlock::kVoxels);
  prepare_normals();
  contact_kernels();  // chosen here, not in a tick
}

void ContactScratch::clear_results() noexcept {
  contacts.clear();
  block.clear();
  emptied_nodes.clear();
  queried.clear();
  cached_leaves.clear();
}

std::size_t ContactScratch::memory_bytes() const {
  const std::size_t words = leaves.capacity() + emptied_nodes.capacity() + leaf_keys.capacity() +
                            leaf_distances_m.capacity() + block_keys.capacity() +
                            queried.capacity() + vetoed.capacity();
  return words * sizeof(std::uint32_t) + by_depth.capacity() * sizeof(std::uint64_t) +
         contacts.memory_bytes() + ContactBlock::memory_bytes() +
         cached_leaves.capacity() * sizeof(NormalCache::Place) +
         (queries.capacity() + tool_queries.capacity()) * sizeof(VoxelQuery) +
         (estimates.capacity() + tool_estimates.capacity()) * sizeof(SurfaceEstimate);
}

}  // namespace sulcus
