#include "engine/outcome/pulp_distance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/outcome/voxel_distance.hpp"

namespace sulcus {

namespace {

// What lies between two voxels at most, and a little more for what float rounds off:
constexpr float kFromMiddleOf8 = 6.94f;  // of 8 x 8 x 8 and its voxel at (4, 4, 4): 4 sqrt(3)
constexpr float kFromMiddleOf4 = 3.47f;
constexpr float kWithin2 = 1.74f;  // of 2 x 2 x 2: sqrt(3)

// How far from a place the leaves found for it serve, voxels: with 16 and with 32 a run of the
// class I cavity takes longer.
constexpr float kNearby = 24.0f;
constexpr float kRounding = 0.01f;

/// Of a part of so many voxels along an edge: by the places of its voxels in the leaf.
int part_of(const Cell& c, int edge) {
  const int along = kLeafEdge / edge;
  const Cell at(c.x() % kLeafEdge / edge, c.y() % kLeafEdge / edge, c.z() % kLeafEdge / edge);
  return at.x() + along * (at.y() + along * at.z());
}

}  // namespace

PulpDistance::PulpDistance(VoxelSet pulp)
    : pulp_(std::move(pulp)), tree_(pulp_), place_(pulp_.grid().leaf_count(), kUnknown) {}

/// None where it is further than the nearest so far by so much `more`, voxels.
std::optional<std::uint32_t> PulpDistance::squared_distance(const Cell& c, float more) {
  if (!least_) return tree_.squared_distance(pulp_, c);
  const float within = nearest_ + more;
  float away = (c - nearby_).cast<float>().norm();
  if (away + within > reach_) {
    nearby_ = c;
    away = 0.0f;
    reach_ = within + kNearby;
    tree_.leaves_within(nearby_, reach_ + kRounding, leaves_nearby_);
  }
  const int bound = static_cast<int>(std::ceil(within * within));
  int squared = bound;
  for (const LeafTree::Near& near : leaves_nearby_) {
    const float nearest = std::max(0.0f, near.distance - away - kRounding);
    if (nearest * nearest >= static_cast<float>(squared)) break;
    const Cell from = c - near.first;
    const Cell beyond = from - from.cwiseMax(0).cwiseMin(kLeafEdge - 1);
    if (beyond.squaredNorm() >= squared) continue;
    squared = nearer_in_leaf(c, near.first, pulp_.voxels(near.leaf), squared);
  }
  if (squared == bound) return {};
  return static_cast<std::uint32_t>(squared);
}

/// Of a part by its middle, whose voxels are at most so far from it; keeps what it learns.
bool PulpDistance::may_be_nearest(const Cell& middle, float from_middle, float& bound) {
  if (bound > 0.0f) return bound < nearest_;
  const std::optional<std::uint32_t> squared = squared_distance(middle, from_middle);
  bound = squared ? std::sqrt(static_cast<float>(*squared)) - from_middle : nearest_;
  return squared.has_value();
}

void PulpDistance::remove(const Cell& c) {
  const std::uint32_t leaf = pulp_.grid().leaf_of(c);
  std::uint32_t& place = place_[leaf];
  if (place == kTooFar) return;
  if (place == kUnknown) {
    const Cell middle = pulp_.grid().leaf_origin(leaf) + Cell::Constant(kLeafEdge / 2);
    float bound = 0.0f;
    if (!may_be_nearest(middle, kFromMiddleOf8, bound)) {
      place = kTooFar;  // and stays it, as the nearest only comes nearer
      return;
    }
    place = static_cast<std::uint32_t>(bounds_.size());
    bounds_.emplace_back();
  }
  Bounds& bounds = bounds_[place];
  const Cell middle_of_4(c.x() / 4 * 4 + 2, c.y() / 4 * 4 + 2, c.z() / 4 * 4 + 2);
  float& of_4 = bounds.of_4[static_cast<std::size_t>(part_of(c, 4))];
  if (!may_be_nearest(middle_of_4, kFromMiddleOf4, of_4)) return;
  float& of_2 = bounds.of_2[static_cast<std::size_t>(part_of(c, 2))];
  if (of_2 >= nearest_) return;
  const std::optional<std::uint32_t> squared = squared_distance(c, kWithin2);
  if (!squared) {
    of_2 = nearest_;
    return;
  }
  const float distance = std::sqrt(static_cast<float>(*squared));
  of_2 = distance - kWithin2;
  if (distance >= nearest_) return;
  nearest_ = distance;
  least_ = squared;
}

std::size_t PulpDistance::memory_bytes() const {
  return pulp_.memory_bytes() + place_.capacity() * sizeof(std::uint32_t) +
         bounds_.capacity() * sizeof(Bounds) + leaves_nearby_.capacity() * sizeof(LeafTree::Near);
}

}  // namespace sulcus
