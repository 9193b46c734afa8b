// Surfaces of eight maps side by side, their closest points, and what they leave of the heights:
// loops of map_kernels.hpp in single precision, written once and compiled for each instruction set
// by the files that include this; the bits do not depend on the set (simd.hpp).

#pragma once

#include "engine/normals/kernels/simd.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

inline FilterSolutionOf<IntLanes, Lanes> solutions_of(const SurfaceGroup& g) {
  return {load(g.weights[0]),  load(g.weights[1]),  load(g.solution[0]), load(g.solution[1]),
          load(g.solution[2]), load(g.solution[3]), load(g.solution[4]), load(g.solution[5])};
}

/// The surfaces of eight fits.
inline ColumnQuadricOf<Lanes> quadrics_of(const SurfaceGroup& g) {
  std::array<IntLanes, kQuadric> sums;
  for (unsigned f = 0; f < kQuadric; ++f) sums[f] = load(g.sums[f]);
  const QuadricOf<Lanes> fitted =
      quadric_of(sums, load(g.centre), load(g.level), load(g.sign), solutions_of(g), to_float);
  const FilterAnswersOf<Lanes> answers{load(g.answers[0]), load(g.answers[1]), load(g.answers[2]),
                                       load(g.answers[3]), load(g.answers[4]), load(g.answers[5]),
                                       load(g.answers[6]), load(g.answers[7])};
  return column_quadric(fitted, answers, 1.0f);
}

using Vectors = std::array<Lanes, 3>;  // eight, by component

inline Vectors load3(const float (&v)[3][SurfaceGroup::kSize]) {
  return {load(v[0]), load(v[1]), load(v[2])};
}
inline Lanes dot(const Vectors& a, const Vectors& b) {
  return a[0] * b[0] + (a[1] * b[1] + a[2] * b[2]);
}

/// The normals in index space (to_index_space), by lane.
inline Vectors store_normals(const ClosestPointOf<Lanes>& closest, SurfaceGroup& g) {
  const Lanes u = closest.normal_x, v = closest.normal_y, w = load(g.sign) * closest.normal_z;
  const IntLanes axis = load(g.axis), along_x = axis == 0, along_y = axis == 1;
  const Vectors normal{along_x   ? w
                       : along_y ? v
                                 : u,
                       along_x   ? u
                       : along_y ? w
                                 : v,
                       along_x   ? v
                       : along_y ? u
                                 : w};
  for (unsigned a = 0; a < 3; ++a) store(normal[a], g.index_normal[a]);
  return normal;
}

/// The tool hint of each (tool_hint).
inline Vectors tool_hints(const Vectors& coarse, const SurfaceGroup& g) {
  Vectors tool = load3(g.tool);
  const Lanes along = dot(coarse, tool);
  const IntLanes far_side =
      (along < 0.0f) & (along * along > 0.25f * dot(coarse, coarse) * dot(tool, tool));
  for (Lanes& component : tool) component = where(~far_side, component);
  return tool;
}

/// Which normals are consistent (is_consistent).
inline IntLanes consistent(const Vectors& normal, const SurfaceGroup& g) {
  const Vectors coarse = load3(g.coarse);
  const Lanes tool = dot(normal, tool_hints(coarse, g));
  return (dot(normal, coarse) > 0.0f) & ~(tool < 0.0f);
}

/// A bit for each voxel of the groups, from what `each` makes of a group.
template <class Each>
inline std::uint64_t bits_of_groups(SurfaceGroup* groups, std::size_t count, const Each& each) {
  std::uint64_t bits = 0;
  for (std::size_t e = 0; e < count; ++e) {
    bits |= std::uint64_t{bits_of(each(groups[e]))} << (SurfaceGroup::kSize * e);
  }
  return bits;
}

