#include "engine/import/meshes/mesh_coverage.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "engine/volume/workpiece.hpp"

namespace sulcus {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

/// Convex, of a triangle that planes have clipped: six about a voxel make 9 corners at most. Where
/// rounding makes more of a sliver's, those are left out.
struct ClippedTriangle {
  std::array<Eigen::Vector3d, 16> corners;
  std::size_t count = 0;

  void add(const Eigen::Vector3d& p) {
    if (count < corners.size()) corners[count++] = p;
  }
};

/// Parts a polygon at a plane across an axis: what lies on it, wholly, is above.
void split(const ClippedTriangle& whole, int axis, double at, ClippedTriangle& below,
           ClippedTriangle& above) {
  below.count = above.count = 0;
  for (std::size_t i = 0; i < whole.count; ++i) {
    const Eigen::Vector3d& p = whole.corners[i];
    const Eigen::Vector3d& q = whole.corners[(i + 1) % whole.count];
    const bool p_below = p[axis] < at, q_below = q[axis] < at;
    (p_below ? below : above).add(p);
    if (p_below == q_below) continue;
    Eigen::Vector3d crossing = p + (q - p) * ((at - p[axis]) / (q[axis] - p[axis]));
    crossing[axis] = at;
    below.add(crossing);
    above.add(crossing);
  }
}

/// What is known of the voxels of a leaf that a triangle passes through.
struct LeafShares {
  LevelBlock levels{};
  LeafBits touched, settled;
};

/// Eight by eight lines of voxels along an axis, and the triangles over them.
class AreaSums {
 public:
  /// b and c are across the axis, in cyclic order.
  void reset(int b0, int c0, int voxels) {
    first_ = {b0, c0};
    voxels_ = voxels;
    const auto size = static_cast<std::size_t>(kLeafEdge * kLeafEdge * voxels);
    steps_.assign(size, 0.0);
    parts_.assign(size, 0.0);
    touched_.assign(size, 0);
    below_.fill(0.0);
  }

  /// Corners as (b, c, along the axis).
  void add(const ClippedTriangle& triangle) {
    ClippedTriangle row, rest, after;
    split(triangle, 1, first_[1] - 0.5, row, rest);
    for (int c = 0; c < kLeafEdge && rest.count > 0; ++c) {
      split(rest, 1, first_[1] + c + 0.5, row, after);
      std::swap(rest, after);
      if (row.count > 0) add_row(c, row);
    }
  }

  // Of the line b + 8 c, below the voxel k and in it.
  double below(int line) const { return below_[static_cast<std::size_t>(line)]; }
  bool touched(int line, int k) const { return touched_[at(line, k)] != 0; }
  double step(int line, int k) const { return steps_[at(line, k)]; }
  double part(int line, int k) const { return parts_[at(line, k)]; }

 private:
  std::size_t at(int line, int k) const { return static_cast<std::size_t>(line * voxels_ + k); }

  void add_row(int c, const ClippedTriangle& row) {
    ClippedTriangle column, rest, after;
    split(row, 0, first_[0] - 0.5, column, rest);
    for (int b = 0; b < kLeafEdge && rest.count > 0; ++b) {
      split(rest, 0, first_[0] + b + 0.5, column, after);
      std::swap(rest, after);
      if (column.count > 0) add_column(b + kLeafEdge * c, column);
    }
  }

  void add_column(int line, const ClippedTriangle& column) {
    ClippedTriangle part, rest, after;
    split(column, 2, -0.5, part, rest);
    if (part.count > 0) below_[static_cast<std::size_t>(line)] -= moments(part)[0];
    double least = voxels_;
    for (std::size_t i = 0; i < rest.count; ++i) least = std::min(least, rest.corners[i][2]);
    for (int k = static_cast<int>(std::floor(least + 0.5)); k < voxels_ && rest.count > 0; ++k) {
      split(rest, 2, k + 0.5, part, after);
      std::swap(rest, after);
      if (part.count == 0) continue;
      const auto [area, height] = moments(part);
      // Counter-clockwise seen against the axis is a normal along it: what is above is outside.
      steps_[at(line, k)] -= area;
      parts_[at(line, k)] -= area * (k + 0.5) - height;
      touched_[at(line, k)] = 1;
    }
  }

  /// Signed area across the axis, and its integral of the place along it.
  static std::array<double, 2> moments(const ClippedTriangle& p) {
    double area = 0.0, height = 0.0;
    const Eigen::Vector3d& o = p.corners[0];
    for (std::size_t i = 1; i + 1 < p.count; ++i) {
      const Eigen::Vector3d u = p.corners[i] - o, v = p.corners[i + 1] - o;
      const double part = 0.5 * (u[0] * v[1] - u[1] * v[0]);
      area += part;
      height += part * (o[2] + (u[2] + v[2]) / 3.0);
    }
    return {area, height};
  }

