#include "engine/surface/column_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "engine/volume/grid.hpp"

namespace sulcus {
namespace {

// Voxels that a column is followed in and out from where the vertex was. A face that leans by 45
// degrees both ways is up to two voxels off in the columns beside it, and one more is part filled.
constexpr int kFollowed = kColumnReach - 1;
// Levels by which what cutting left may rise towards the outside within one face.
constexpr int kUneven = 64;
// Cells that a vertex goes wholly; and from which on not at all. What is farther off is an edge
// that the net has rounded: vertices that went there beside others that cannot would be teeth.
constexpr float kWholly = 0.25f, kNotAtAll = 0.5f;

/// Reads levels voxel by voxel, mostly of one leaf.
class LevelReader {
 public:
  explicit LevelReader(const VoxelModel& model) : model_(model) {}

  int at(const Cell& c) {
    if (!model_.grid.contains(c)) return 0;
    const std::uint32_t leaf = model_.grid.leaf_of(c);
    if (leaf != leaf_) {
      leaf_ = leaf;
      bits_ = &model_.leaves[leaf];
      page_ = model_.fills->page(leaf);
    }
    const int place = leaf_place(c);
    if (!bits_->has(place)) return 0;
    return page_ ? page_[place] : kFullLevel;
  }

 private:
  const VoxelModel& model_;
  std::uint32_t leaf_ = ~std::uint32_t{0};
  const LeafBits* bits_ = nullptr;
  const FillLevel* page_ = nullptr;
};

/// How far the surface is outward of the centre of `start` in its column along an axis, voxels;
/// none where that is not one face with a full voxel behind it and an empty one before it, nor a
/// wall. `outward`: 1 or -1.
std::optional<float> height(LevelReader& levels, const Cell& start, int axis, int outward) {
  const int first = levels.at(start);
  Cell at = start;
  int filled = 0, moment = 0;  // of the voxels that are not full: levels, and times their place
  bool wall = false;           // inward of its fullest voxel they get less filled again
  int place = 0;
  int level = first;
  for (int before = first, most = 0; level != kFullLevel;) {
    const bool rises = level > before + kUneven;
    if (-place == kFollowed || (wall && rises)) return {};
    wall = wall || level < most - kUneven;
    if (wall && level == 0) break;
    filled += level;
    moment += level * place;
    most = std::max(most, level);
    before = level;
    at[axis] = start[axis] + outward * --place;
    level = levels.at(at);
  }
  if (wall && level != 0) return {};
  const int innermost = place;
  int before = first;
  for (place = 1; place <= kFollowed; ++place) {
    at[axis] = start[axis] + outward * place;
    level = levels.at(at);
    if (level == 0) break;
    if (level > before + kUneven) return {};
    filled += level;
    moment += level * place;
    before = level;
  }
  if (place > kFollowed) return {};
  constexpr float kFull = 1.0f / kFullLevel;
  const float thick = kFull * static_cast<float>(filled);
  if (!wall) return static_cast<float>(innermost) + 0.5f + thick;
  return static_cast<float>(moment) / static_cast<float>(filled) + 0.5f * thick;
}

/// Three columns about the one nearest to a point: such that a parabola of which they have the
/// means is met. Or the two beside it, without the curvature.
struct Columns {
  int first;
  int count;
  std::array<float, 3> weights;
};
Columns three_columns(float p) {
  const float nearest = std::floor(p + 0.5f);
  const float t = p - nearest;
  const float bent = 0.5f * (t * t - 1.0f / 12.0f);
  return {static_cast<int>(nearest) - 1, 3, {bent - 0.5f * t, 1.0f - 2.0f * bent, bent + 0.5f * t}};
}
Columns two_columns(float p) {
  const float low = std::floor(p);
  return {static_cast<int>(low), 2, {1.0f - (p - low), p - low, 0.0f}};
}

std::optional<float> mean_height(LevelReader& levels, int start, int axis, int outward,
                                 const Columns& u, const Columns& v) {
  Cell at;
  at[axis] = start;
  float sum = 0.0f;
  for (int j = 0; j < v.count; ++j) {
    at[(axis + 2) % 3] = v.first + j;
    for (int i = 0; i < u.count; ++i) {
      at[(axis + 1) % 3] = u.first + i;
      const std::optional<float> h = height(levels, at, axis, outward);
      if (!h) return {};
      sum += u.weights[static_cast<std::size_t>(i)] * v.weights[static_cast<std::size_t>(j)] * *h;
    }
  }
  return sum;
}

/// How far a point is to be moved along an axis to lie on the surface, voxels.
std::optional<float> way_along(LevelReader& levels, const Eigen::Vector3f& p_index, int axis,
                               int outward) {
  const float start = std::floor(p_index[axis] + 0.5f);
  const float u = p_index[(axis + 1) % 3];
  const float v = p_index[(axis + 2) % 3];
  std::optional<float> h = mean_height(levels, static_cast<int>(start), axis, outward,
                                       three_columns(u), three_columns(v));
  if (!h) {
    h = mean_height(levels, static_cast<int>(start), axis, outward, two_columns(u), two_columns(v));
  }
  if (!h) return {};
  return start + static_cast<float>(outward) * *h - p_index[axis];
}

/// How far a vertex goes of a way, both in cells.
float part_gone(float way) {
  const float part = (kNotAtAll - std::abs(way)) / (kNotAtAll - kWholly);
  return std::clamp(part, 0.0f, 1.0f) * way;
}

}  // namespace

void move_to_columns(const VoxelModel& model, int cell_level, const NetsBlock& solid,
                     NetsMesh& mesh, std::vector<std::uint8_t>* at_surface) {
  if (at_surface) at_surface->assign(mesh.vertices.size(), 1);
  LevelReader levels(model);
  const float edge = static_cast<float>(1 << cell_level);
  const std::ptrdiff_t step_y = solid.dims.x();
  const std::ptrdiff_t step_z = step_y * solid.dims.y();
  for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
    NetsVertex& vertex = mesh.vertices[n];
    const Cell in_block = vertex.cell - solid.first;
    const float* const low = &solid.values[static_cast<std::size_t>(
        in_block.x() + step_y * in_block.y() + step_z * in_block.z())];
    Eigen::Vector3f slope = Eigen::Vector3f::Zero();
    bool outside = false;
    for (int corner = 0; corner < 8; ++corner) {
      const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
      const float value = low[x + step_y * y + step_z * z];
      outside = outside || !(value > 0.5f);
      slope += value * Eigen::Vector3f(static_cast<float>(1 - 2 * x), static_cast<float>(1 - 2 * y),
                                       static_cast<float>(1 - 2 * z));
    }
    if (!outside) {
      if (at_surface) (*at_surface)[n] = 0;
      continue;
    }
    int axis = 0;
    if (!(slope.cwiseAbs().maxCoeff(&axis) > 0.0f)) continue;
    const Eigen::Vector3f half = Eigen::Vector3f::Constant(0.5f);
    const Eigen::Vector3f p_index =
        (vertex.cell.cast<float>() + vertex.offset + half) * edge - half;
    const std::optional<float> way = way_along(levels, p_index, axis, slope[axis] > 0.0f ? 1 : -1);
    if (way) vertex.offset[axis] += part_gone(*way / edge);
  }
}

}  // namespace sulcus
