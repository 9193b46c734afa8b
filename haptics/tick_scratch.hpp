#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/scene/scene.hpp"
#include "engine/volume/edit.hpp"
#include "haptics/contact/evaluate_contact.hpp"

namespace sulcus {

/// Of one body: memory and result of its last evaluation.
struct BodyScratch {
  ContactScratch contact;
  ContactResult result;
};

/// Memory of a tick, taken when the scene loads.
struct TickScratch {
  explicit TickScratch(const Scene& scene, StageClock clock = StageClock{});
  static constexpr std::size_t kMaxLoose = 4096;

  /// Clears the results of the last evaluation of each.
  void clear_results() noexcept;
  /// Of what is done for all bodies at once.
  StageClock& clock() noexcept { return bodies.front().contact.clock; }
  void reset_clocks() noexcept;
  /// Of all bodies, since the clocks were reset.
  std::uint64_t stage_ns(Stage stage) const noexcept;
  std::size_t contact_bytes() const;

  std::vector<BodyScratch> bodies;  // as SimulationState::bodies
  std::vector<NearBody> near;       // of the last evaluation
  std::vector<Edit> edits;          // of this tick
  std::vector<double> removing;     // share of the work by tissue of the scene; none: all of it
};

}  // namespace sulcus
