#include "engine/normals/ldm.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <Eigen/Dense>

namespace sulcus {

namespace {

constexpr int kSide = 2 * kMaxNeighbourhood + 1;
constexpr int kPixels = kSide * kSide;
constexpr std::size_t kLanes = 8;  // of the sums over a map, added up in a fixed order
constexpr std::size_t kPaddedPixels = (kPixels + kLanes - 1) / kLanes * kLanes;
constexpr int kMaxStep = 2;    // of the surface from one column to the next, voxels
constexpr int kMaxUneven = 3;  // |z(p) + z(-p) - 2 z(0)|, voxels
constexpr int kInvalid = 127;  // more than any height and any trace together

// --- Coarse normal ------------------------------------------------------------------------------

// Unit vectors are counted in whole parts, so that sums are exact in any order and equal shapes,
// mirrored ones too, choose equal axes.
constexpr float kUnit = 4096.0f;

/// Sums over the solid voxels of 5 along x, at distance |(j, k)| from the axis, by bit pattern.
struct RowSums {
  float x = 0;        // sum of i / d
  float inverse = 0;  // sum of 1 / d
};

/// By j^2 + k^2 (0..8) and pattern; voxels beyond 2.5 and the centre itself count nothing.
using RowTable = std::array<std::array<RowSums, 32>, 9>;

const RowTable& row_table() {
  static const RowTable table = [] {
    RowTable t;
    for (int jk = 0; jk <= 8; ++jk) {
      for (int pattern = 0; pattern < 32; ++pattern) {
        for (int bit = 0; bit < 5; ++bit) {
          const int i = bit - 2, d2 = i * i + jk;
          if ((pattern >> bit & 1) == 0 || d2 == 0 || d2 > 6) continue;  // 6 < 2.5^2 < 7
          const float inverse = std::nearbyint(kUnit / std::sqrt(static_cast<float>(d2)));
          t[jk][pattern].x += static_cast<float>(i) * inverse;
          t[jk][pattern].inverse += inverse;
        }
      }
    }
    return t;
  }();
  return table;
}

/// Minus the sum of unit vectors to the solid voxels within 2.5: out of the solid, of any length.
Eigen::Vector3f coarse_normal(const Workpiece& workpiece, const Cell& c) noexcept {
  const RowTable& table = row_table();
  const ColumnBits::Windows rows = workpiece.columns().around(0, c.y(), c.z(), c.x() - 2);
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (int k = -2; k <= 2; ++k) {
    for (int j = -2; j <= 2; ++j) {
      const auto pattern = static_cast<unsigned>(rows.window(j, k)) & 31u;
      const RowSums& row = table[j * j + k * k][pattern];
      sum += Eigen::Vector3f(row.x, static_cast<float>(j) * row.inverse,
                             static_cast<float>(k) * row.inverse);
    }
  }
  return -sum;
}

// --- The map ------------------------------------------------------------------------------------

/// Nearest set bit to the middle of five, as its distance from the middle (positive: higher bits);
/// of two equally near the outer one, higher for +1, lower for -1.
constexpr std::array<signed char, 32> nearest_of_five(int outer) {
  std::array<signed char, 32> table{};
  for (int pattern = 0; pattern < 32; ++pattern) {
    table[pattern] = kInvalid;
    for (int step : {0, outer, -outer, 2 * outer, -2 * outer}) {
      if ((pattern >> (step + 2) & 1) != 0) {
        table[pattern] = static_cast<signed char>(step);
        break;
      }
    }
  }
  return table;
}
constexpr auto kNearestUp = nearest_of_five(1);
constexpr auto kNearestDown = nearest_of_five(-1);

/// Pixels of a map in the order of its rings, each walked once around, so that the pixel opposite
/// to the k-th of ring r is the (k + 4 r)-th; a map of fewer rings is the front of one of more.
struct Pixel {
  signed char i = 0, j = 0;
  std::int16_t inner = 0;   // place of the neighbour one ring further in
  std::int16_t column = 0;  // place in SurfaceBits, from the middle
};

constexpr int first_of_ring(int ring) { return ring == 0 ? 0 : (2 * ring - 1) * (2 * ring - 1); }
constexpr int pixel_count(int rings) { return (2 * rings + 1) * (2 * rings + 1); }

constexpr std::array<Pixel, kPixels> ring_order() {
  std::array<Pixel, kPixels> order{};
  std::array<std::array<std::int16_t, kSide>, kSide> place{};
  for (int ring = 1; ring <= kMaxNeighbourhood; ++ring) {
    int i = -ring, j = -ring;
    for (int k = 0; k < 8 * ring; ++k) {
      const int at = first_of_ring(ring) + k;
      place[j + kMaxNeighbourhood][i + kMaxNeighbourhood] = static_cast<std::int16_t>(at);
      const int inner_i = i == ring ? i - 1 : i == -ring ? i + 1 : i;
      const int inner_j = j == ring ? j - 1 : j == -ring ? j + 1 : j;
      order[at] = {static_cast<signed char>(i), static_cast<signed char>(j),
                   place[inner_j + kMaxNeighbourhood][inner_i + kMaxNeighbourhood],
                   static_cast<std::int16_t>(j * kSide + i)};
      const int side = k / (2 * ring);
      (side == 0 ? i : side == 1 ? j : side == 2 ? i : j) += side < 2 ? 1 : -1;
    }
  }
  return order;
}
constexpr std::array<Pixel, kPixels> kRingOrder = ring_order();

/// Heights of the surface over the plane through the voxel, along one axis outward.
struct HeightMap {
  alignas(32) std::array<float, kPaddedPixels> z;  // in the order of kRingOrder
  int rings = -1;                                  // accepted; 0: the centre, -1: not even that
};

/// Columns of a map as bits that mark where the surface may be: a solid voxel whose outer neighbour
/// is empty. Bit kLevel is the voxel's own level, rising along the axis. In the rows of a map of
/// kMaxNeighbourhood rings.
using SurfaceBits = std::array<std::uint64_t, kPixels>;
constexpr int kLevel = 32;
constexpr int kMiddle = kMaxNeighbourhood * (kSide + 1);  // of SurfaceBits

template <int kSign>
void read_surface(const ColumnBits::Windows& windows, int rings, SurfaceBits& bits) noexcept {
  for (int j = -rings; j <= rings; ++j) {
    std::uint64_t* row = bits.data() + kMiddle + j * kSide;
    for (int i = -rings; i <= rings; ++i) {
      const std::uint64_t w = windows.window(i, j);
      row[i] = w & ~(kSign > 0 ? w >> 1 : w << 1);
    }
  }
}

/// Steps from a height to the surface nearest to it in a column, or kInvalid.
template <int kSign>
int step_to_surface(std::uint64_t tops, int from) noexcept {
  const auto five = static_cast<unsigned>(tops >> (kLevel - kMaxStep + kSign * from)) & 31u;
  return kSign > 0 ? kNearestUp[five] : kNearestDown[five];
}

template <int kSign>
void trace_map(const SurfaceBits& bits, int rings, int trace, HeightMap& map) noexcept {
  map.rings = -1;
  std::array<signed char, kPixels> z;
  const int centre = kSign * step_to_surface<kSign>(bits[kMiddle], 0);
  if (std::abs(centre) > kMaxStep) return;
  z[0] = static_cast<signed char>(centre);
  map.z[0] = static_cast<float>(centre);
  map.rings = 0;
  for (int ring = 1; ring <= rings; ++ring) {
    const int first = first_of_ring(ring), end = first + 8 * ring;
    for (int k = first; k < end; ++k) {
      const Pixel& pixel = kRingOrder[k];
      const int from = z[pixel.inner];
      const int step = step_to_surface<kSign>(bits[kMiddle + pixel.column], from);
      const int height = from + kSign * step;  // beyond any trace where the step is kInvalid
      if (std::abs(height) > trace) return;
      z[k] = static_cast<signed char>(height);
    }
    for (int k = first; k < first + 4 * ring; ++k) {
      if (std::abs(z[k] + z[k + 4 * ring] - 2 * centre) > kMaxUneven) return;
    }
    for (int k = first; k < end; ++k) map.z[k] = static_cast<float>(z[k]);
    map.rings = ring;
  }
}

template <int kSign>
void make_map(const ColumnBits& columns, const Cell& c, int axis, int rings, int trace,
              HeightMap& map) noexcept {
  SurfaceBits bits;
  read_surface<kSign>(columns.around(axis, c[(axis + 1) % 3], c[(axis + 2) % 3], c[axis] - kLevel),
                      rings, bits);
  trace_map<kSign>(bits, rings, trace, map);
}

// --- The fit ------------------------------------------------------------------------------------

/// Filters of a square window that give the weighted least-squares quadric's value and slopes at
/// its centre as plain sums over the heights [eqs. 3 and 4, with a taper and the square lattice's
/// own moments]. In the order of kRingOrder, zero beyond the window.
struct WindowFilter {
  alignas(32) std::array<float, kPaddedPixels> value{};    // sum value z: height at the centre
  alignas(32) std::array<float, kPaddedPixels> slope_u{};  // dz/di
  alignas(32) std::array<float, kPaddedPixels> slope_v{};  // dz/dj
};

WindowFilter make_filter(int ns) {
  WindowFilter filter;
  const double reach = 1.25 * ns + 1.0;
  const auto weight = [&](int i, int j) {
    return std::max(0.02, 1.0 - (i * i + j * j) / (reach * reach));
  };
  // The odd part of the quadric decouples: slope = sum w i z / sum w i^2. The even part has the
  // unknowns 1, i^2, j^2 (i j decouples too).
  double w_ii = 0.0;
  Eigen::Matrix3d even = Eigen::Matrix3d::Zero();
  for (int j = -ns; j <= ns; ++j) {
    for (int i = -ns; i <= ns; ++i) {
      const double w = weight(i, j);
      w_ii += w * i * i;
      const Eigen::Vector3d basis(1.0, i * i, j * j);
      even += w * basis * basis.transpose();
    }
  }
  // With one ring the window sees no more than a plane's worth of curvature: the even part would
  // interpolate the centre's own quantisation.
  const bool curved = ns >= 2;
  const Eigen::Vector3d row = curved ? Eigen::Vector3d(even.inverse().row(0).transpose())
                                     : Eigen::Vector3d(1.0 / even(0, 0), 0, 0);
  for (int k = 0; k < pixel_count(ns); ++k) {
    const int i = kRingOrder[k].i, j = kRingOrder[k].j;
    const double w = weight(i, j);
    filter.value[k] = static_cast<float>(w * row.dot(Eigen::Vector3d(1.0, i * i, j * j)));
    filter.slope_u[k] = static_cast<float>(w * i / w_ii);
    filter.slope_v[k] = static_cast<float>(w * j / w_ii);
  }
  return filter;
}

const WindowFilter& filter_of(int ns) {
  static const std::array<WindowFilter, kMaxNeighbourhood + 1> filters = [] {
    std::array<WindowFilter, kMaxNeighbourhood + 1> all;
    for (int n = 1; n <= kMaxNeighbourhood; ++n) all[n] = make_filter(n);
    return all;
  }();
  return filters[ns];
}

/// Sum of products over the front of two padded arrays, in kLanes lanes added up in a fixed order.
float dot(const std::array<float, kPaddedPixels>& a, const std::array<float, kPaddedPixels>& b,
          std::size_t count) noexcept {
  float lanes[kLanes] = {};
  for (std::size_t k = 0; k < count; k += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) lanes[lane] += a[k + lane] * b[k + lane];
  }
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) +
         ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

}  // namespace

