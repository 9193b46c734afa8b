#include "haptics/contact/far_fills.hpp"

#include "engine/normals/filled_columns.hpp"

namespace sulcus {

void move_contact(ContactScratch& scratch, std::size_t from, std::size_t to) noexcept {
  if (from == to) return;
  Contacts& contacts = scratch.contacts;
  contacts.keys()[to] = contacts.keys()[from];
  contacts.tissues()[to] = contacts.tissues()[from];
  contacts.set_vector(Contacts::kNormal, to, contacts.vector(Contacts::kNormal, from));
  const std::size_t block = scratch.block.first();
  for (std::size_t q = 0; q < ContactBlock::kQuantities; ++q) {
    scratch.block(q)[to - block] = scratch.block(q)[from - block];
  }
}

void drop_far_fills(const Workpiece& workpiece, std::size_t first,
                    ContactScratch& scratch) noexcept {
  // Between its samples the burr's distance may rise by a little more than the way.
  constexpr float kSteepest = 1.1f;
  // As far as this nothing is dropped, however it is rounded.
  constexpr float kEnough = 1.001f / kSteepest;
  const auto voxel_m = static_cast<float>(workpiece.grid().voxel_m);
  LevelReader levels(workpiece.model());
  std::size_t kept = first;
  for (std::size_t i = first; i < scratch.contacts.size(); ++i) {
    const float distance_m = scratch.block(ContactBlock::kDistance)[i - scratch.block.first()];
    if (distance_m > 0.0f) {
      const auto farthest =
          farthest_surface(workpiece, levels, cell_of_key(scratch.contacts.keys()[i]),
                           kEnough * (distance_m / voxel_m));
      if (farthest && distance_m > kSteepest * *farthest * voxel_m) continue;
    }
    move_contact(scratch, i, kept++);
  }
  scratch.contacts.resize(kept);
  scratch.block.set_end(kept);
}

}  // namespace sulcus
