#include "engine/volume/column_bits.hpp"

#include <algorithm>
#include <vector>

#include "engine/core/parallel.hpp"

namespace sulcus {
namespace {

static_assert(ColumnBits::kBelow % kLeafEdge == 0, "a leaf's 8 bits then lie in one word");

/// Leaves from `lower` on, `upper` exclusive, that hold all solid voxels.
struct LeafBox {
  Eigen::Vector3i lower, upper;
};

LeafBox solid_leaves(const VoxelModel& model) {
  const Eigen::Vector3i n = model.grid.leaf_dims();
  const LeafBox none{n, Eigen::Vector3i::Zero()};
  std::vector<LeafBox> layers(static_cast<std::size_t>(n.z()), none);
  parallel_for(0, n.z(), [&](int z) {
    LeafBox& layer = layers[static_cast<std::size_t>(z)];
    for (int y = 0; y < n.y(); ++y) {
      const LeafBits* row =
          model.leaves.data() + static_cast<std::ptrdiff_t>(n.x()) * (y + n.y() * z);
      int first = 0, end = n.x();
      while (first < end && row[first] == LeafBits{}) ++first;
      if (first == end) continue;
      while (row[end - 1] == LeafBits{}) --end;
      layer.lower = layer.lower.cwiseMin(Eigen::Vector3i(first, y, z));
      layer.upper = layer.upper.cwiseMax(Eigen::Vector3i(end, y + 1, z + 1));
    }
  });
  LeafBox box = none;
  for (const LeafBox& layer : layers) {
    box = {box.lower.cwiseMin(layer.lower), box.upper.cwiseMax(layer.upper)};
  }
  if ((box.upper.array() <= box.lower.array()).any()) {
    return {Eigen::Vector3i::Zero(), Eigen::Vector3i::Zero()};
  }
  return box;
}

/// Bit i + 8 j goes to j + 8 i [Warren 2012, Hacker's Delight, 7-3].
std::uint64_t transposed(std::uint64_t m) {
  std::uint64_t t = (m ^ m >> 7) & 0x00aa00aa00aa00aau;
  m ^= t ^ t << 7;
  t = (m ^ m >> 14) & 0x0000cccc0000ccccu;
  m ^= t ^ t << 14;
  t = (m ^ m >> 28) & 0x00000000f0f0f0f0u;
  return m ^ t ^ t << 28;
}

std::uint32_t byte_of(std::uint64_t word, int n) {
  return static_cast<std::uint32_t>(word >> (8 * n) & 0xff);
}

}  // namespace

ColumnBits::ColumnBits(const VoxelModel& model) {
  const LeafBox box = solid_leaves(model);
  lower_ = box.lower * kLeafEdge;
  upper_ = box.upper * kLeafEdge;
  const Eigen::Vector3i n = upper_ - lower_;
  parallel_for(0, 3, [&](int axis) {
    Axis& a = axes_[axis];
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    a.row = n[u] + 2 * kBorder;
    a.plane = a.row * (n[v] + 2 * kBorder);
    a.origin = (kBorder - lower_[v]) * a.row + kBorder - lower_[u];
    a.below = kBelow - lower_[axis];
    // A window is three words, and the last one begins at the end of the box.
    a.words.assign(static_cast<std::size_t>(a.plane * ((n[axis] + kBelow) / 32 + 3)), 0);
  });

  // One task fills the three packings of the leaves that share words of the columns along z.
  constexpr int kLeavesBelow = kBelow / kLeafEdge, kLeavesOfWord = 32 / kLeafEdge;
  const Eigen::Vector3i dims = model.grid.leaf_dims();
  const int slabs =
      (box.upper.z() - box.lower.z() + kLeavesBelow + kLeavesOfWord - 1) / kLeavesOfWord;
  parallel_for(0, slabs, [&](int slab) {
    const int z_begin = box.lower.z() + slab * kLeavesOfWord - kLeavesBelow;
    const int z_end = std::min(z_begin + kLeavesOfWord, box.upper.z());
    for (int lz = std::max(z_begin, box.lower.z()); lz < z_end; ++lz) {
      for (int ly = box.lower.y(); ly < box.upper.y(); ++ly) {
        for (int lx = box.lower.x(); lx < box.upper.x(); ++lx) {
          const LeafBits& bits =
              model.leaves[static_cast<std::size_t>(lx + dims.x() * (ly + dims.y() * lz))];
          if (bits != LeafBits{}) fill(bits, Cell(lx, ly, lz) * kLeafEdge);
        }
      }
    }
  });
}

void ColumnBits::fill(const LeafBits& bits, const Cell& first) noexcept {
  // Where the leaf's 8 voxels of a column lie: in one word, from the bit `shift` on.
  const auto place = [&](int axis) {
    Axis& a = axes_[axis];
    return a.words.data() +
           a.offset(first[(axis + 1) % 3], first[(axis + 2) % 3], (first[axis] + a.below) >> 5);
  };
  const auto shift = [&](int axis) { return (first[axis] + axes_[axis].below) & 31; };
  std::uint32_t* along_x = place(0);  // [z][y]
  std::uint32_t* along_y = place(1);  // [x][z]
  std::uint32_t* along_z = place(2);  // [y][x]
  const int shift_x = shift(0), shift_y = shift(1), shift_z = shift(2);
  std::array<std::uint64_t, 8> swapped;  // slice k with x and y changed places
  for (int k = 0; k < 8; ++k) swapped[k] = transposed(bits.words[k]);
  for (int row = 0; row < 8; ++row) {
    std::uint64_t section = 0;  // of y = row: bit x + 8 z
    for (int k = 0; k < 8; ++k) section |= std::uint64_t{byte_of(bits.words[k], row)} << (8 * k);
    section = transposed(section);
    for (int i = 0; i < 8; ++i) {
      along_x[i] |= byte_of(bits.words[row], i) << shift_x;
      along_y[i] |= byte_of(swapped[i], row) << shift_y;
      along_z[i] |= byte_of(section, i) << shift_z;
    }
    along_x += axes_[0].row;
    along_y += axes_[1].row;
    along_z += axes_[2].row;
  }
}

}  // namespace sulcus
