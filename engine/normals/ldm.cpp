#include "engine/normals/ldm.hpp"

#include <Eigen/Dense>

#include <array>
#include <cmath>
#include <cstdlib>

namespace sulcus {

namespace {

constexpr int kSide = 2 * kMaxNeighbourhood + 1;
constexpr int kCentre = kMaxNeighbourhood;
constexpr int kMaxStep = 2;       // of the surface from one column to the next, voxels
constexpr int kMaxUneven = 3;     // |z(p) + z(-p) - 2 z(0)|, voxels
constexpr int kInvalid = 127;

// --- Coarse normal ------------------------------------------------------------------------------

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
          const float inverse = 1.0f / std::sqrt(static_cast<float>(d2));
          t[jk][pattern].x += static_cast<float>(i) * inverse;
          t[jk][pattern].inverse += inverse;
        }
      }
    }
    return t;
  }();
  return table;
}

/// Minus the sum of unit vectors to the solid voxels within 2.5: out of the solid, not unit.
Eigen::Vector3f coarse_normal(const Workpiece& workpiece, const Cell& c) noexcept {
  const RowTable& table = row_table();
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (int k = -2; k <= 2; ++k) {
    for (int j = -2; j <= 2; ++j) {
      const auto pattern =
          static_cast<unsigned>(workpiece.columns().window(0, c.y() + j, c.z() + k, c.x() - 2)) &
          31u;
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

/// Heights of the surface over the plane through the voxel, along one axis outward.
struct HeightMap {
  std::array<std::array<signed char, kSide>, kSide> z;  // [kCentre + j][kCentre + i]
  int rings = 0;                                        // accepted; 0: the centre only
  bool has_centre = false;
};

/// Height in the column (u, v) next to `from`, or kInvalid.
int follow(const ColumnBits& columns, int axis, int sign, int u, int v, int level,
           int from) noexcept {
  // Bit 32 is the voxel's own level. A bit of `tops` is a solid voxel whose outer neighbour is
  // empty; the surface continues at the one nearest to the level it had.
  const std::uint64_t w = columns.window(axis, u, v, level - 32);
  const std::uint64_t tops = sign > 0 ? w & ~(w >> 1) : w & ~(w << 1);
  const int middle = 32 + sign * from;
  const auto five = static_cast<unsigned>(tops >> (middle - kMaxStep)) & 31u;
  const int step = sign > 0 ? kNearestUp[five] : kNearestDown[five];
  return step == kInvalid ? kInvalid : from + sign * step;
}

HeightMap trace_map(const ColumnBits& columns, const Cell& c, int axis, int sign, int rings,
                    int trace) noexcept {
  HeightMap map;
  const int u0 = c[(axis + 1) % 3], v0 = c[(axis + 2) % 3], level = c[axis];
  const int centre = follow(columns, axis, sign, u0, v0, level, 0);
  if (centre == kInvalid) return map;
  map.has_centre = true;
  map.z[kCentre][kCentre] = static_cast<signed char>(centre);

  for (int ring = 1; ring <= rings; ++ring) {
    for (int j = -ring; j <= ring; ++j) {
      const int stride = std::abs(j) == ring ? 1 : 2 * ring;
      for (int i = -ring; i <= ring; i += stride) {
        // The inner neighbour: one step towards the centre on the side(s) the pixel lies out.
        const int inner_i = i == ring ? i - 1 : i == -ring ? i + 1 : i;
        const int inner_j = j == ring ? j - 1 : j == -ring ? j + 1 : j;
        const int from = map.z[kCentre + inner_j][kCentre + inner_i];
        const int z = follow(columns, axis, sign, u0 + i, v0 + j, level, from);
        if (z == kInvalid || std::abs(z) > trace) return map;
        map.z[kCentre + j][kCentre + i] = static_cast<signed char>(z);
      }
    }
    // Opposite pixels of the ring: the upper half and half the middle row cover each pair once.
    for (int j = 0; j <= ring; ++j) {
      const int stride = j == ring ? 1 : 2 * ring;
      for (int i = -ring; i <= ring; i += stride) {
        const int even = map.z[kCentre + j][kCentre + i] + map.z[kCentre - j][kCentre - i];
        if (std::abs(even - 2 * centre) > kMaxUneven) return map;
      }
    }
    map.rings = ring;
  }
  return map;
}

// --- The fit ------------------------------------------------------------------------------------

/// Filters of a square window that give the weighted least-squares quadric's value and slope at its
/// centre as plain sums over the heights [eqs. 3 and 4, with a taper and the square lattice's own
/// moments].
struct WindowFilter {
  std::array<std::array<float, kSide>, kSide> value{};  // sum value z = height at the centre
  std::array<std::array<float, kSide>, kSide> slope{};  // sum slope z = dz/di; transposed: dz/dj
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
  const Eigen::Vector3d row =
      curved ? Eigen::Vector3d(even.inverse().row(0).transpose()) : Eigen::Vector3d(1.0 / even(0, 0), 0, 0);
  for (int j = -ns; j <= ns; ++j) {
    for (int i = -ns; i <= ns; ++i) {
      const double w = weight(i, j);
      filter.value[kCentre + j][kCentre + i] =
          static_cast<float>(w * row.dot(Eigen::Vector3d(1.0, i * i, j * j)));
      filter.slope[kCentre + j][kCentre + i] = static_cast<float>(w * i / w_ii);
    }
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

}  // namespace

SurfaceEstimate estimate_ldm(const Workpiece& workpiece, const Cell& voxel, int neighbourhood,
                             int trace) noexcept {
  const Eigen::Vector3f coarse = coarse_normal(workpiece, voxel);
  const float length2 = coarse.squaredNorm();
  // Sums of the same terms in another order differ in their last bits: below this it is symmetric.
  if (length2 < 1e-6f) return {};
  int axis = 0;
  coarse.cwiseAbs().maxCoeff(&axis);
  const int sign = coarse[axis] > 0 ? 1 : -1;

  const HeightMap map =
      trace_map(workpiece.columns(), voxel, axis, sign, neighbourhood, trace);
  if (!map.has_centre || map.rings == 0) {
    // No map: an edge sharper than the steps allow. The face of the voxel is the best surface.
    return {coarse / std::sqrt(length2), 0.5f, true};
  }
  const WindowFilter& filter = filter_of(map.rings);
  float value = 0, slope_u = 0, slope_v = 0;
  for (int j = -map.rings; j <= map.rings; ++j) {
    for (int i = -map.rings; i <= map.rings; ++i) {
      const auto z = static_cast<float>(map.z[kCentre + j][kCentre + i]);
      value += filter.value[kCentre + j][kCentre + i] * z;
      slope_u += filter.slope[kCentre + j][kCentre + i] * z;
      slope_v += filter.slope[kCentre + i][kCentre + j] * z;
    }
  }
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
