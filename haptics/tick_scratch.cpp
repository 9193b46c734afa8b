#include "haptics/tick_scratch.hpp"

namespace sulcus {

TickScratch::TickScratch(const Scene& scene, StageClock clock) {
  std::size_t cuttable = 1;
  for (const BodySettings& body : scene.bodies) cuttable += body.cuttable ? 1 : 0;
  bodies.reserve(1 + scene.bodies.size());
  while (bodies.size() < bodies.capacity()) {
    bodies.push_back({ContactScratch(scene.haptics, clock), {}});
  }
  near.reserve(bodies.size());
  if (!scene.cutting) return;
  if (scene.cutting->law == CuttingLaw::kSaturating) removing.resize(scene.tissues.size());
  // With fractions a contact may change a voxel and the one beneath.
  bool fractions = scene.workpiece.surface == SurfaceKind::kFractions;
  for (const BodySettings& body : scene.bodies) {
    fractions = fractions || body.solid.surface == SurfaceKind::kFractions;
  }
  edits.reserve(bodies.front().contact.capacity * cuttable * (fractions ? 2 : 1) +
                (scene.loose_pieces ? kMaxLoose : 0));
}

void TickScratch::clear_results() noexcept {
  near.clear();
  for (BodyScratch& body : bodies) {
    body.contact.clear_results();
    body.result = {};
  }
}

void TickScratch::reset_clocks() noexcept {
  for (BodyScratch& body : bodies) body.contact.clock.reset();
}

std::uint64_t TickScratch::stage_ns(Stage stage) const noexcept {
  std::uint64_t ns = 0;
  for (const BodyScratch& body : bodies) ns += body.contact.clock.ns(stage);
  return ns;
}

std::size_t TickScratch::contact_bytes() const {
  std::size_t bytes = 0;
  for (const BodyScratch& body : bodies) bytes += body.contact.memory_bytes();
  return bytes;
}

}  // namespace sulcus
