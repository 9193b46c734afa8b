#include "engine/surface/occlusion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/core/units.hpp"
#include "engine/surface/tiles.hpp"

namespace sulcus {
namespace {

// The blur's standard deviation is two cells: a quarter of a fissure's depth, a fifth of a burr.
// One cell would do for the depth, but the lattice would show.
constexpr double kCell = 0.14 * kMillimetre;
constexpr int kHalfBlur = 4;
constexpr int kBlur = 2 * kHalfBlur;
constexpr int kKeptLevel = 2;  // of Density::quarter_count

std::size_t at(const Eigen::Vector3i& dims, int x, int y, int z) {
  return static_cast<std::size_t>(x) +
         static_cast<std::size_t>(dims.x()) *
             (static_cast<std::size_t>(y) + static_cast<std::size_t>(dims.y()) * z);
}

/// Holds no cell, and may be united with other boxes.
Occlusion::Box no_cells(const Eigen::Vector3i& dims) { return {dims, Eigen::Vector3i::Zero()}; }

bool empty(const Occlusion::Box& box) { return (box.low.array() >= box.high.array()).any(); }

/// What the blur makes of a change in the cells of a box.
Occlusion::Box blurred(const Occlusion::Box& box, const Eigen::Vector3i& dims) {
  if (empty(box)) return {};
  return {(box.low - Eigen::Vector3i::Constant(kBlur)).cwiseMax(0),
          (box.high + Eigen::Vector3i::Constant(kBlur)).cwiseMin(dims)};
}

}  // namespace

Occlusion::Occlusion(const VoxelModel& model, const Density& density)
    : level_(std::clamp(static_cast<int>(std::lround(std::log2(kCell / model.grid.voxel_m))),
                        kKeptLevel, 6)),
      cell_m_(model.grid.voxel_m * (1 << level_)),
      dims_((model.grid.cells + Eigen::Vector3i::Constant((1 << level_) - 1)) / (1 << level_)),
      half_m_(0.5 * model.grid.voxel_m * model.grid.cells.cast<double>()),
      values_(static_cast<std::size_t>(dims_.x()) * dims_.y() * dims_.z()) {
  smooth(density, {Eigen::Vector3i::Zero(), dims_});
}

/// How full the cells of the texture are from one on along x.
void Occlusion::fill_row(const Density& density, const Cell& first, int cells, float* to) const {
  const int edge = 1 << (level_ - kKeptLevel);
  const float full = 1.0f / (64.0f * static_cast<float>(edge * edge * edge));
  for (int x = 0; x < cells; ++x) {
    const Cell from = (first + Cell(x, 0, 0)) * edge;
    const Cell end = (from + Cell::Constant(edge)).cwiseMin(density.quarter_dims());
    int count = 0;
    for_each_cell(from, end,
                  [&](const Cell& q) { count += density.quarter_count(q.x(), q.y(), q.z()); });
    to[x] = full * static_cast<float>(count);
  }
}

void Occlusion::smooth(const Density& density, const Box& box) {
  constexpr int kTile = 32;  // cells
  for_each_tile(box.low, box.high, kTile, [&](const Cell& low, const Cell& high) {
    smooth_tile(density, {low, high});
  });
}

void Occlusion::smooth_tile(const Density& density, const Box& box) {
  thread_local DensityBlock block;
  thread_local std::vector<float> scratch;
  const Eigen::Vector3i margin = Eigen::Vector3i::Constant(kBlur);
  block.reshape(box.low - margin, box.high - box.low + 2 * margin);
  std::fill(block.values.begin(), block.values.end(), 0.0f);
  const Eigen::Vector3i from = block.first.cwiseMax(0);
  const Eigen::Vector3i to = (block.first + block.dims).cwiseMin(dims_);
  const auto row_of = [&](int x, int y, int z) {
    const Cell p = Cell(x, y, z) - block.first;
    return block.values.data() + at(block.dims, p.x(), p.y(), p.z());
  };
  for (int z = from.z(); z < to.z(); ++z) {
    for (int y = from.y(); y < to.y(); ++y) {
      const int cells = to.x() - from.x();
      float* const row = row_of(from.x(), y, z);
      fill_row(density, {from.x(), y, z}, cells, row);
      if (raw_pieces_.empty()) continue;
      const float* const pieces = raw_pieces_.data() + at(dims_, from.x(), y, z);
      // Never denser than solid, also where a piece overlaps.
      for (int x = 0; x < cells; ++x) row[x] = std::min(row[x] + pieces[x], 1.0f);
    }
  }
  blur(block, kHalfBlur, scratch);
  blur(block, kHalfBlur, scratch);
  for (int z = box.low.z(); z < box.high.z(); ++z) {
    for (int y = box.low.y(); y < box.high.y(); ++y) {
      const float* const row = row_of(box.low.x(), y, z);
      std::uint16_t* const values = values_.data() + at(dims_, box.low.x(), y, z);
      for (int x = 0; x < box.high.x() - box.low.x(); ++x) {
        values[x] = static_cast<std::uint16_t>(std::lround(65535.0f * row[x]));
      }
    }
  }
}

Occlusion::Box Occlusion::update(const VoxelModel& model, const Density& density,
                                 std::span<const std::uint32_t> leaves) {
  if (leaves.empty()) return {};
  Box box = no_cells(dims_);
  for (const std::uint32_t leaf : leaves) {
    const Cell first = model.grid.leaf_origin(leaf);
    const Eigen::Vector3i low = first / (1 << level_);
    const Eigen::Vector3i high =
        (first + Cell::Constant(kLeafEdge - 1)) / (1 << level_) + Eigen::Vector3i::Ones();
    box.low = box.low.cwiseMin(low);
    box.high = box.high.cwiseMax(high);
  }
  box = blurred(box, dims_);
  smooth(density, box);
  return box;
}

void Occlusion::add_piece(const VoxelGrid& grid, std::span<const std::uint32_t> voxels) {
  std::vector<std::uint32_t> cells;  // of each voxel
  cells.reserve(voxels.size());
  for (const std::uint32_t voxel : voxels) {
    const Cell c = grid.cell_of_linear(voxel) / (1 << level_);
    cells.push_back(static_cast<std::uint32_t>(at(dims_, c.x(), c.y(), c.z())));
  }
  std::sort(cells.begin(), cells.end());
  const float voxel_density = 1.0f / static_cast<float>(1 << (3 * level_));
  Piece& piece = pieces_.emplace_back();
  piece.box = no_cells(dims_);
  for (std::size_t first = 0, end = 0; first < cells.size(); first = end) {
    while (end < cells.size() && cells[end] == cells[first]) ++end;
    const int cell = static_cast<int>(cells[first]);
    piece.cells.push_back({Eigen::Vector3i(cell % dims_.x(), cell / dims_.x() % dims_.y(),
                                           cell / dims_.x() / dims_.y()),
                           voxel_density * static_cast<float>(end - first)});
  }
  raw_pieces_.resize(values_.size());
}

/// Adds what a piece has in each cell to the eight cells nearest to where that is now.
void Occlusion::put(Piece& piece) {
  piece.box = no_cells(dims_);
  if (!piece.pose) return;
  const Eigen::Matrix3d turn = piece.pose->orientation.toRotationMatrix();
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5);
  for (const PieceCell& part : piece.cells) {
    const Eigen::Vector3d start_world = (part.cell.cast<double>() + half) * cell_m_ - half_m_;
    const Eigen::Vector3d now_world = turn * start_world + piece.pose->position;
    const Eigen::Vector3d now = (now_world + half_m_) / cell_m_ - half;
    // Said this way round so that a pose which is not finite is nowhere.
    const bool inside =
        (now.array() > -1.0).all() && (now.array() < dims_.cast<double>().array()).all();
    if (!inside) continue;
    const Eigen::Vector3i low = now.array().floor().cast<int>();
    const Eigen::Vector3f t = (now - low.cast<double>()).cast<float>();
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3i step(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
      const Eigen::Vector3i c = low + step;
      if ((c.array() < 0).any() || (c.array() >= dims_.array()).any()) continue;
      float weight = part.density;
      for (int a = 0; a < 3; ++a) weight *= step[a] != 0 ? t[a] : 1.0f - t[a];
      raw_pieces_[at(dims_, c.x(), c.y(), c.z())] += weight;
      piece.box.low = piece.box.low.cwiseMin(c);
      piece.box.high = piece.box.high.cwiseMax(c + Eigen::Vector3i::Ones());
    }
  }
}

