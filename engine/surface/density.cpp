#include "engine/surface/density.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include "engine/core/parallel.hpp"

namespace sulcus {
namespace {

/// Solid voxels of the 4x4x4 cells of 2x2x2 voxels in a leaf, x fastest.
std::array<std::uint8_t, 64> half_counts(const LeafBits& leaf) {
  constexpr std::uint64_t kPairs = 0x5555555555555555u;
  constexpr std::uint64_t kFours = 0x3333333333333333u;
  std::array<std::uint8_t, 64> counts{};
  for (int k = 0; k < 4; ++k) {
    const std::uint64_t a = leaf.words[2 * k];
    const std::uint64_t b = leaf.words[2 * k + 1];
    const std::uint64_t in_a = (a & kPairs) + (a >> 1 & kPairs);  // 2 bits per pair along x
    const std::uint64_t in_b = (b & kPairs) + (b >> 1 & kPairs);
    std::uint64_t even = (in_a & kFours) + (in_b & kFours);           // nibbles: pairs 0 and 2
    std::uint64_t odd = (in_a >> 2 & kFours) + (in_b >> 2 & kFours);  // pairs 1 and 3
    even += even >> 8;  // rows 2j and 2j + 1, in byte 2j; at most 8 in a nibble
    odd += odd >> 8;
    for (int j = 0; j < 4; ++j) {
      std::uint8_t* const row = &counts[16 * k + 4 * j];
      row[0] = static_cast<std::uint8_t>(even >> (16 * j) & 15);
      row[1] = static_cast<std::uint8_t>(odd >> (16 * j) & 15);
      row[2] = static_cast<std::uint8_t>(even >> (16 * j + 4) & 15);
      row[3] = static_cast<std::uint8_t>(odd >> (16 * j + 4) & 15);
    }
  }
  return counts;
}

/// How full the cells of 1 or 2 voxels' edge in a leaf are, x fastest, from its levels.
std::array<float, 512> fullness(const LeafBits& solid, const FillLevel* page, int level) {
  const int edge = kLeafEdge >> level;  // cells along the leaf
  std::array<int, 512> sums{};
  for_each_voxel(solid, [&](int place) {
    const Cell c = cell_in_leaf(place) / (1 << level);
    sums[static_cast<std::size_t>(c.x() + edge * (c.y() + edge * c.z()))] += page[place];
  });
  const float full = 1.0f / static_cast<float>(kFullLevel << (3 * level));
  std::array<float, 512> full_by{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(edge * edge * edge); ++i) {
    full_by[i] = full * static_cast<float>(sums[i]);
  }
  return full_by;
}

/// Of the eight cells of 4 voxels' edge in a leaf, x fastest: what is filled, in voxels, rounded.
std::array<int, 8> filled_quarters(const LeafBits& solid, const FillLevel* page) {
  std::array<int, 8> sums{};
  for_each_voxel(solid, [&](int place) {
    const Cell c = cell_in_leaf(place) / 4;
    sums[static_cast<std::size_t>(c.x() + 2 * (c.y() + 2 * c.z()))] += page[place];
  });
  for (int& sum : sums) sum = (sum + kFullLevel / 2) / kFullLevel;
  return sums;
}

std::size_t at(const DensityBlock& block, int x, int y, int z) {
  return static_cast<std::size_t>(x) +
         static_cast<std::size_t>(block.dims.x()) *
             (static_cast<std::size_t>(y) + static_cast<std::size_t>(block.dims.y()) * z);
}

}  // namespace

void DensityBlock::reshape(const Eigen::Vector3i& first_sample,
                           const Eigen::Vector3i& sample_dims) {
  first = first_sample;
  dims = sample_dims;
  values.resize(static_cast<std::size_t>(dims.x()) * dims.y() * dims.z());
}

Density::Density(const VoxelModel& model)
    : quarter_dims_(model.grid.cells / 4), quarter_(model.grid.cell_count() / 64) {
  const std::uint32_t plane = static_cast<std::uint32_t>(model.grid.leaf_dims().head<2>().prod());
  parallel_for(std::uint32_t{0}, model.grid.leaf_count() / plane, [&](std::uint32_t layer) {
    for (std::uint32_t l = layer * plane; l < (layer + 1) * plane; ++l) update(model, l);
  });
}

void Density::update(const VoxelModel& model, std::uint32_t leaf) {
  constexpr std::uint64_t kCorner = 0x000000000F0F0F0Fu;  // x 0 to 3, y 0 to 3 of a slice
  const LeafBits& bits = model.leaves[leaf];
  const FillLevel* const page = model.fills ? model.fills->page(leaf) : nullptr;
  const std::array<int, 8> filled = page ? filled_quarters(bits, page) : std::array<int, 8>{};
  const Cell first = model.grid.leaf_origin(leaf) / 4;
  for (int k = 0; k < 2; ++k) {
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 2; ++i) {
        int count = filled[static_cast<std::size_t>(i + 2 * (j + 2 * k))];
        for (int s = 0; s < 4 && !page; ++s) {
          count += std::popcount(bits.words[4 * k + s] & kCorner << (32 * j + 4 * i));
        }
        const std::size_t index =
            static_cast<std::size_t>(first.x() + i) +
            static_cast<std::size_t>(quarter_dims_.x()) *
                (static_cast<std::size_t>(first.y() + j) +
                 static_cast<std::size_t>(quarter_dims_.y()) * (first.z() + k));
        quarter_[index] = static_cast<std::uint8_t>(count);
      }
    }
  }
}