  std::array<int, 2> first_{};
  int voxels_ = 0;
  std::vector<double> steps_, parts_;
  std::vector<std::uint8_t> touched_;
  std::array<double, kLeafEdge * kLeafEdge> below_{};
};

class Coverage {
 public:
  Coverage(const VoxelModel& inside, const std::vector<Eigen::Vector3d>& positions,
           const Triangles& triangles, const WindingNumber& winding)
      : inside_(inside),
        grid_(inside.grid),
        positions_(positions),
        triangles_(triangles),
        winding_(winding),
        leaves_(grid_.leaf_count()) {
    double volume = 0.0;
    for (const auto& t : triangles) {
      volume += positions[t[0]].dot(positions[t[1]].cross(positions[t[2]]));
    }
    inner_ = volume < 0.0 ? -1.0 : 1.0;
  }

  std::vector<LeafLevels> pages() {
    for (const int axis : {2, 0, 1}) {
      sum_along(axis);
      if (all_settled()) return kept();
    }
    open_holes();
    sample_open();
    return kept();
  }

 private:
  /// Triangles over each column of leaves, by number: `lists[begins[n]]` on.
  struct Bins {
    std::vector<std::size_t> begins;
    std::vector<std::uint32_t> lists;
  };

  Bins triangles_by_column(int b, int c) const {
    const Eigen::Vector3i leaves = grid_.leaf_dims();
    Bins bins;
    bins.begins.assign(static_cast<std::size_t>(leaves[b] * leaves[c]) + 1, 0);
    const auto visit_each = [&](const auto& visit) {
      for (std::uint32_t n = 0; n < triangles_.size(); ++n) {
        const auto range = [&](int axis) {
          double least = grid_.cells[axis], most = -1.0;
          for (const std::uint32_t v : triangles_[n]) {
            least = std::min(least, positions_[v][axis]);
            most = std::max(most, positions_[v][axis]);
          }
          // Clamped as numbers: a mesh far away would not fit an int.
          const double last = leaves[axis];
          return std::array<int, 2>{
              static_cast<int>(std::clamp(std::floor((least + 0.5) / kLeafEdge), 0.0, last)),
              static_cast<int>(std::clamp(std::floor((most + 0.5) / kLeafEdge), -1.0, last - 1))};
        };
        const auto [b_from, b_to] = range(b);
        const auto [c_from, c_to] = range(c);
        for (int y = c_from; y <= c_to; ++y) {
          for (int x = b_from; x <= b_to; ++x) {
            visit(static_cast<std::size_t>(x + leaves[b] * y), n);
          }
        }
      }
    };
    visit_each([&](std::size_t column, std::uint32_t) { ++bins.begins[column + 1]; });
    for (std::size_t n = 1; n < bins.begins.size(); ++n) bins.begins[n] += bins.begins[n - 1];
    bins.lists.resize(bins.begins.back());
    std::vector<std::size_t> next(bins.begins.begin(), bins.begins.end() - 1);
    visit_each([&](std::size_t column, std::uint32_t n) { bins.lists[next[column]++] = n; });
    return bins;
  }

  void sum_along(int axis) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    const Bins bins = triangles_by_column(b, c);
    tbb::enumerable_thread_specific<AreaSums> sums;
    // A column of leaves for each thread: nothing is written twice.
    tbb::parallel_for(std::size_t{0}, bins.begins.size() - 1, [&](std::size_t column) {
      const std::span over =
          std::span(bins.lists)
              .subspan(bins.begins[column], bins.begins[column + 1] - bins.begins[column]);
      if (over.empty()) return;
      const int row = grid_.leaf_dims()[b], n = static_cast<int>(column);
      Cell first = Cell::Zero();
      first[b] = n % row * kLeafEdge;
      first[c] = n / row * kLeafEdge;
      AreaSums& sum = sums.local();
      sum.reset(first[b], first[c], grid_.cells[axis]);
      for (const std::uint32_t t : over) {
        ClippedTriangle triangle;
        for (const std::uint32_t v : triangles_[t]) {
          triangle.add({positions_[v][b], positions_[v][c], positions_[v][axis]});
        }
        sum.add(triangle);
      }
      for (int line = 0; line < kLeafEdge * kLeafEdge; ++line) {
        Cell start = first;
        start[b] += line % kLeafEdge;
        start[c] += line / kLeafEdge;
        settle_line(sum, line, start, axis);
      }
    });
  }

  /// Sums up along a line of voxels. Runs of voxels that triangles pass through are sound where
  /// the voxels at either end are as `inside` says; from each of those the sum goes on afresh.
  void settle_line(const AreaSums& sum, int line, Cell c, int axis) {
    constexpr double kWhole = 1e-3;  // what does not cancel in a quarter of a level
    const int end = grid_.cells[axis];
    double winding = sum.below(line);
    std::vector<double>& means = means_.local();
    means.clear();
    for (int k = 0; k <= end; ++k) {
      if (k < end && sum.touched(line, k)) {
        means.push_back(winding + sum.part(line, k));
        winding += sum.step(line, k);
        continue;
      }
      c[axis] = k;
      const bool in = k < end && inside_.solid(c);
      const double whole = std::round(winding);
      const bool fits =
          k == end || (std::abs(winding - whole) < kWhole && (std::abs(whole) > 0.5) == in);
      if (!means.empty()) settle_run(means, c, axis, fits);
      means.clear();
      winding = fits ? whole : in ? inner_ : 0.0;
    }
  }

