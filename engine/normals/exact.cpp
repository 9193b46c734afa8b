#include "engine/normals/exact.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace sulcus {

namespace {

constexpr int kMaxCube = 12;
constexpr int kMaxCells = (2 * kMaxCube + 1) * (2 * kMaxCube + 1) * (2 * kMaxCube + 1);
constexpr std::int16_t kFar = 10000;  // squared; over 3 * 24^2, and far from overflow when added to
constexpr float kAgreement = 0.86602540f;  // cosine of 30 degrees
constexpr int kOffsetReach = 3;
// Of a sum of nine central differences, 18 on a plane: symmetric solids cancel but for rounding.
constexpr float kVanishing = 1e-3f;

/// Squared distances or distances of the cells of a cube, z fastest, then y, then x.
template <class T>
using Cube = std::array<T, kMaxCells>;

/// Occupancy of a cube: one word of `edge` bits per column along z, y fastest, then x.
struct Columns {
  std::array<std::uint64_t, (2 * kMaxCube + 1) * (2 * kMaxCube + 1)> bits;
  int edge;
};

Columns columns_around(const Workpiece& workpiece, const Cell& voxel, int ns) {
  Columns columns;
  columns.edge = 2 * ns + 1;
  const ColumnBits::Windows windows =
      workpiece.columns().around(2, voxel.x(), voxel.y(), voxel.z() - ns);
  const std::uint64_t in_cube = (std::uint64_t{1} << columns.edge) - 1;
  std::uint64_t* word = columns.bits.data();
  for (int i = -ns; i <= ns; ++i) {
    for (int j = -ns; j <= ns; ++j) *word++ = windows.window(i, j) & in_cube;
  }
  return columns;
}

/// Lowers each of `count` values at `to` to that at `from` plus `added` where it is smaller.
void lower(std::int16_t* to, const std::int16_t* from, int count, int added) {
  for (int n = 0; n < count; ++n) {
    to[n] = std::min(to[n], static_cast<std::int16_t>(from[n] + added));
  }
}

/// Squared distance of every cell to the nearest cell of the kind that `flip` names: 0 the solid
/// ones, all ones the empty ones. Exact and separable: along a column, then across columns, then
/// across planes, the least over all places of what is there plus the square of the step.
void squared_distances(const Columns& columns, std::uint64_t flip, Cube<std::int16_t>& squared) {
  const int edge = columns.edge, plane = edge * edge;
  const std::uint64_t in_cube = (std::uint64_t{1} << edge) - 1;
  Cube<std::int16_t> partial;
  for (int column = 0; column < plane; ++column) {
    const std::uint64_t targets = (columns.bits[column] ^ flip) & in_cube;
    for (int k = 0; k < edge; ++k) {
      int nearest = kFar;
      const std::uint64_t above = targets >> k;
      const std::uint64_t below = targets << (63 - k);
      if (above != 0) nearest = std::countr_zero(above) * std::countr_zero(above);
      if (below != 0)
        nearest = std::min(nearest, std::countl_zero(below) * std::countl_zero(below));
      squared[column * edge + k] = static_cast<std::int16_t>(nearest);
    }
  }
  std::fill_n(partial.begin(), edge * plane, kFar);
  for (int i = 0; i < edge; ++i) {
    for (int j = 0; j < edge; ++j) {
      for (int from = 0; from < edge; ++from) {
        lower(&partial[(i * edge + j) * edge], &squared[(i * edge + from) * edge], edge,
              (j - from) * (j - from));
      }
    }
  }
  std::fill_n(squared.begin(), edge * plane, kFar);
  for (int i = 0; i < edge; ++i) {
    for (int from = 0; from < edge; ++from) {
      lower(&squared[i * plane], &partial[from * plane], plane, (i - from) * (i - from));
    }
  }
}

/// Signed distances in a cube about a voxel, negative inside, in voxels.
class DistanceCube {
 public:
  DistanceCube(const Workpiece& workpiece, const Cell& voxel, int ns)
      : edge_(2 * ns + 1), centre_(ns * (edge_ * edge_ + edge_ + 1)) {
    const Columns columns = columns_around(workpiece, voxel, ns);
    Cube<std::int16_t> to_solid, to_void;
    squared_distances(columns, 0, to_solid);
    squared_distances(columns, ~std::uint64_t{0}, to_void);
    for (int n = 0; n < edge_ * edge_ * edge_; ++n) {
      // One of the two is zero.
      const float outside = std::sqrt(static_cast<float>(to_solid[n]));
      const float inside = std::sqrt(static_cast<float>(to_void[n]));
      distances_[n] = outside > 0.0f ? outside - 0.5f : 0.5f - inside;
    }
  }

  float at(int x, int y, int z) const { return distances_[place(x, y, z)]; }

  /// 3 x 3 x 3 Prewitt operator: per axis the sum of nine central differences. Not scaled to the
  /// step, of which only the direction is used.
  Eigen::Vector3f gradient(int x, int y, int z) const {
    const float* const d = &distances_[place(x, y, z)];
    const int plane = edge_ * edge_;
    Eigen::Vector3f gradient = Eigen::Vector3f::Zero();
    for (int a = -1; a <= 1; ++a) {
      for (int b = -1; b <= 1; ++b) {
        const int along_x = a * edge_ + b, along_y = a * plane + b, along_z = a * plane + b * edge_;
        gradient.x() += d[along_x + plane] - d[along_x - plane];
        gradient.y() += d[along_y + edge_] - d[along_y - edge_];
        gradient.z() += d[along_z + 1] - d[along_z - 1];
      }
    }
    return gradient;
  }

 private:
  int place(int x, int y, int z) const { return centre_ + (x * edge_ + y) * edge_ + z; }

  int edge_, centre_;
  Cube<float> distances_;
};

}  // namespace

SurfaceEstimate estimate_exact(const Workpiece& workpiece, const Cell& voxel,
                               int neighbourhood) noexcept {
  const DistanceCube cube(workpiece, voxel, neighbourhood);
  const Eigen::Vector3f central = cube.gradient(0, 0, 0);
  const float central_length = std::sqrt(central.squaredNorm());
  if (!(central_length > kVanishing)) return {};
  const auto agrees = [&](const Eigen::Vector3f& g) {
    return g.dot(central) > kAgreement * central_length * std::sqrt(g.squaredNorm());
  };

  Eigen::Vector3f sum = central;
  float distance = cube.at(0, 0, 0);
  int count = 1;
  const int reach = neighbourhood - 1, ball = neighbourhood * (neighbourhood - 1);
  // Half of the ball; the other half are its mirror images.
  for (int x = 0; x <= reach; ++x) {
    for (int y = x == 0 ? 0 : -reach; y <= reach; ++y) {
      for (int z = x == 0 && y == 0 ? 1 : -reach; z <= reach; ++z) {
        const int squared = x * x + y * y + z * z;
        if (squared > ball) continue;
        const Eigen::Vector3f here = cube.gradient(x, y, z), there = cube.gradient(-x, -y, -z);
        if (!agrees(here) || !agrees(there)) continue;
        sum += here + there;
        if (squared > kOffsetReach * kOffsetReach) continue;
        distance += cube.at(x, y, z) + cube.at(-x, -y, -z);
        count += 2;
      }
    }
  }
  return {sum / std::sqrt(sum.squaredNorm()), -distance / static_cast<float>(count), true};
}

}  // namespace sulcus