void Density::sample(const VoxelModel& model, int level, DensityBlock& block) const {
  std::fill(block.values.begin(), block.values.end(), 0.0f);
  const Eigen::Vector3i cells = model.grid.cells / (1 << level);
  const Eigen::Vector3i low = block.first.cwiseMax(0);
  const Eigen::Vector3i high = (block.first + block.dims).cwiseMin(cells);
  if ((low.array() >= high.array()).any()) return;
  if (level >= 2) {
    const float full = level == 3 ? 1.0f / 512.0f : 1.0f / 64.0f;
    for_each_cell(low, high, [&](const Cell& c) {
      int count = level == 2 ? quarter_count(c.x(), c.y(), c.z()) : 0;
      for (int part = 0; level == 3 && part < 8; ++part) {
        count += quarter_count(2 * c.x() + (part & 1), 2 * c.y() + (part >> 1 & 1),
                               2 * c.z() + (part >> 2));
      }
      const Cell p = c - block.first;
      block.values[at(block, p.x(), p.y(), p.z())] = static_cast<float>(count) * full;
    });
    return;
  }
  const int edge = kLeafEdge >> level;  // cells along a leaf
  const float full = level == 0 ? 1.0f : 0.125f;
  const Eigen::Vector3i leaf_low = low / edge;
  const Eigen::Vector3i leaf_high = (high - Eigen::Vector3i::Ones()) / edge;
  for_each_cell(leaf_low, leaf_high + Cell::Ones(), [&](const Cell& leaf) {
    const std::uint32_t number = model.grid.leaf_of(leaf * kLeafEdge);
    const LeafBits& bits = model.leaves[number];
    if (!any(bits)) return;
    const FillLevel* const page = model.fills ? model.fills->page(number) : nullptr;
    const Eigen::Vector3i origin = leaf * edge;
    const Eigen::Vector3i from = low.cwiseMax(origin);
    const Eigen::Vector3i to = high.cwiseMin(origin + Eigen::Vector3i::Constant(edge));
    if (page) {
      const std::array<float, 512> filled = fullness(bits, page, level);
      for_each_cell(from, to, [&](const Cell& c) {
        const Cell p = c - block.first, in_leaf = c - origin;
        block.values[at(block, p.x(), p.y(), p.z())] = filled[static_cast<std::size_t>(
            in_leaf.x() + edge * (in_leaf.y() + edge * in_leaf.z()))];
      });
      return;
    }
    const std::array<std::uint8_t, 64> counts =
        level == 1 ? half_counts(bits) : std::array<std::uint8_t, 64>{};
    for (int z = from.z(); z < to.z(); ++z) {
      for (int y = from.y(); y < to.y(); ++y) {
        float* const row = &block.values[at(block, 0, y - block.first.y(), z - block.first.z())];
        const int j = y - origin.y();
        const int k = z - origin.z();
        for (int x = from.x(); x < to.x(); ++x) {
          const int i = x - origin.x();
          const int count = level == 1 ? counts[i + 4 * j + 16 * k]
                                       : static_cast<int>(bits.words[k] >> (i + 8 * j) & 1);
          row[x - block.first.x()] = full * static_cast<float>(count);
        }
      }
    }
  });
}