SurfaceEstimate estimate_ldm(const Workpiece& workpiece, const Cell& voxel, int neighbourhood,
                             int trace) noexcept {
  const Eigen::Vector3f coarse = coarse_normal(workpiece, voxel);
  const float length2 = coarse.squaredNorm();
  if (length2 == 0.0f) return {};
  int axis = 0;
  coarse.cwiseAbs().maxCoeff(&axis);
  const int sign = coarse[axis] > 0 ? 1 : -1;

  HeightMap map;
  (sign > 0 ? make_map<1> : make_map<-1>)(workpiece.columns(), voxel, axis, neighbourhood, trace,
                                          map);
  if (map.rings < 1) {
    // No map: an edge sharper than the steps allow. The face of the voxel is the best surface.
    return {coarse / std::sqrt(length2), 0.5f, true};
  }
  const auto pixels = static_cast<std::size_t>(pixel_count(map.rings));
  const std::size_t padded = (pixels + kLanes - 1) / kLanes * kLanes;
  std::fill(map.z.begin() + pixels, map.z.begin() + padded, 0.0f);
  const WindowFilter& filter = filter_of(map.rings);
  const float value = dot(filter.value, map.z, padded);
  const float slope_u = dot(filter.slope_u, map.z, padded);
  const float slope_v = dot(filter.slope_v, map.z, padded);
  const float inverse_length = 1.0f / std::sqrt(1.0f + slope_u * slope_u + slope_v * slope_v);
  SurfaceEstimate estimate;
  estimate.normal[(axis + 1) % 3] = -slope_u * inverse_length;
  estimate.normal[(axis + 2) % 3] = -slope_v * inverse_length;
  estimate.normal[axis] = static_cast<float>(sign) * inverse_length;
  // The map gives the outermost voxel's centre; the surface is half a voxel further out.
  estimate.offset = (value + 0.5f) * inverse_length;
  estimate.defined = true;
  return estimate;
}

}  // namespace sulcus
