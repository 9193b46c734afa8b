#include "engine/normals/filled_map.hpp"

#include <cstdlib>

namespace sulcus {

namespace {

constexpr int kReach = 15;  // voxels above and below that a map's windows hold

constexpr std::array<std::uint8_t, kFullLevel + 1> kParts = [] {
  std::array<std::uint8_t, kFullLevel + 1> parts{};
  for (int level = 0; level <= kFullLevel; ++level) {
    parts[static_cast<std::size_t>(level)] =
        static_cast<std::uint8_t>(parts_of(static_cast<FillLevel>(level)));
  }
  return parts;
}();

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
  static constexpr int kOutside = -1;  // entered anew each time

  const VoxelModel& model_;
  Eigen::Vector3i dims_;
  const FillMap& fills_;
  int leaf_ = kOutside;
  const FillLevel* page_ = nullptr;
  const LeafBits* bits_ = nullptr;
};

/// What a column lacks below the top of its outermost solid voxel, in parts.
struct Lack {
  int parts = 0;
  bool found = false;
};
Lack lack_of(LevelReader& levels, Cell at, int axis, int inward, int most) noexcept {
  Lack lack;
  int before = 0;
  for (int n = 0; n < most; ++n) {
    const FillLevel level = levels.at(at.x(), at.y(), at.z());
    const int parts = kParts[level];
    if (parts == kHeightParts) return {lack.parts, true};
    if (parts < before) {
      // A wall that no voxel of is full: what its fullest lacks is halved between the sides.
      return {lack.parts - (kHeightParts - before) / 2, true};
    }
    if (level == 0) return lack;
    lack.parts += kHeightParts - parts;
    before = parts;
    at[axis] += inward;
  }
  return lack;
}

}  // namespace

void fill_heights(const Workpiece& workpiece, const Cell& voxel, const MapAxes& axes,
                  const HeightMap& traced, FilledMap& map) noexcept {
  map.ns = traced.ns;
  map.lanes = traced.lanes;
  map.whole = true;
  map.has_parts = false;
  LevelReader levels(workpiece.model());
  const int u = axes.first(), v = axes.second();
  std::int16_t* row = map.height.data();
  for (int j = -map.ns; j <= map.ns; ++j, row += map.lanes) {
    for (int lane = 0; lane < map.lanes; ++lane) {
      const int i = lane - map.lanes / 2;
      row[lane] = FilledMap::kNone;
      if (std::abs(i) > map.ns) continue;
      const int top = traced.at(i, j);  // along the axis
      Lack lack;
      if (top != HeightMap::kNone) {
        Cell at = voxel;
        at[u] += i;
        at[v] += j;
        at[axes.axis] += top;
        const int below = kReach + axes.sign * top;  // voxels that are seen
        lack = lack_of(levels, at, axes.axis, -axes.sign, std::min(FilledMap::kMostPart, below));
      }
      map.whole &= lack.found;
      map.has_parts |= lack.parts != 0;
      if (lack.found) {
        row[lane] = static_cast<std::int16_t>(kHeightParts * axes.sign * top + kHeightParts / 2 -
                                              lack.parts);
      }
    }
  }
}

}  // namespace sulcus
