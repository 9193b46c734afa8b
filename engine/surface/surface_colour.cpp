#include "engine/surface/surface_colour.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

namespace sulcus {
namespace {

Cell rounded(const Eigen::Vector3f& p) {
  return {static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())),
          static_cast<int>(std::lround(p.z()))};
}

/// The n-th of 27 steps to what is round a voxel.
Cell step_round(int n) { return Cell(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1); }

// What has no value, where a quantity is drawn: neither a tissue's colour nor one of a scale's.
const Eigen::Vector3f kNoValue(0.30f, 0.30f, 0.30f);

}  // namespace

bool contains(const LeafMap& voxels, const VoxelGrid& grid, const Cell& c) {
  if (!grid.contains(c)) return false;
  const auto found = voxels.find(grid.leaf_of(c));
  return found != voxels.end() && found->second.has(leaf_place(c));
}

SurfaceColour::SurfaceColour(std::vector<TissueLook> looks) : looks_(std::move(looks)) {
  if (looks_.empty()) throw std::invalid_argument("a drawn surface needs the look of a tissue");
}

void SurfaceColour::by_time(double span_s) {
  by_time_ = span_s > 0.0;
  scale_.reset();
  values_.reset();
  if (by_time_) scale_ = ColourScale{.name = "Removed at, s", .high = span_s};
}

void SurfaceColour::by_values(const ColourScale& scale, VoxelValues values) {
  by_time_ = false;
  scale_ = scale;
  values_ = std::move(values);
}

void SurfaceColour::note_removed(const VoxelGrid& grid, const Cell& c, float time_s) {
  if (by_time_) removed_at_s_[grid.leaf_of(c)][leaf_place(c)] = time_s;
}

float SurfaceColour::mean_time_s(const VoxelGrid& grid, const LeafMap& removed,
                                 const Cell& outside) const {
  float sum_s = 0.0f;
  int count = 0;
  for (int n = 0; n < 27; ++n) {
    const Cell c = outside + 2 * step_round(n);
    if (!contains(removed, grid, c)) continue;
    sum_s += removed_at_s_.at(grid.leaf_of(c))[leaf_place(c)];
    ++count;
  }
  return count > 0 ? sum_s / static_cast<float>(count) : 0.0f;
}

std::optional<Eigen::Vector3f> SurfaceColour::value_at(const Eigen::Vector3f& p_index,
                                                       const Eigen::Vector3f& normal) const {
  // The values are those of surface voxels; smoothing has moved the vertex by up to a cell.
  const Cell inside = rounded(p_index - 0.6f * normal);
  for (const int apart : {1, 2}) {
    float sum = 0.0f;
    int count = 0;
    for (int n = 0; n < 27; ++n) {
      const float value = values_->at(inside + apart * step_round(n));
      if (std::isnan(value)) continue;
      sum += value;
      ++count;
    }
    if (count > 0) return scale_->colour(sum / static_cast<float>(count));
  }
  return {};
}

Eigen::Vector3f SurfaceColour::tissue_at(const VoxelModel& model, const Eigen::Vector3f& p_index,
                                         const Eigen::Vector3f& normal) const {
  // Binomial weights over 27 voxels, 2 apart, round a point just inside: a border between tissues
  // is then as wide as the triangles and shows no teeth.
  Eigen::Vector3f colour = Eigen::Vector3f::Zero();
  float weight = 0.0f;
  auto add = [&](const Cell& c, float w) {
    const auto& look = looks_[std::min<std::size_t>(model.tissue(c), looks_.size() - 1)];
    colour += w * Eigen::Vector3f(look.colour[0], look.colour[1], look.colour[2]);
    weight += w;
  };
  const Cell inside = rounded(p_index - 1.8f * normal);
  for (int n = 0; n < 27; ++n) {
    const Cell d = step_round(n);
    const Cell c = inside + 2 * d;
    if (model.solid(c)) add(c, 1.0f / static_cast<float>(1 << d.cwiseAbs().sum()));
  }
  if (weight == 0.0f) add(inside.cwiseMax(0).cwiseMin(model.grid.cells - Cell::Ones()), 1.0f);
  return colour / weight;
}

SurfaceColour::Seen SurfaceColour::at(const VoxelModel& model, const LeafMap& removed,
                                      const Eigen::Vector3f& p_index, const Eigen::Vector3f& normal,
                                      bool was_cut) const {
  std::optional<Eigen::Vector3f> value;
  if (values_) value = value_at(p_index, normal);
  Eigen::Vector3f colour = values_ ? value.value_or(kNoValue) : tissue_at(model, p_index, normal);
  const Cell outside = rounded(p_index + 1.5f * normal);
  float cut = 0.0f;
  if (values_) {
    cut = 1.0f;  // matt all over: a reflection would pass for another value
  } else if (was_cut) {
    int empty = 0;
    int gone = 0;
    for (int n = 0; n < 27; ++n) {
      const Cell c = outside + 2 * step_round(n);
      if (model.solid(c)) continue;
      ++empty;
      gone += contains(removed, model.grid, c) ? 1 : 0;
    }
    if (empty > 0) cut = static_cast<float>(gone) / static_cast<float>(empty);
  }
  if (by_time_ && cut > 0.0f) {
    const float time_s = mean_time_s(model.grid, removed, outside);
    colour = (1.0f - cut) * colour + cut * scale_->colour(time_s);
  }
  Seen seen{{}, value && scale_->unlit};
  for (std::size_t i = 0; i < 3; ++i) {
    const float encoded = std::sqrt(std::clamp(colour[static_cast<int>(i)], 0.0f, 1.0f));
    seen.colour_cut[i] = static_cast<std::uint8_t>(std::lround(255.0f * encoded));
  }
  seen.colour_cut[3] = static_cast<std::uint8_t>(std::lround(255.0f * cut));
  return seen;
}

}  // namespace sulcus
