#pragma once

#include <cstdint>
#include <optional>

#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact/contact.hpp"
#include "haptics/contact/contact_frame.hpp"

namespace sulcus {

/// Surface voxels of `scratch.leaves` whose centre is nearer to the burr than `reach_m` (0 where
/// depth is measured at centres), by trilinear interpolation of its distance field, in the order of
/// the leaves. A leaf farther from the burr than its own half diagonal is skipped by one sample at
/// its centre. They come block by block, for who goes on with each while it is in the caches.
class NarrowPhase {
 public:
  /// Takes the leaves' distances; the contacts are none yet. All that is named outlives this.
  NarrowPhase(const Workpiece& workpiece, const DistanceField& field, const Pose& world_from_tool,
              double reach_m, ContactScratch& scratch) noexcept;

  /// Adds the contacts of as many leaves as fit a block to `scratch.contacts` and `scratch.block`;
  /// false where these were the last. There must be no more contacts than `scratch.capacity`; after
  /// it there may be.
  bool next() noexcept;
  /// Begins again, with the deepest contacts alone, as many as `scratch.capacity`: of those equally
  /// deep the voxels of lower key.
  void begin_with_deepest() noexcept;
  /// Voxels whose distance was asked for since it began.
  std::uint32_t tested() const { return tested_; }

 private:
  void begin() noexcept;
  void test(std::size_t waiting) noexcept;
  std::size_t drop_shallow(std::size_t first, std::size_t end) noexcept;
  void label(std::size_t first) noexcept;
  std::uint64_t depth_order(std::size_t contact) const noexcept;

  const Workpiece& workpiece_;
  ContactFrame frame_;
  float reach_m_, leaf_reach_m_;
  ContactScratch& scratch_;
  std::size_t leaf_ = 0;
  std::uint32_t tested_ = 0;
  std::optional<std::uint64_t> deepest_;  // depth_order of the last that counts; none: all do
};

}  // namespace sulcus
