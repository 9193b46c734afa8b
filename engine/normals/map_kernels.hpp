#pragma once

#include "engine/core/instruction_set.hpp"
#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"
#include "engine/normals/height_tile.hpp"
#include "engine/normals/quadric_filter.hpp"
#include "engine/normals/window_filter.hpp"

namespace sulcus {

/// Where a voxel stands in the windows of its columns: bit kLevel of column (0, 0) is its own.
inline constexpr int kLevel = 16;

/// 120 / distance by its square, in integers below 128.
inline constexpr std::array<int, 7> kCoarseWeight{0, 120, 85, 69, 60, 54, 49};

/// Eight fits of maps, and their surfaces, side by side.
struct alignas(32) SurfaceGroup {
  static constexpr int kSize = 8;
  std::int32_t sums[kQuadric][kSize]{};
  std::int32_t centre[kSize]{};  // height at the centre, as in the sums
  std::int32_t level[kSize]{};   // and above the voxel
  float sign[kSize]{};
  // Of their filters, as FilterSolution and FilterAnswers list them.
  std::int32_t weights[2][kSize]{};
  float solution[6][kSize]{};
  float answers[8][kSize]{};
  // The axis that the columns run along; the coarse normal, and what the tool says, index space.
  std::int32_t axis[kSize]{};
  float coarse[3][kSize]{}, tool[3][kSize]{};
  // For `choose_axes`: the voxel, and the sums of `coarse` about it. Filled in: where it is in a
  // tile of its leaf, v kEdge + u and w.
  std::int32_t voxel[3][kSize]{}, around[3][kSize]{}, column[kSize]{}, layer[kSize]{};
  // Of their residuals, by `group_residuals`: sums of the cubes, and the largest square.
  float cubes[kQuadric][kSize]{}, largest2[kSize]{};
  // Filled in:
  float c[kQuadric][kSize], t_x[kSize], t_y[kSize], quartic[kSize];
  float normal_x[kSize], normal_y[kSize], normal_z[kSize], offset[kSize];
  // The normal in index space; by `sharpen_group` whether (-1) it is consistent: points away from
  // neither the coarse one nor the tool hint.
  float index_normal[3][kSize];
  std::int32_t consistent[kSize];
  float curvature[kSize];  // of the surface across itself, a column out

  void put(int k, const QuadricSums& of, int at_centre, int above_voxel, int outward,
           const QuadricFilter& filter) {
    centre[k] = at_centre;
    level[k] = above_voxel;
    sign[k] = static_cast<float>(outward);
    put_sums(k, of, filter);
  }
  void put_sums(int k, const QuadricSums& of, const QuadricFilter& filter) {
    for (std::size_t f = 0; f < kQuadric; ++f) sums[f][k] = of[f];
    if (filters_[k] == &filter) return;
    filters_[k] = &filter;
    const FilterSolution& s = filter.solution;
    weights[0][k] = s.weights, weights[1][k] = s.weights_ii;
    solution[0][k] = s.value, solution[1][k] = s.value_curvature, solution[2][k] = s.curvature;
    solution[3][k] = s.curvature_across, solution[4][k] = s.slope, solution[5][k] = s.twist;
    const FilterAnswers& a = filter.answers;
    answers[0][k] = a.slope_x3, answers[1][k] = a.slope_xy2;
    answers[2][k] = a.value_x4, answers[3][k] = a.value_x2y2;
    answers[4][k] = a.curvature_x4, answers[5][k] = a.curvature_x2y2,
    answers[6][k] = a.curvature_y4;
    answers[7][k] = a.twist_x3y;
  }
  void put_voxel(int k, const int* cell, const float* outward, const std::int32_t* sums_about) {
    for (int a = 0; a < 3; ++a) {
      voxel[a][k] = cell[a], tool[a][k] = outward[a], around[a][k] = sums_about[a];
    }
  }
  Eigen::Vector3f normal(int k) const {
    return {index_normal[0][k], index_normal[1][k], index_normal[2][k]};
  }
  ColumnQuadric surface(int k) const {
    return {{c[0][k], c[1][k], c[2][k], c[3][k], c[4][k], c[5][k]}, t_x[k], t_y[k], quartic[k]};
  }
  ClosestPoint closest_point(int k) const {
    return {normal_x[k], normal_y[k], normal_z[k], offset[k]};
  }

