#include "app/playback/recorded_contacts.hpp"

#include <algorithm>
#include <cmath>

namespace sulcus {

RecordedContacts::RecordedContacts(const std::string& path, bool counted)
    : run_(open_recorded_run(path)), state_(run_), counted_(counted) {
  for (const Body& body : run_.simulation->state().bodies) counts_.emplace_back(body.solid.grid());
}

void RecordedContacts::seek_row(std::size_t row) {
  if (state_.next_row() == row + 1) return;  // it is there
  if (!counted_ && row > 0) state_.seek_row(row - 1);
  while (state_.next_row() <= row) {
    if (state_.follows()) {
      look(state_.step_as_recorded());
    } else {
      skip_gap(row);
    }
  }
}

void RecordedContacts::skip_gap(std::size_t row) {
  const std::size_t first = state_.next_row();
  std::size_t to = row;
  for (const KeyframeInfo& keyframe : run_.reader.keyframes()) {
    if (keyframe.tick < run_.rows[first].tick) continue;
    const auto at = std::ranges::lower_bound(run_.rows, keyframe.tick, {}, &TickRecord::tick);
    to = std::min(row, static_cast<std::size_t>(at - run_.rows.begin()));
    break;
  }
  state_.seek_row(to);
  marks_.clear();
  voxels_.clear();
}

void RecordedContacts::look(const TickRecord& again) {
  marks_.clear();
  voxels_.clear();
  if (again.contacts == 0) return;  // nor is what an earlier tick left behind
  const Simulation& simulation = *run_.simulation;
  for (std::size_t body = 0; body < counts_.size(); ++body) {
    const Contacts& contacts = simulation.contacts(body);
    const VoxelGrid& grid = counts_[body].grid();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (!(contacts(Contacts::kWeight)[i] > 0.0f)) continue;
      const Cell cell = cell_of_key(contacts.keys()[i]);
      if (counted_) {
        float& count = counts_[body][cell];
        count = std::isnan(count) ? 1.0f : count + 1.0f;
      }
      const Eigen::Vector3d p_grid = grid.centre_world(cell);
      marks_.push_back({simulation.state().bodies[body].world_from_grid.point(p_grid),
                        contacts(Contacts::kForce)[i]});
      voxels_.push_back({body, grid.linear(cell)});
    }
  }
}

VoxelValues RecordedContacts::counts(std::size_t body) const {
  VoxelValues standing = counts_.at(body);
  for (const auto& [leaf, block] : counts_[body].blocks()) {
    VoxelValues::Block left = block;
    const LeafBits& bits = run_.simulation->state().bodies[body].solid.model().leaves[leaf];
    for (std::size_t place = 0; place < left.size(); ++place) {
      if ((bits.words[place / 64] >> place % 64 & 1u) == 0) left[place] = VoxelValues::kNone;
    }
    standing.set_block(leaf, left);
  }
  return standing;
}

}  // namespace sulcus
