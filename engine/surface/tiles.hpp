#pragma once

#include "engine/core/parallel.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

/// Calls `visit(low, high)` for the boxes of at most `edge` cells along each axis that make up
/// [low, high), from several threads (oneTBB).
template <class Visit>
void for_each_tile(const Cell& low, const Cell& high, int edge, const Visit& visit) {
  const Cell tiles = (high - low + Cell::Constant(edge - 1)).cwiseMax(0) / edge;
  parallel_for(0, tiles.prod(), [&](int t) {
    const Cell at(t % tiles.x(), t / tiles.x() % tiles.y(), t / tiles.x() / tiles.y());
    const Cell first = low + at * edge;
    visit(first, Cell((first + Cell::Constant(edge)).cwiseMin(high)));
  });
}

}  // namespace sulcus