 private:
  std::array<const QuadricFilter*, kSize> filters_{};  // whose numbers are there already
};

/// What is stored of the surfaces of a group.
enum class SurfaceParts : std::uint8_t { kClosestPoints, kAll };

/// A side of a map: columns with i x + j y >= -behind, (x, y) a unit vector; all where it is zero.
struct MapSide {
  float x = 0.0f, y = 0.0f, behind = 0.0f;
};

/// A tilted frame over a map, axes in map space (i, j, outward), and a ball about the voxel, or the
/// part of it over a side of the map.
struct TiltedFrame {
  std::array<float, 3> u{}, w{}, n{};
  float radius = 0.0f;
  MapSide side;
};

/// The points of a map in a ball one after the other, row by row, coordinates in the tilted frame
/// in units of the radius; weights 1 - r^2 / (1.05 R^2). All zero from `count` to the end of its
/// sixteen.
struct TiltedPoints {
  static constexpr int kTogether = 16;  // are added up side by side
  static constexpr int kCapacity = HeightMap::kMaxRows * HeightMap::kMaxLanes + kTogether;
  int count = 0;
  alignas(64) float weight[kCapacity], u[kCapacity], w[kCapacity], n[kCapacity];
};

/// Sums over points: m[a][b] of weight u^a w^b, z[a][b] of weight u^a w^b n.
struct TiltedMoments {
  float m[5][5], z[3][3];
};

/// Up to eight fits to points in tilted frames, side by side.
struct alignas(32) TiltedGroup {
  static constexpr int kSize = 8;
  // Frames and moments.
  float u[3][kSize]{}, w[3][kSize]{}, n[3][kSize]{}, radius[kSize]{};
  float m[5][5][kSize]{}, z[3][3][kSize]{};
  // Surfaces in units of the radius, and whether (-1) the points determine them.
  float quadric[kQuadric][kSize], plane[3][kSize];
  std::int32_t has_quadric[kSize], has_plane[kSize];
  // Closest points to the voxels' centres on `quadric`: normals in map space, and offsets in
  // voxels.
  float normal[3][kSize], offset[kSize];

  void put_frame(int k, const TiltedFrame& frame) {
    for (unsigned a = 0; a < 3; ++a) {
      u[a][k] = frame.u[a], w[a][k] = frame.w[a], n[a][k] = frame.n[a];
    }
    radius[k] = frame.radius;
  }
  void put_moments(int k, const TiltedMoments& moments) {
    for (int a = 0; a <= 4; ++a) {
      for (int b = 0; a + b <= 4; ++b) m[a][b][k] = moments.m[a][b];
    }
    for (int a = 0; a <= 2; ++a) {
      for (int b = 0; a + b <= 2; ++b) z[a][b][k] = moments.z[a][b];
    }
  }
  Quadric quadric_at(int k) const {
    return {quadric[0][k], quadric[1][k], quadric[2][k],
            quadric[3][k], quadric[4][k], quadric[5][k]};
  }
  void put_quadric(int k, const Quadric& c) {
    for (unsigned f = 0; f < kQuadric; ++f) quadric[f][k] = c[f];
  }
  ClosestPoint closest_point(int k) const {
    return {normal[0][k], normal[1][k], normal[2][k], offset[k]};
  }
};

/// The rows of a whole map, where they lie: in the map itself, or in a tile.
struct MapRows {
  const signed char* middle = nullptr;  // row through the voxel, lanes / 2 lanes before it
  std::ptrdiff_t pitch = 0;             // from one row to the next
  int level = 0;                        // of the voxel, as the heights count
  int ns = 0, stride = 1, sign = 1, lanes = 0;
};
inline MapRows rows_of(const HeightMap& map) {
  return {map.middle_row(), map.lanes, 0, map.ns, map.stride, map.sign, map.lanes};
}
/// Of the map of the voxel at (u, v, w) in the leaf, which the tile has.
inline MapRows rows_of(const HeightTile& tile, int u, int v, int w) {
  return {tile.middle_row(u, v), HeightTile::kLanes, w, tile.ns, 1, tile.sign, lanes_of(tile.ns)};
}

/// Residuals of a surface over points.
struct Residuals {
  float largest = 0.0f, sum_squares = 0.0f;
};

/// Sums over pixels for a plane z = c0 + c1 i + c2 j, twice z; whole numbers below 2^24, so exact
/// in any order.
struct PlaneSums {
  float n = 0, i = 0, j = 0, ii = 0, ij = 0, jj = 0, z = 0, iz = 0, jz = 0;
};

/// A plane over a map, its slopes by column, and how far a pixel may lie from it, across it, to be
/// on it.
struct HeightPlane {
  float c0 = 0, c1 = 0, c2 = 0;
  float cosine = 1;
  float slack = 0;
};

/// What a column on a plane counts when the plane is fitted again, by its residual r across it.
enum class PlaneWeight : std::uint8_t {
  kWindow,    // least squares under the map's window weights, 1 - (i^2 + j^2) / (2.5 NS^2)
  kQuartic,   // a step of Newton's towards the least sum of r^4 under it, times 3
  kInterior,  // one towards the least sum of -log(bound^2 - r^2)
};

/// What lies on a plane.
struct PlaneLook {
  Residuals residuals;  // across it, voxels
  int count = 0;        // columns
};

/// The disc of 6.8 voxels that lies in a map, and its halves: half d is up to 90 degrees to either
/// side of the direction of 45 d degrees from i towards j, the line between the halves in both.
inline constexpr int kDiscReach = 6, kHalves = 8;

/// Of axes along which a coarse normal has equally large components, the one that a map is traced
/// along: where three are, all of these differ, where two are, the first and the last.
enum class EqualAxes : std::uint8_t { kFirst, kLast, kMiddle };
/// Of up to 64 voxels, a bit for each that has a coarse normal, whose largest component two or more
/// axes share, and three.
struct VoxelAxes {
  std::uint64_t has_direction = 0, two_equal = 0, three_equal = 0;
};

/// Which of up to 64 voxels have maps in their tiles, a bit for each: even throughout, or not.
struct TileMaps {
  std::uint64_t even = 0, partly = 0;
};

/// The inner loops over a local distance map, in one instruction set. All give the same bits: sums
/// of heights are whole numbers, sums in single precision run in 8 lanes that are added up in one
/// order. Pure, no allocation.
struct MapKernels {
  const char* name = "";