std::vector<Occlusion::Box> Occlusion::place_pieces(const Density& density,
                                                    std::span<const Pose> world_now_from_start) {
  auto same = [](const Pose& a, const Pose& b) {
    return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
  };
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    std::optional<Pose> now;
    if (i < world_now_from_start.size()) now = world_now_from_start[i];
    std::optional<Pose>& last = pieces_[i].pose;
    if (now.has_value() == last.has_value() && (!now || same(*now, *last))) continue;
    last = now;
    moved.push_back(i);
  }
  if (moved.empty()) return {};

  // All anew, in one order: what comes out does not depend on the way there.
  std::vector<Box> changed(moved.size());
  for (std::size_t n = 0; n < moved.size(); ++n) changed[n] = pieces_[moved[n]].box;
  for (const Piece& piece : pieces_) {
    for (int z = piece.box.low.z(); z < piece.box.high.z(); ++z) {
      for (int y = piece.box.low.y(); y < piece.box.high.y(); ++y) {
        float* const row = raw_pieces_.data() + at(dims_, 0, y, z);
        std::fill(row + piece.box.low.x(), row + piece.box.high.x(), 0.0f);
      }
    }
  }
  for (Piece& piece : pieces_) put(piece);
  for (std::size_t n = 0; n < moved.size(); ++n) {
    const Box& now = pieces_[moved[n]].box;
    const Box both{changed[n].low.cwiseMin(now.low), changed[n].high.cwiseMax(now.high)};
    changed[n] = blurred(both, dims_);
    smooth(density, changed[n]);
  }
  return changed;
}

std::size_t Occlusion::memory_bytes() const {
  std::size_t bytes =
      values_.capacity() * sizeof(std::uint16_t) + raw_pieces_.capacity() * sizeof(float);
  for (const Piece& piece : pieces_) {
    bytes += sizeof(Piece) + piece.cells.capacity() * sizeof(PieceCell);
  }
  return bytes;
}

}  // namespace sulcus