inline VoxelAxes choose_axes(SurfaceGroup* groups, std::size_t voxels, EqualAxes equal) noexcept {
  const std::size_t count = (voxels + SurfaceGroup::kSize - 1) / SurfaceGroup::kSize;
  const IntLanes none{}, all = ~none;
  const IntLanes prefers_y = equal == EqualAxes::kMiddle ? all : none,
                 prefers_z = equal == EqualAxes::kLast ? all : none;
  VoxelAxes axes;
  for (std::size_t e = 0; e < count; ++e) {
    SurfaceGroup& g = groups[e];
    const IntLanes x = load(g.around[0]), y = load(g.around[1]), z = load(g.around[2]);
    const IntLanes solid = (x | y | z) != 0;
    const auto or_tool = [&](const IntLanes& sum, const float* tool) {
      return solid ? to_float(-sum) : load(tool);
    };
    const Vectors out{or_tool(x, g.tool[0]), or_tool(y, g.tool[1]), or_tool(z, g.tool[2])};
    for (unsigned a = 0; a < 3; ++a) store(out[a], g.coarse[a]);
    const Lanes size[] = {abs(out[0]), abs(out[1]), abs(out[2])};
    const Lanes largest = larger(larger(size[0], size[1]), size[2]);
    const IntLanes x_is = size[0] == largest, y_is = size[1] == largest, z_is = size[2] == largest;
    const IntLanes two_equal = (x_is & y_is) | ((x_is | y_is) & z_is);
    const IntLanes is_y = y_is & (prefers_y | (prefers_z & ~z_is) | (~prefers_z & ~x_is));
    const IntLanes is_z = z_is & (prefers_z | ~(x_is | y_is));
    const auto by_axis = [&](const auto& if_x, const auto& if_y, const auto& if_z) {
      return is_z ? if_z : is_y ? if_y : if_x;
    };
    const IntLanes outward = by_axis(out[0], out[1], out[2]) > 0.0f;
    store(outward ? Lanes{} + 1.0f : Lanes{} - 1.0f, g.sign);
    store(by_axis(IntLanes{}, IntLanes{} + 1, IntLanes{} + 2), g.axis);
    const IntLanes in_leaf = IntLanes{} + (HeightTile::kEdge - 1);
    const IntLanes i = load(g.voxel[0]) & in_leaf, j = load(g.voxel[1]) & in_leaf,
                   k = load(g.voxel[2]) & in_leaf;
    store(by_axis(k, i, j) * HeightTile::kEdge + by_axis(j, k, i), g.column);
    store(by_axis(i, j, k), g.layer);
    const IntLanes has_direction = largest != 0.0f;
    const auto put = [&](const IntLanes& mask, std::uint64_t& bits) {
      bits |= std::uint64_t{bits_of(mask & has_direction)} << (SurfaceGroup::kSize * e);
    };
    put(all, axes.has_direction);
    put(two_equal, axes.two_equal);
    put(x_is & y_is & z_is, axes.three_equal);
  }
  const std::uint64_t are_voxels =
      ~std::uint64_t{0} >> (64 - voxels);  // the last group may not be full
  axes.has_direction &= are_voxels;
  axes.two_equal &= are_voxels;
  axes.three_equal &= are_voxels;
  return axes;
}

inline TileMaps look_up(const HeightTile::Column* columns, const std::int32_t* origin, int ns,
                        int trace, int least_rings, SurfaceGroup* groups,
                        std::size_t count) noexcept {
  const int reach = trace < HeightTile::kReach ? trace : HeightTile::kReach;
  TileMaps maps;
  for (std::size_t e = 0; e < count; ++e) {
    SurfaceGroup& g = groups[e];
    static_assert(sizeof(HeightTile::Column) == sizeof(std::int32_t));
    IntLanes column;
    __builtin_memcpy(&column, columns + SurfaceGroup::kSize * e, sizeof column);
    const auto byte = [&](int n) { return column << (24 - 8 * n) >> 24; };  // with its sign
    const IntLanes layer = load(g.layer), height = byte(0), above = height - layer;
    store(height, g.centre);
    store(above, g.level);
    const IntLanes apart = (load(g.voxel[0]) ^ origin[0]) | (load(g.voxel[1]) ^ origin[1]) |
                           (load(g.voxel[2]) ^ origin[2]);
    const IntLanes has = ((apart & -HeightTile::kEdge) == 0) & (above >= -kMaxStep) &
                         (above <= kMaxStep) & (byte(1) - layer <= reach) &
                         (byte(2) - layer >= -reach);
    const IntLanes rings = byte(3);
    const auto put = [&](const IntLanes& mask, std::uint64_t& bits) {
      bits |= std::uint64_t{bits_of(mask)} << (SurfaceGroup::kSize * e);
    };
    put(has & (rings == ns), maps.even);
    put(has & (rings < ns) & (rings >= least_rings), maps.partly);
  }
  return maps;
}