  /// Sums of offset over distance of the solid voxels within 2.5 of each of so many voxels, times
  /// 120, by axis; `rows` are the windows along x about it, bit 0 two voxels below.
  void (*coarse)(const ColumnBits::Windows* rows, std::size_t count,
                 std::array<std::int32_t, 3>* sums) noexcept = nullptr;

  /// Traces so many maps, at least one, of one neighbourhood and stride, each from the columns
  /// around its voxel (ColumnBits::around, the voxel at kLevel). The middle row is traced outward
  /// from the voxel's own column, the others outward from it row by row, or as the map's order
  /// says: a column starts at its inner neighbour's height and takes the surface nearest to it, the
  /// outer one of two, at most kMaxStep away, so that the map follows the surface down slopes and
  /// does not jump to the far side of a thin wall.
  void (*trace)(const ColumnBits::Windows* columns, std::size_t count, int trace,
                HeightMap* maps) noexcept = nullptr;

  /// Reads a tile from the columns about a leaf (its lowest layer at kBelow), `tile.ns` and `.sign`
  /// set.
  void (*tile)(const ColumnBits::Windows& columns, HeightTile& tile) noexcept = nullptr;
  /// Cuts the map of the voxel at (u, v, w) in the leaf out of a tile: what `trace` would give,
  /// down to the last bit. False where the tile has no answer; then the map is not filled in.
  bool (*cut)(const HeightTile& tile, int u, int v, int w, int trace,
              HeightMap& map) noexcept = nullptr;

  /// The filter's sums over the rows of a map, `pitch` from one to the next; `middle` begins the
  /// one through the voxel, `filter.lanes` / 2 lanes before it. What the filter does not weigh may
  /// be anything.
  void (*fit)(const signed char* middle, std::ptrdiff_t pitch, const QuadricFilter& filter,
              QuadricSums& sums) noexcept = nullptr;

  /// Coarse normals of so many voxels, 1 to 64, in their groups, of the tool where the solid has
  /// none; the axis and sign of their maps, and where they are in their tiles. No bits beyond them.
  VoxelAxes (*choose_axes)(SurfaceGroup* groups, std::size_t voxels,
                           EqualAxes equal) noexcept = nullptr;
  /// Heights at the centres, from the columns of so many groups' voxels in their tiles, and which
  /// of the voxels are of the leaf that begins at `origin` and have maps of at least so many even
  /// rings.
  TileMaps (*look_up)(const HeightTile::Column* columns, const std::int32_t* origin, int ns,
                      int trace, int least_rings, SurfaceGroup* groups,
                      std::size_t count) noexcept = nullptr;