namespace {

/// One axis: what wraps round in the block, which is taken as one run, lies within the radius of
/// its border.
template <int radius>
void blur_along(const std::vector<float>& from, std::vector<float>& to, std::ptrdiff_t step,
                const std::array<float, 5>& taps) {
  const auto count = static_cast<std::ptrdiff_t>(from.size());
  const std::ptrdiff_t reach = std::min(radius * step, count);
  const float* const in = from.data();
  float* const out = to.data();
  std::copy(in, in + reach, out);
  std::copy(in + count - reach, in + count, out + count - reach);
  for (std::ptrdiff_t i = reach; i < count - reach; ++i) {
    float sum = taps[0] * in[i];
    for (int r = 1; r <= radius; ++r) sum += taps[r] * (in[i - r * step] + in[i + r * step]);
    out[i] = sum;
  }
}

}  // namespace

void blur(DensityBlock& block, int radius, std::vector<float>& scratch) {
  static constexpr std::array<float, 5> kRadius1{0.5f, 0.25f};
  static constexpr std::array<float, 5> kRadius2{0.375f, 0.25f, 0.0625f};
  static constexpr std::array<float, 5> kRadius4{70.0f / 256, 56.0f / 256, 28.0f / 256, 8.0f / 256,
                                                 1.0f / 256};
  const float first = block.values.empty() ? 0.0f : block.values.front();
  const bool same = std::ranges::all_of(block.values, [&](float v) { return v == first; });
  if (same && (first == 0.0f || first == 1.0f)) return;  // the weights add up to 1: it stays so
  scratch.resize(block.values.size());
  for (const std::ptrdiff_t step : {std::ptrdiff_t{1}, std::ptrdiff_t{block.dims.x()},
                                    std::ptrdiff_t{block.dims.x()} * block.dims.y()}) {
    if (radius == 1) blur_along<1>(block.values, scratch, step, kRadius1);
    if (radius == 2) blur_along<2>(block.values, scratch, step, kRadius2);
    if (radius == 4) blur_along<4>(block.values, scratch, step, kRadius4);
    block.values.swap(scratch);
  }
}

SplineWeights::SplineWeights(const Eigen::Vector3f& p_lattice) {
  for (int a = 0; a < 3; ++a) {
    const float nearest = std::floor(p_lattice[a] + 0.5f);
    const float t = p_lattice[a] - nearest;
    first[a] = static_cast<int>(nearest) - 1;
    weight[a][0] = 0.5f * (0.5f - t) * (0.5f - t);
    weight[a][1] = 0.75f - t * t;
    weight[a][2] = 0.5f * (0.5f + t) * (0.5f + t);
    slope[a][0] = t - 0.5f;
    slope[a][1] = -2.0f * t;
    slope[a][2] = t + 0.5f;
  }
}

DensityAt spline(const DensityBlock& block, const Eigen::Vector3f& p_lattice) {
  const SplineWeights spline(p_lattice);
  const Eigen::Vector3i from = spline.first - block.first;
  const auto& [wx, wy, wz] = spline.weight;
  const auto& [sx, sy, sz] = spline.slope;
  DensityAt result{0.0f, Eigen::Vector3f::Zero()};
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      const float* const row = &block.values[at(block, from.x(), from.y() + j, from.z() + k)];
      const float along = wx[0] * row[0] + wx[1] * row[1] + wx[2] * row[2];
      const float change = sx[0] * row[0] + sx[1] * row[1] + sx[2] * row[2];
      result.value += wy[j] * wz[k] * along;
      result.gradient.x() += wy[j] * wz[k] * change;
      result.gradient.y() += sy[j] * wz[k] * along;
      result.gradient.z() += wy[j] * sz[k] * along;
    }
  }
  return result;
}

}  // namespace sulcus
