#include "haptics/tick_scratch.hpp"

namespace sulcus {

TickScratch::TickScratch(const Scene& scene, StageClock clock) : contact(scene.haptics, clock) {
  std::size_t cut = 1;
  neighbours.reserve(scene.bodies.size());
  for (const BodySettings& body : scene.bodies) {
    neighbours.push_back({ContactScratch(scene.haptics, clock), {}});
    cut += body.cuttable ? 1 : 0;
  }
  if (scene.cutting) edits.reserve(contact.capacity * cut + (scene.loose_pieces ? kMaxLoose : 0));
}

void TickScratch::forget() noexcept {
  contact.forget();
  for (NeighbourScratch& neighbour : neighbours) {
    neighbour.contact.forget();
    neighbour.found = {};
  }
}

void TickScratch::reset_clocks() noexcept {
  contact.clock.reset();
  for (NeighbourScratch& neighbour : neighbours) neighbour.contact.clock.reset();
}

std::uint64_t TickScratch::stage_ns(Stage stage) const noexcept {
  std::uint64_t ns = contact.clock.ns(stage);
  for (const NeighbourScratch& neighbour : neighbours) ns += neighbour.contact.clock.ns(stage);
  return ns;
}

std::size_t TickScratch::contact_bytes() const {
  std::size_t bytes = contact.memory_bytes();
  for (const NeighbourScratch& neighbour : neighbours) bytes += neighbour.contact.memory_bytes();
  return bytes;
}

}  // namespace sulcus