/// Stores surfaces' closest points. Returns which normals are consistent.
inline IntLanes store_closest(const ColumnQuadricOf<Lanes>& q, SurfaceGroup& g) {
  const ClosestPointOf<Lanes> closest = closest_point_of(q, square_root);
  store(closest.normal_x, g.normal_x), store(closest.normal_y, g.normal_y);
  store(closest.normal_z, g.normal_z), store(closest.offset, g.offset);
  store((abs(q.c[3]) + abs(q.c[5]) + abs(q.c[4])) * closest.normal_z, g.curvature);
  return consistent(store_normals(closest, g), g);
}

inline void store_quadrics(const ColumnQuadricOf<Lanes>& q, SurfaceGroup& g) {
  for (unsigned f = 0; f < kQuadric; ++f) store(q.c[f], g.c[f]);
  store(q.t_x, g.t_x), store(q.t_y, g.t_y), store(q.quartic, g.quartic);
}

inline std::uint64_t surfaces_of(SurfaceGroup* groups, std::size_t count,
                                 SurfaceParts parts) noexcept {
  return bits_of_groups(groups, count, [parts](SurfaceGroup& g) {
    const ColumnQuadricOf<Lanes> q = quadrics_of(g);
    if (parts == SurfaceParts::kAll) store_quadrics(q, g);
    return store_closest(q, g);
  });
}

inline void sharpen_group(SurfaceGroup& g) noexcept {
  ColumnQuadricOf<Lanes> q;
  ResidualCubesOf<Lanes> cubes;
  for (unsigned f = 0; f < kQuadric; ++f) q.c[f] = load(g.c[f]), cubes[f] = load(g.cubes[f]);
  sharpen(solutions_of(g), cubes, 1.0f, q);
  store_quadrics(q, g);
  store(store_closest(q, g), g.consistent);
}

/// The filters' weights, centre - fall (i^2 + j^2), of all rings of a map: of row +j or -j, by
/// lane, the middle one at kMaxLanes / 2; zero beyond the map.
struct WindowWeightTable {
  alignas(64) float weight[kMaxNeighbourhood + 1][kMaxNeighbourhood + 1][HeightMap::kMaxLanes];
};
constexpr WindowWeightTable make_window_weights() {
  WindowWeightTable table{};
  for (int ns = 1; ns <= kMaxNeighbourhood; ++ns) {
    for (int j = 0; j <= ns; ++j) {
      for (int i = -ns; i <= ns; ++i) {
        table.weight[ns][j][HeightMap::kMaxLanes / 2 + i] = static_cast<float>(
            window_weight_of(ns).centre - window_weight_of(ns).fall * (i * i + j * j));
      }
    }
  }
  return table;
}
inline constexpr WindowWeightTable kWindowWeights = make_window_weights();

/// A surface turned inward, in units of columns, as stored heights are compared with it: the
/// coefficients, and those of x, y and y^3 beyond second order.
template <class Number>
struct InwardOf {
  Number c[kQuadric], tx, ty, cubic;
};
template <class Number>
inline InwardOf<Number> inward(const ColumnQuadricOf<Number>& surface, const Number& sign,
                               float stride) {
  const Number per_column = sign * stride, area = per_column * stride;
  const auto& c = surface.c;
  const Number ty = surface.t_y * stride, c5 = c[5] * area;
  return {
      {(c[0] - 0.5f) * sign, c[1] * per_column, c[2] * per_column, c[3] * area, c[4] * area, c5},
      surface.t_x * stride,
      ty,
      c5 * ty};
}

/// Of the cubes, in eight lanes each; and of the largest squares.
struct ResidualSums {
  std::array<Lanes, kQuadric> of;
  Lanes largest2;
};

