#include "engine/normals/filled_heights.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/normals/ldm_tuning.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

static_assert(kHeightParts == kFullLevel);

/// Reads levels voxel by voxel, mostly of one leaf.
class LevelReader {
 public:
  explicit LevelReader(const VoxelModel& model)
      : model_(model), dims_(model.grid.leaf_dims()), fills_(*model.fills) {}

  FillLevel at(int x, int y, int z) noexcept {
    const int lx = x >> 3, ly = y >> 3, lz = z >> 3;
    const int leaf = lx + dims_.x() * (ly + dims_.y() * lz);
    if (leaf != leaf_) enter(lx, ly, lz, leaf);
    const int place = (x & 7) | (y & 7) << 3 | (z & 7) << 6;
    if (page_) return page_[place];
    return bits_->has(place) ? kFullLevel : FillLevel{0};
  }

 private:
  void enter(int lx, int ly, int lz, int leaf) noexcept {
    static constexpr LeafBits kNothing{};
    const bool inside = static_cast<unsigned>(lx) < static_cast<unsigned>(dims_.x()) &&
                        static_cast<unsigned>(ly) < static_cast<unsigned>(dims_.y()) &&
                        static_cast<unsigned>(lz) < static_cast<unsigned>(dims_.z());
    leaf_ = inside ? leaf : kOutside;
    page_ = inside ? fills_.page(static_cast<std::uint32_t>(leaf)) : nullptr;
    bits_ = inside ? &model_.leaves[static_cast<std::size_t>(leaf)] : &kNothing;
  }
  // Entered anew each time; no leaf's number, nor what is reckoned for one beyond the grid.
  static constexpr int kOutside = std::numeric_limits<int>::min();

  const VoxelModel& model_;
  Eigen::Vector3i dims_;
  const FillMap& fills_;
  int leaf_ = kOutside;
  const FillLevel* page_ = nullptr;
  const LeafBits* bits_ = nullptr;
};

/// What a column lacks below the top of its outermost solid voxel, in parts; kUnknown where no
/// surface is found.
std::int16_t lack_of(LevelReader& levels, Cell at, int axis, int inward, int most) noexcept {
  int lack = 0, fullest = 0, lack_above_fullest = 0;
  for (int n = 0; n < most; ++n) {
    const int parts = levels.at(at.x(), at.y(), at.z());
    if (parts == kHeightParts) return static_cast<std::int16_t>(lack);
    if (parts == 0) {
      // A wall that no voxel of is full: what its fullest lacks is halved between the sides.
      return static_cast<std::int16_t>(lack_above_fullest + (kHeightParts - fullest) / 2);
    }
    if (parts > fullest) {
      fullest = parts;
      lack_above_fullest = lack;
    }
    lack += kHeightParts - parts;
    at[axis] += inward;
  }
  return ColumnLacks::kUnknown;
}

}  // namespace

ColumnLacks& FilledHeights::lacks_of(const Cell& voxel, const MapAxes& axes) noexcept {
  const Cell origin = voxel.unaryExpr([](int c) { return c & -kLeafEdge; });
  if (origin != origin_) {
    origin_ = origin;
    made_ = {};
  }
  const auto number = static_cast<std::size_t>(2 * axes.axis + (axes.sign > 0 ? 1 : 0));
  ColumnLacks& lacks = lacks_[number];
  if (!made_[number]) {
    made_[number] = true;
    std::fill_n(&lacks.top[0][0], sizeof lacks.top / sizeof(std::int16_t), ColumnLacks::kUnknown);
  }
  return lacks;
}

namespace {

std::optional<float> own_height(LevelReader& levels, const Cell& voxel,
                                const MapAxes& axes) noexcept {
  constexpr int kMostAbove = 3;
  Cell at = voxel;
  int above = 0;
  for (; above <= kMostAbove; ++above) {
    Cell next = at;
    next[axes.axis] += axes.sign;
    if (levels.at(next.x(), next.y(), next.z()) == 0) break;
    at = next;
  }
  if (above > kMostAbove) return {};
  const int lack = lack_of(levels, at, axes.axis, -axes.sign, kMostPartFilled + above);
  if (lack == ColumnLacks::kUnknown) return {};
  return static_cast<float>(above) + 0.5f - static_cast<float>(lack) * (1.0f / kHeightParts);
}

}  // namespace

std::optional<float> own_height(const VoxelModel& model, const Cell& voxel,
                                const MapAxes& axes) noexcept {
  LevelReader levels(model);
  return own_height(levels, voxel, axes);
}

std::optional<float> farthest_surface(const VoxelModel& model, const Cell& voxel) noexcept {
  if (model.level(voxel) == kFullLevel) return {};
  LevelReader levels(model);
  std::optional<float> farthest;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sign : {-1, 1}) {
      const auto height = own_height(levels, voxel, {axis, sign});
      if (height) farthest = std::max(farthest.value_or(0.0f), std::abs(*height));
    }
  }
  if (farthest) *farthest += kSameOffset;
  return farthest;
}

void FilledHeights::fill(const Cell& voxel, const MapAxes& axes, const HeightMap& traced,
                         FilledMap& map) noexcept {
  const int u = axes.first(), v = axes.second(), ns = traced.ns;
  ColumnLacks& lacks = lacks_of(voxel, axes);
  const int row = voxel[v] - origin_[v] + kMaxNeighbourhood - ns;
  const int lane = voxel[u] - origin_[u] + ColumnLacks::kMargin - traced.lanes / 2;
  map.ns = ns;
  map.lanes = traced.lanes;
  map.holes = map.parts = 0;
  const auto fill_rows = [&](std::uint32_t rows) {
    return map_kernels().fill_rows(traced, rows, &lacks.top[row][lane], &lacks.lack[row][lane],
                                   voxel[axes.axis], axes.sign, map);
  };
  const std::uint32_t unknown = fill_rows((2u << (2 * ns)) - 1u);
  if (unknown == 0) return;
  LevelReader levels(model_);
  for (std::uint32_t rest = unknown; rest != 0; rest &= rest - 1) {
    const int n = std::countr_zero(rest);
    for (int i = -ns; i <= ns; ++i) {
      const int height = traced.at(i, n - ns);  // along the axis
      if (height == HeightMap::kNone) continue;
      Cell at = voxel;
      at[u] += i;
      at[v] += n - ns;
      at[axes.axis] += height;
      const int column = lane + traced.lanes / 2 + i;
      std::int16_t& top = lacks.top[row + n][column];
      if (top == at[axes.axis]) continue;
      top = static_cast<std::int16_t>(at[axes.axis]);
      lacks.lack[row + n][column] = lack_of(levels, at, axes.axis, -axes.sign, kMostPartFilled);
    }
  }
  fill_rows(unknown);
}

}  // namespace sulcus
