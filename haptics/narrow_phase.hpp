#pragma once

#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact.hpp"
#include "haptics/contact_frame.hpp"

namespace sulcus {

/// Surface voxels of `scratch.leaves` whose centre is nearer to the burr than `reach_m` (0 where
/// depth is measured at centres), by trilinear interpolation of its distance field, into
/// `scratch.contacts` in the order of the leaves; adds to `result.tested`. A leaf farther from the
/// burr than its own half diagonal is passed over by one sample at its centre. Beyond the
/// capacity the deepest are kept, in the same order, and kFaultContactsFull is set.
void narrow_phase(const Workpiece& workpiece, const DistanceField& field,
                  const Pose& world_from_tool, double reach_m, ContactScratch& scratch,
                  ContactResult& result) noexcept;

/// The same block by block, for who goes on with each while it is in the caches.
class NarrowPhase {
 public:
  /// Takes the leaves' distances; the contacts are none yet. All that is named outlives this.
  NarrowPhase(const Workpiece& workpiece, const DistanceField& field, const Pose& world_from_tool,
              double reach_m, ContactScratch& scratch, ContactResult& result) noexcept;

  /// Adds the contacts of as many leaves as fit a block (ContactScratch::kBlock); false where these
  /// were the last. There must be no more contacts than `scratch.capacity`; after it there may be.
  bool next() noexcept;

 private:
  void test(std::size_t waiting) noexcept;
  void label(std::size_t first) noexcept;

  const Workpiece& workpiece_;
  ContactFrame frame_;
  float reach_m_, leaf_reach_m_;
  ContactScratch& scratch_;
  ContactResult& result_;
  std::size_t leaf_ = 0;
};

}  // namespace sulcus
