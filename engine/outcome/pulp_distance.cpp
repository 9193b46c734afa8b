#include "engine/outcome/pulp_distance.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace sulcus {

namespace {

constexpr int kWord = 64;
constexpr float kNone = 1e9f;  // squared, where a column has no pulp
/// Of a leaf's voxels from its voxel at (4, 4, 4), at most: 4 sqrt(3).
constexpr double kFromMiddle = 6.93;

/// Calls `visit` with every voxel of a set.
template <class Visit>
void for_each_cell(const VoxelSet& set, const Visit& visit) {
  for (const std::uint32_t leaf : set.leaves()) {
    const Cell first = set.grid().leaf_origin(leaf);
    for_each_voxel(set.voxels(leaf), [&](int place) { visit(Cell(first + cell_in_leaf(place))); });
  }
}

}  // namespace

PulpDistance::PulpDistance(const VoxelSet& pulp)
    : grid_(pulp.grid()),
      low_(Cell::Constant(std::numeric_limits<int>::max())),
      layers_(static_cast<std::size_t>(grid_.leaf_dims().z())),
      place_(grid_.leaf_count(), kUnknown) {
  Cell high = Cell::Constant(-1);
  for_each_cell(pulp, [&](const Cell& c) {
    low_ = low_.cwiseMin(c);
    high = high.cwiseMax(c);
  });
  size_ = high - low_ + Cell::Ones();
  words_ = static_cast<std::size_t>((size_.z() + kWord - 1) / kWord);
  columns_.resize(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) *
                  words_);
  row_.resize(static_cast<std::size_t>(size_.x()));
  for_each_cell(pulp, [&](const Cell& c) {
    const Cell at = c - low_;
    const auto column = static_cast<std::size_t>(at.y() * size_.x() + at.x());
    columns_[column * words_ + static_cast<std::size_t>(at.z() / kWord)] |= std::uint64_t{1}
                                                                            << at.z() % kWord;
  });
}

float PulpDistance::squared_steps(std::size_t column, int z) const {
  const std::uint64_t* const words = &columns_[column * words_];
  const int last = static_cast<int>(words_) - 1;
  const int from = std::clamp(z, 0, size_.z() - 1);
  const int word = from / kWord, bit = from % kWord;
  float nearest = kNone;
  const auto meet = [&](int at) {
    const auto steps = static_cast<float>(at - z);
    nearest = std::min(nearest, steps * steps);
  };
  // From there upward, and downward.
  std::uint64_t rest = words[word] >> bit << bit;
  for (int w = word; w <= last; rest = ++w <= last ? words[w] : 0) {
    if (rest == 0) continue;
    meet(w * kWord + std::countr_zero(rest));
    break;
  }
  rest = words[word] << (kWord - 1 - bit) >> (kWord - 1 - bit);
  for (int w = word; w >= 0; rest = --w >= 0 ? words[w] : 0) {
    if (rest == 0) continue;
    meet(w * kWord + static_cast<int>(std::bit_width(rest)) - 1);
    break;
  }
  return nearest;
}

const std::vector<float>& PulpDistance::layer(int leaf_z) {
  std::vector<float>& squared = layers_[static_cast<std::size_t>(leaf_z)];
  if (!squared.empty()) return squared;
  const std::size_t columns = columns_.size() / words_;
  squared.resize(kLeafEdge * columns);
  for (int k = 0; k < kLeafEdge; ++k) {
    const int z = leaf_z * kLeafEdge + k - low_.z();
    for (std::size_t column = 0; column < columns; ++column) {
      squared[static_cast<std::size_t>(k) * columns + column] = squared_steps(column, z);
    }
  }
  return squared;
}

