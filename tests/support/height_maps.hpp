#pragma once

#include "engine/normals/height_map.hpp"

namespace sulcus::test {

/// The map whose heights are `height(i, j)`, whole or kNone; in no ring whole or even.
template <class Height>
HeightMap map_of(int ns, int sign, const Height& height) {
  HeightMap map;
  map.ns = ns;
  map.sign = sign;
  map.lanes = lanes_of(ns);
  map.whole_rings = map.even_rings = 0;
  map.height.fill(HeightMap::kNone);
  for (int j = -ns; j <= ns; ++j) {
    for (int i = -ns; i <= ns; ++i) {
      map.height[static_cast<std::size_t>(map.place(i, j))] =
          static_cast<signed char>(height(i, j));
    }
  }
  return map;
}

}  // namespace sulcus::test