/// `kNarrow`: the map has rows of sixteen lanes.
template <bool kNarrow>
[[gnu::always_inline]] inline ResidualSums residual_sums(const MapRows& map, int ns,
                                                         const InwardOf<float>& s) {
  const int middle = kNarrow ? 8 : HeightMap::kMaxLanes / 2;
  const int first = kNarrow ? 0 : (middle - ns) & -kRowStep;
  const int end = kNarrow ? 2 * middle : middle + ns + 1;
  ResidualSums sums{};
  for (int at = first; at < end; at += kRowStep) {
    const RowLanes x = kLaneIndex + static_cast<float>(at - middle);
    // By powers of y.
    const RowLanes z2 = s.c[3] * x * x, twist = s.c[4] * x, t = 1.0f + s.tx * x;
    const RowLanes a0 = s.c[0] + s.c[1] * x + z2 * t, a1 = s.c[2] + twist * t + z2 * s.ty,
                   a2 = s.c[5] * t + twist * s.ty;
    const signed char* const row = map.middle + at;
    const auto* weights = &kWindowWeights.weight[ns][0][HeightMap::kMaxLanes / 2 - middle + at];
    RowLanes most2{};
    const auto cube_at = [&](const signed char* heights_at, const RowLanes& surface_at) {
      const RowLanes r = heights_above(heights_at, map.level) - surface_at, r2 = r * r;
      most2 = larger(most2, r2);
      return r2 * r;
    };
    RowLanes cube0 = load_row(weights) * cube_at(row, a0), cube1{}, cube2{}, y{};
    // Rows +j and -j together: what is even in y, and what is odd.
    for (int v = 1; v <= ns; ++v) {
      y += 1.0f;
      const RowLanes yy = y * y;
      const RowLanes even = a2 * yy + a0, odd = (a1 + s.cubic * yy) * y;
      const RowLanes above = cube_at(row + v * map.pitch, even + odd);
      const RowLanes below = cube_at(row - v * map.pitch, even - odd);
      const RowLanes weight = load_row(weights + v * HeightMap::kMaxLanes);
      const RowLanes sum = weight * (above + below), difference = weight * (above - below);
      cube0 += sum, cube1 += difference * y, cube2 += sum * yy;
    }
    const auto add = [&](int f, const RowLanes& v) {
      if (at == first) {
        sums.of[f] = halves_of(v);
      } else {
        add_row(sums.of[f], v);
      }
    };
    add(0, cube0), add(1, cube0 * x), add(2, cube1);
    add(3, cube0 * x * x), add(4, cube1 * x), add(5, cube2);
    take_larger(sums.largest2, where(at_most(abs(x), static_cast<float>(ns)), most2));
  }
  return sums;
}

inline float map_residuals(const MapRows& map, const ColumnQuadric& surface,
                           ResidualCubes& cubes) noexcept {
  const auto sign = static_cast<float>(map.sign);
  const InwardOf<float> s = inward(surface, sign, static_cast<float>(map.stride));
  const ResidualSums sums =
      map.lanes == 16 ? residual_sums<true>(map, map.ns, s) : residual_sums<false>(map, map.ns, s);
  cubes = sum_all(sums.of);
  for (float& cube : cubes) cube *= sign;
  return largest_of(sums.largest2);
}

template <bool kNarrow>
inline void group_residuals(const MapRows* maps, int ns, unsigned which, SurfaceGroup& g) {
  constexpr unsigned kSize = SurfaceGroup::kSize;
  ColumnQuadricOf<Lanes> q;
  for (unsigned f = 0; f < kQuadric; ++f) q.c[f] = load(g.c[f]);
  q.t_x = load(g.t_x), q.t_y = load(g.t_y);
  const InwardOf<Lanes> all = inward(q, load(g.sign), 1.0f);
  alignas(32) float c[kQuadric][kSize], tx[kSize], ty[kSize], cubic[kSize];
  for (unsigned f = 0; f < kQuadric; ++f) store(all.c[f], c[f]);
  store(all.tx, tx), store(all.ty, ty), store(all.cubic, cubic);
  Lanes of[kQuadric][kSize], largest2[kSize];
  for (unsigned k = 0; k < kSize; ++k) {
    ResidualSums sums{};
    if ((which >> k & 1u) != 0) {
      sums = residual_sums<kNarrow>(
          maps[k], ns,
          {{c[0][k], c[1][k], c[2][k], c[3][k], c[4][k], c[5][k]}, tx[k], ty[k], cubic[k]});
    }
    for (unsigned f = 0; f < kQuadric; ++f) of[f][k] = sums.of[f];
    largest2[k] = sums.largest2;
  }
  for (unsigned f = 0; f < kQuadric; ++f) store(load(g.sign) * sum_each(of[f]), g.cubes[f]);
  store(largest_each(largest2), g.largest2);
}

inline void group_residuals(const MapRows* maps, unsigned which, SurfaceGroup& g) noexcept {
  if (which == 0) return;
  const MapRows& first = maps[__builtin_ctz(which)];
  first.lanes == 16 ? group_residuals<true>(maps, first.ns, which, g)
                    : group_residuals<false>(maps, first.ns, which, g);
}

}  // namespace

}  // namespace sulcus
