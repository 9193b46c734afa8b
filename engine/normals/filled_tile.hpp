#pragma once

#include <array>
#include <cstdint>

#include "engine/normals/filled_columns.hpp"
#include "engine/normals/map_space.hpp"
#include "engine/normals/window_filter.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

/// The columns about the voxels of a leaf along one axis, one way, of a solid with fractions; and
/// quadrics fitted to square windows of them. What neighbouring voxels share is read and fitted
/// once, and only when it is asked for.
///
/// A column's height is the sum of its fills from the outermost solid voxel of its surface down to
/// the first full one [height functions: Cummins, Francois and Kothe 2005]. Of several surfaces a
/// voxel sees the nearest: where that is not the same for all layers, each needs a tile of its own.
///
/// Coordinates in the leaf: (u, v) across the axis in cyclic order; heights outward, in parts, from
/// the innermost layer.
class FilledTile {
 public:
  static constexpr int kMaxNs = kMostWindowRings;
  /// Windows about a column of the leaf lie no farther from it than this.
  static constexpr int kMostAside = 3;
  /// Rings of the windows that there are, with the largest: NS.
  static constexpr std::array<int, 3> kSmallRings{4, 3, 2};

  /// Of so many layers, all of a leaf's or one, from the voxel `origin` on, which is the leaf's
  /// first across the axis. `reach`: how far a column's height may be from a voxel, voxels, at most
  /// kMostReach.
  void begin(const Workpiece& workpiece, const Cell& origin, int layers, const MapAxes& axes,
             int ns, int reach) noexcept;

  /// Reads the columns of the maps in a row. Then of a map: whether no voxel there could see other
  /// surfaces than the tile has; whether any column has a voxel that is not full.
  void read_about(int v) noexcept;
  bool is_single(int u, int v) const noexcept { return (about(several_, v) & map_of(u)) == 0; }
  bool has_parts(int u, int v) const noexcept { return (about(parts_, v) & map_of(u)) != 0; }

  /// The fit of the window of so many rings, NS or of kSmallRings, about a column that lies no
  /// farther than kMostAside from the leaf (of NS and 4 rings: in it); `read_about` has read its
  /// columns.
  struct Fit {
    const WindowFits* of = nullptr;
    int lane = 0;
    float mean_square() const { return of->mean_square[lane]; }
  };
  Fit fit(int rings, int u, int v) noexcept;

  /// Whether the window of 3 or 2 rings about a column leaves so little that it may be a face
  /// (kNearlyExplained).
  bool is_nearly_explained(int rings, int u, int v) noexcept {
    const Small small(rings, u, v);
    if (!is_set(made_[1][small.which], small.place())) make(small);
    return is_set(nearly_[small.which][small.row], static_cast<std::size_t>(u + kLeafEdge));
  }

  int ns() const { return ns_; }
  static constexpr int kMostReach = 10;

 private:
  static constexpr int kMargin = 16, kLanes = kLeafEdge + 2 * kMargin;
  static constexpr int kRows = kLeafEdge + 2 * kMaxNs;
  static constexpr int kCentres = kLeafEdge + 2 * kMostAside;
  static constexpr int kGroups = 3, kOwnGroup = 1;  // of eight columns; the leaf's

  /// A group of small windows: those about eight columns side by side.
  struct Small {
    Small(int rings, int u, int v)
        : which(rings == 3 ? 0 : 1),
          row(static_cast<std::size_t>(v + kMostAside)),
          group(static_cast<std::size_t>(u + kLeafEdge) / kLeafEdge) {}
    std::size_t place() const { return row * kGroups + group; }
    int first_u() const { return (static_cast<int>(group) - 1) * kLeafEdge; }
    std::size_t which, row, group;
  };

  static bool is_set(std::uint64_t bits, std::size_t n) noexcept { return (bits >> n & 1) != 0; }

  void read_row(int row) noexcept;
  /// Sums of the rows of a window about row v that are not there yet.
  void sum_rows(std::size_t group, int rings, int v) noexcept;
  void make(const Small& small) noexcept;
  /// Bits by lane of the rows of the map about row v; the columns of the map about u.
  std::uint64_t about(const std::array<std::uint64_t, kRows>& rows, int v) const noexcept {
    std::uint64_t bits = 0;
    for (int row = v; row <= v + 2 * ns_; ++row) bits |= rows[static_cast<std::size_t>(row)];
    return bits;
  }
  std::uint64_t map_of(int u) const noexcept {
    return ((std::uint64_t{2} << 2 * ns_) - 1) << (kMargin + u - ns_);
  }

  const Workpiece* workpiece_ = nullptr;
  MapAxes axes_;
  Cell origin_ = Cell::Zero();  // (0, 0) of the first layer along the axis
  int layers_ = 0, ns_ = 0, reach_ = 0;
  std::uint32_t rows_read_ = 0;                       // a bit for each
  std::array<std::uint64_t, kRows> several_, parts_;  // of a row's lanes, as they were read
  alignas(64) std::int16_t height_[kRows][kLanes];
  // Sums by rings, of NS and 4, of 3 and 2, and of which rows of a group they are there.
  std::array<std::uint32_t, kGroups> summed_;
  RowSums large_rows_[2][kRows];
  RowSums small_rows_[2][kGroups][kRows];
  // Fits by rings, and which there are; the columns of a row, from the first group's first, about
  // which a small one is nearly explained.
  std::array<std::array<std::uint64_t, 2>, 2> made_;
  std::array<std::array<std::uint32_t, kCentres>, 2> nearly_;
  WindowFits large_[2][kLeafEdge];
  WindowFits small_[2][kCentres][kGroups];
};

}  // namespace sulcus
