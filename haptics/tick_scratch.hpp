#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/recording/tick_record.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/edit.hpp"
#include "haptics/contact.hpp"

namespace sulcus {

/// Of one neighbour: what its last evaluation used and found.
struct NeighbourScratch {
  ContactScratch contact;
  ContactResult found;
};

/// Memory of a tick, taken when the scene loads.
struct TickScratch {
  explicit TickScratch(const Scene& scene, StageClock clock = StageClock{});
  static constexpr std::size_t kMaxLoose = 4096;

  /// What evaluations have found, as if they had found nothing.
  void forget() noexcept;
  void reset_clocks() noexcept;
  /// Of the contacts with all bodies, since the clocks were reset.
  std::uint64_t stage_ns(Stage stage) const noexcept;
  std::size_t contact_bytes() const;

  ContactScratch contact;
  std::vector<NeighbourScratch> neighbours;  // one for each [[body]]
  std::vector<Edit> edits;                   // of this tick
  CuttingRecord cutting;                     // of this tick, with [cutting]
  PortRecord port;                           // of this tick
};

}  // namespace sulcus