  /// Surfaces of stride 1 of so many groups, up to eight: their closest points, normals in index
  /// space and curvatures, and the quadrics themselves with kAll. A bit for each whose normal is
  /// consistent.
  std::uint64_t (*surfaces)(SurfaceGroup* groups, std::size_t count,
                            SurfaceParts parts) noexcept = nullptr;

  /// Residuals of surfaces of stride 1 over their whole maps, as `map_residuals`; `which` has a bit
  /// for each that is asked for.
  void (*group_residuals)(const MapRows* maps, unsigned which,
                          SurfaceGroup& group) noexcept = nullptr;
  /// Surfaces of stride 1 sharpened by their residuals, their closest points and curvatures, and
  /// which are consistent.
  void (*sharpen_group)(SurfaceGroup& group) noexcept = nullptr;

  /// Largest (height - surface)^2 over a whole map, voxels^2, the surface without its quartic part,
  /// and sums of the cubes of such residuals.
  float (*map_residuals)(const MapRows& map, const ColumnQuadric& surface,
                         ResidualCubes& cubes) noexcept = nullptr;

  /// Sums over the columns within 3.6 voxels of the voxel, in space.
  void (*close_sums)(const HeightMap& map, PlaneSums& sums) noexcept = nullptr;

  /// Sums over all columns of a map that lie on a plane (no steeper than kLeastPlaneCosine): of
  /// their weights, and in place of z of the right side, so that their solution is to be added to
  /// the plane, across it. `bound`, for kInterior: above all their residuals.
  void (*plane_step)(const HeightMap& map, const HeightPlane& plane, PlaneWeight weight,
                     float bound, PlaneSums& sums) noexcept = nullptr;
  void (*look_at_plane)(const HeightMap& map, const HeightPlane& plane,
                        PlaneLook& look) noexcept = nullptr;

  /// Sums over the halves of the disc.
  void (*halves)(const HeightMap& map, std::array<PlaneSums, kHalves>& sums) noexcept = nullptr;
  /// Of a half, what lies on a plane.
  void (*on_plane)(const HeightMap& map, int half, const HeightPlane& plane,
                   PlaneSums& sums) noexcept = nullptr;
  /// Residuals across `plane`, voxels, of what lies on `first`.
  void (*plane_residuals)(const HeightMap& map, int half, const HeightPlane& first,
                          const HeightPlane& plane, Residuals& residuals) noexcept = nullptr;

  void (*gather)(const HeightMap& map, const TiltedFrame& frame,
                 TiltedPoints& points) noexcept = nullptr;
  void (*moments)(const TiltedPoints& points, TiltedMoments& moments) noexcept = nullptr;
  /// In units of the radius.
  void (*residuals)(const TiltedPoints& points, const Quadric& quadric,
                    Residuals& residuals) noexcept = nullptr;
  /// Takes a quadric off the points, and weighs each by the square of what is left besides.
  void (*sharpen_points)(const Quadric& quadric, TiltedPoints& points) noexcept = nullptr;
  /// Quadrics and planes from the moments, less what quantisation adds to these; quadrics of
  /// sharpened points.
  void (*solve_quantised)(TiltedGroup& group) noexcept = nullptr;
  void (*solve_sharpened)(TiltedGroup& group) noexcept = nullptr;
  /// Of the voxels' centres on the quadrics of a group.
  void (*tilted_closest_points)(TiltedGroup& group) noexcept = nullptr;

  /// Sums over a row for eight windows of heights whose centres are at `centre` and the next seven,
  /// of each of `count` sizes, in order of their rings.
  void (*sum_row)(const std::int16_t* centre, const RowOfWindows* windows,
                  int count) noexcept = nullptr;
  /// Fits of those windows from such sums, one row after another: `middle` are those of the row of
  /// the centres. Of heights that are kNoHeight none is made.
  void (*fit_windows)(const std::int16_t* centre, const RowSums* middle, const WindowFilter& filter,
                      WindowFits& fits) noexcept = nullptr;
};

/// Compiled for a set; null where the processor or the build has none.
const MapKernels* map_kernels_of(InstructionSet set) noexcept;
/// Those of `instruction_set()`, found once.
const MapKernels& map_kernels() noexcept;

/// Where each set's are; null where the build has none.
const MapKernels* avx2_map_kernels() noexcept;
const MapKernels* avx512_map_kernels() noexcept;

}  // namespace sulcus