/// Of one voxel: row by row of columns from its own outward, as long as one may be nearer.
float PulpDistance::squared_distance(const Cell& c) {
  const std::vector<float>& squared = layer(c.z() / kLeafEdge);
  const int k = c.z() % kLeafEdge, x = c.x() - low_.x(), y = c.y() - low_.y();
  float nearest = 2.0f * kNone;
  const auto try_row = [&](int row, float across) {
    const float* const along =
        &squared[static_cast<std::size_t>((k * size_.y() + row) * size_.x())];
    for (int i = 0; i < size_.x(); ++i) {
      const auto step = static_cast<float>(i - x);
      nearest = std::min(nearest, along[i] + (step * step + across));
    }
  };
  for (int away = 0; away < size_.y() + std::abs(y); ++away) {
    const auto across = static_cast<float>(away) * static_cast<float>(away);
    if (across >= nearest) break;
    if (y - away >= 0 && y - away < size_.y()) try_row(y - away, across);
    if (away > 0 && y + away >= 0 && y + away < size_.y()) try_row(y + away, across);
  }
  return nearest;
}

/// By its middle, whose distance it gives, voxels.
bool PulpDistance::may_be_nearest(std::uint32_t leaf, double& middle) {
  const Cell c = grid_.leaf_origin(leaf) + Cell::Constant(kLeafEdge / 2);
  middle = std::sqrt(static_cast<double>(squared_distance(c)));
  return !least_ || middle - kFromMiddle < std::sqrt(static_cast<double>(*least_));
}

/// `furthest`: no voxel of the leaf is further from the pulp.
void PulpDistance::fill(std::uint32_t leaf, double furthest, Block& block) {
  const Cell first = grid_.leaf_origin(leaf) - low_;
  const std::vector<float>& squared = layer(grid_.leaf_origin(leaf).z() / kLeafEdge);
  const int wide = size_.x(), reach = static_cast<int>(std::ceil(furthest));
  const int x_begin = std::max(0, first.x() - reach);
  const int x_end = std::min(wide, first.x() + kLeafEdge + reach);
  for (int row = 0; row < kLeafEdge * kLeafEdge; ++row) {
    const int k = row / kLeafEdge, j = row % kLeafEdge, y = first.y() + j;
    std::fill(row_.begin() + x_begin, row_.begin() + x_end, 2.0f * kNone);
    float* const nearest_of = row_.data();
    const int y_end = std::min(size_.y(), y + reach + 1);
    for (int other = std::max(0, y - reach); other < y_end; ++other) {
      const float* const along = &squared[static_cast<std::size_t>((k * size_.y() + other) * wide)];
      const auto across = static_cast<float>((y - other) * (y - other));
      for (int x = x_begin; x < x_end; ++x) {
        nearest_of[x] = std::min(nearest_of[x], along[x] + across);
      }
    }
    for (int i = 0; i < kLeafEdge; ++i) {
      float nearest = 2.0f * kNone;
      for (int x = x_begin; x < x_end; ++x) {
        const auto step = static_cast<float>(first.x() + i - x);
        nearest = std::min(nearest, nearest_of[x] + step * step);
      }
      block[static_cast<std::size_t>(row * kLeafEdge + i)] = nearest;
    }
  }
}

void PulpDistance::remove(const Cell& c) {
  const std::uint32_t leaf = grid_.leaf_of(c);
  std::uint32_t& place = place_[leaf];
  if (place == kTooFar) return;
  if (place == kUnknown) {
    double middle = 0.0;
    if (!may_be_nearest(leaf, middle)) {
      place = kTooFar;  // and stays it, as the least only falls
      return;
    }
    place = static_cast<std::uint32_t>(blocks_.size());
    fill(leaf, middle + kFromMiddle, blocks_.emplace_back());
  }
  const float squared = blocks_[place][static_cast<std::size_t>(leaf_place(c))];
  if (!least_ || squared < static_cast<float>(*least_)) {
    least_ = static_cast<std::uint32_t>(squared);
  }
}

std::size_t PulpDistance::memory_bytes() const {
  std::size_t bytes = columns_.capacity() * sizeof(std::uint64_t) +
                      place_.capacity() * sizeof(std::uint32_t) +
                      blocks_.capacity() * sizeof(Block);
  for (const auto& squared : layers_) bytes += squared.capacity() * sizeof(float);
  return bytes;
}

}  // namespace sulcus
