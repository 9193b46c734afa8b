#include "engine/volume/column_bits.hpp"

#include <bit>

#include <tbb/parallel_for.h>

namespace sulcus {

ColumnBits::ColumnBits(const VoxelModel& model) {
  const Eigen::Vector3i n = model.grid.cells;
  for (int axis = 0; axis < 3; ++axis) {
    Axis& a = axes_[axis];
    a.row = static_cast<std::size_t>(n[(axis + 1) % 3] + 2 * kBorder);
    a.plane = a.row * static_cast<std::size_t>(n[(axis + 2) % 3] + 2 * kBorder);
    // Zeros, the voxels, and zeros to complete a word and two more.
    a.words.assign(a.plane * static_cast<std::size_t>((n[axis] + kBelow + 31) / 32 + 3), 0);
  }
  // One task fills the three packings of a slab of leaves. Slabs along z share words of the
  // columns along z, so a slab there is two words thick: 64 voxels.
  const int slabs = (n.z() + 63) / 64;
  tbb::parallel_for(0, slabs, [&](int slab) {
    const Eigen::Vector3i leaves = model.grid.leaf_dims();
    const int z_end = std::min((slab + 1) * 8, leaves.z());
    for (int lz = slab * 8; lz < z_end; ++lz) {
      for (int ly = 0; ly < leaves.y(); ++ly) {
        for (int lx = 0; lx < leaves.x(); ++lx) {
          const LeafBits& bits = model.leaves[lx + leaves.x() * (ly + leaves.y() * lz)];
          for (int k = 0; k < 8; ++k) {
            const int z = lz * 8 + k;
            for (std::uint64_t rest = bits.words[k]; rest != 0;) {
              const int row = std::countr_zero(rest) / 8;  // a y with solid voxels
              const std::uint64_t byte = rest >> (8 * row) & 0xff;
              rest &= ~(std::uint64_t{0xff} << (8 * row));
              const int y = ly * 8 + row;
              *word_of(0, {lx * 8, y, z}) |= static_cast<std::uint32_t>(byte) << (8 * (lx & 3));
              for (std::uint64_t b = byte; b != 0; b &= b - 1) {
                const Cell c(lx * 8 + std::countr_zero(b), y, z);
                *word_of(1, c) |= bit_of(1, c);
                *word_of(2, c) |= bit_of(2, c);
              }
            }
          }
        }
      }
    }
  });
}

}  // namespace sulcus
