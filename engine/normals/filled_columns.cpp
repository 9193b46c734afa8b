#include "engine/normals/filled_columns.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/normals/ldm_tuning.hpp"

namespace sulcus {

static_assert(kHeightParts == kFullLevel);

void LevelReader::enter(int x, int y, int z) noexcept {
  static constexpr LeafBits kNothing{};
  x_ = x, y_ = y, z_ = z;
  const int lx = x >> 3, ly = y >> 3, lz = z >> 3;
  const bool inside = static_cast<unsigned>(lx) < static_cast<unsigned>(dims_.x()) &&
                      static_cast<unsigned>(ly) < static_cast<unsigned>(dims_.y()) &&
                      static_cast<unsigned>(lz) < static_cast<unsigned>(dims_.z());
  const int leaf = lx + dims_.x() * (ly + dims_.y() * lz);
  page_ = inside ? fills_.page(static_cast<std::uint32_t>(leaf)) : nullptr;
  bits_ = inside ? &model_.leaves[static_cast<std::size_t>(leaf)] : &kNothing;
}

std::optional<ColumnLack> column_lack(LevelReader& levels, ColumnVoxel at, int most) noexcept {
  int lack = 0, fullest = 0, lack_above_fullest = 0;
  for (int n = 0; n < most; ++n, at = at.inward(1)) {
    const int parts = at.level(levels);
    if (parts == kHeightParts) return ColumnLack{lack, false};
    if (parts == 0) return ColumnLack{lack_above_fullest + (kHeightParts - fullest) / 2, true};
    if (parts > fullest) {
      fullest = parts;
      lack_above_fullest = lack;
    }
    lack += kHeightParts - parts;
  }
  return {};
}

namespace {

constexpr int kMostAbove = 3;  // voxels over a column's own that a surface may be

/// Solid voxels one after another beside a voxel along an axis, each way; of more than kMostAbove
/// not how many.
struct SolidBeside {
  int down = 0, up = 0;

  SolidBeside(const ColumnBits& columns, const Cell& voxel, const MapAxes& axes) noexcept {
    constexpr int kBeside = kMostAbove + 1;
    const std::uint64_t window = columns.window(axes.axis, voxel[axes.first()],
                                                voxel[axes.second()], voxel[axes.axis] - kBeside);
    down = std::countl_one(static_cast<std::uint8_t>(window << (8 - kBeside)));
    up = std::countr_one(window >> (kBeside + 1));
  }
  int outward(int sign) const { return sign > 0 ? up : down; }
};

/// Of a column with so many solid voxels outward of its own.
std::optional<OwnHeight> own_height(LevelReader& levels, const Cell& voxel, const MapAxes& axes,
                                    int above) noexcept {
  if (above > kMostAbove) return {};
  const std::optional<ColumnLack> lack =
      column_lack(levels, ColumnVoxel(voxel, axes).inward(-above), kMostPartFilled + above);
  if (!lack) return {};
  const float lacks = static_cast<float>(lack->parts) * (1.0f / kHeightParts);
  return OwnHeight{static_cast<float>(above) + 0.5f - lacks, lack->is_wall};
}

}  // namespace

std::optional<OwnHeight> own_height(const Workpiece& workpiece, LevelReader& levels,
                                    const Cell& voxel, const MapAxes& axes) noexcept {
  const SolidBeside beside(workpiece.columns(), voxel, axes);
  return own_height(levels, voxel, axes, beside.outward(axes.sign));
}

std::optional<float> farthest_surface(const Workpiece& workpiece, LevelReader& levels,
                                      const Cell& voxel, float enough) noexcept {
  if (levels.at(voxel.x(), voxel.y(), voxel.z()) == kFullLevel) return {};
  std::optional<float> farthest;
  for (int axis = 0; axis < 3; ++axis) {
    const SolidBeside beside(workpiece.columns(), voxel, {axis, 1});
    for (const int sign : {-1, 1}) {
      const auto height = own_height(levels, voxel, {axis, sign}, beside.outward(sign));
      if (!height) continue;
      const float distance = std::abs(height->voxels) + kSameOffset;
      if (distance >= enough) return distance;
      farthest = std::max(farthest.value_or(0.0f), distance);
    }
  }
  return farthest;
}

}  // namespace sulcus