  /// `end`: the voxel after those of `means`.
  void settle_run(const std::vector<double>& means, const Cell& end, int axis, bool sound) {
    Cell c = end;
    c[axis] -= static_cast<int>(means.size());
    for (const double mean : means) {
      LeafShares& leaf = shares(grid_.leaf_of(c));
      const int place = leaf_place(c);
      leaf.touched.set(place);
      if (sound && !leaf.settled.has(place)) {
        leaf.settled.set(place);
        const double share = std::min(1.0, std::abs(mean));
        leaf.levels[static_cast<std::size_t>(place)] =
            static_cast<FillLevel>(std::lround(kFullLevel * share));
      }
      ++c[axis];
    }
  }

  /// Of one thread at a time.
  LeafShares& shares(std::uint32_t leaf) {
    std::unique_ptr<LeafShares>& found = leaves_[leaf];
    if (!found) {
      found = std::make_unique<LeafShares>();
      for_each_voxel(inside_.leaves[leaf], [&](int place) {
        found->levels[static_cast<std::size_t>(place)] = kFullLevel;
      });
    }
    return *found;
  }

  bool all_settled() const {
    return std::ranges::all_of(
        leaves_, [](const auto& leaf) { return !leaf || leaf->touched == leaf->settled; });
  }

  /// Counts neighbours of which one is inside and that no triangle parts as touched, not settled.
  void open_holes() {
    const auto touched = [&](const Cell& c) {
      const auto& leaf = leaves_[grid_.leaf_of(c)];
      return leaf && leaf->touched.has(leaf_place(c));
    };
    std::vector<std::vector<Cell>> found(leaves_.size());
    tbb::parallel_for(std::uint32_t{0}, grid_.leaf_count(), [&](std::uint32_t leaf) {
      if (!any(inside_.leaves[leaf])) return;
      for_each_voxel(surface_of_leaf(inside_, leaf), [&](int place) {
        const Cell c = grid_.leaf_origin(leaf) + cell_in_leaf(place);
        for (int side = 0; side < 6; ++side) {
          Cell beside = c;
          beside[side / 2] += side % 2 != 0 ? 1 : -1;
          if (!grid_.contains(beside) || inside_.solid(beside)) continue;
          if (!touched(c) && !touched(beside)) found[leaf].insert(found[leaf].end(), {c, beside});
        }
      });
    });
    for (const std::vector<Cell>& cells : found) {
      for (const Cell& c : cells) shares(grid_.leaf_of(c)).touched.set(leaf_place(c));
    }
  }

  void sample_open() {
    constexpr int kParts = 4;
    tbb::parallel_for(std::uint32_t{0}, grid_.leaf_count(), [&](std::uint32_t n) {
      if (!leaves_[n]) return;
      LeafShares& leaf = *leaves_[n];
      for_each_voxel(without(leaf.touched, leaf.settled), [&](int place) {
        const Cell c = grid_.leaf_origin(n) + cell_in_leaf(place);
        int in = 0;
        for_each_cell(Cell::Zero(), Cell::Constant(kParts), [&](const Cell& part) {
          const Eigen::Vector3d to =
              (part.cast<double>().array() + 0.5 - 0.5 * kParts) / double{kParts};
          in += std::abs(winding_.at(c.cast<double>() + to)) > 0.5 ? 1 : 0;
        });
        leaf.levels[static_cast<std::size_t>(place)] =
            static_cast<FillLevel>(kFullLevel * in / (kParts * kParts * kParts));
      });
    });
  }

  std::vector<LeafLevels> kept() const {
    std::vector<LeafLevels> pages;
    for (std::uint32_t n = 0; n < leaves_.size(); ++n) {
      if (!leaves_[n]) continue;
      const LevelBlock& levels = leaves_[n]->levels;
      for (int place = 0; place < 512; ++place) {
        const FillLevel full = inside_.leaves[n].has(place) ? kFullLevel : FillLevel{0};
        if (levels[static_cast<std::size_t>(place)] == full) continue;
        pages.push_back({n, levels});
        break;
      }
    }
    return pages;
  }

  const VoxelModel& inside_;
  const VoxelGrid& grid_;
  const std::vector<Eigen::Vector3d>& positions_;
  const Triangles& triangles_;
  const WindingNumber& winding_;
  double inner_ = 1.0;  // the winding number inside
  std::vector<std::unique_ptr<LeafShares>> leaves_;
  tbb::enumerable_thread_specific<std::vector<double>> means_;
};

}  // namespace

std::vector<LeafLevels> mesh_coverage(const VoxelModel& inside,
                                      const std::vector<Eigen::Vector3d>& positions_index,
                                      const std::vector<std::array<std::uint32_t, 3>>& triangles,
                                      const WindingNumber& winding) {
  return Coverage(inside, positions_index, triangles, winding).pages();
}

}  // namespace sulcus
