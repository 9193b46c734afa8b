#include "engine/tool/mesh_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/core/error.hpp"
#include "engine/core/nearest_on_triangle.hpp"
#include "engine/core/parallel.hpp"

namespace sulcus {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr double kBand = 3.0;          // samples around a triangle that are tested against it
constexpr double kMaxOpenRays = 0.05;  // of those along one axis
constexpr int kSweeps = 4;             // along x, y and z, both ways; 2 leave 1.8 samples

/// A triangle in field space.
struct Triangle {
  Vector3d a, b, c;
  Vector3d normal;  // unit, outward
};

/// What a sample knows of the surface so far.
struct NearestPoint {
  Vector3f point{0.0f, 0.0f, 0.0f};  // field space
  std::int32_t triangle = -1;
};

std::vector<Triangle> triangles_in_field(const TriangleMesh& mesh, const FieldGrid& grid) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& [i, j, k] : mesh.triangles) {
    Triangle t{grid.field_from_tool(mesh.positions[i].cast<double>()),
               grid.field_from_tool(mesh.positions[j].cast<double>()),
               grid.field_from_tool(mesh.positions[k].cast<double>()), Vector3d::Zero()};
    const Vector3d area = (t.b - t.a).cross(t.c - t.a);
    // One without area adds no surface; its edges belong to its neighbours too.
    if (!(area.norm() > 1e-12)) continue;
    t.normal = area.normalized();
    triangles.push_back(t);
  }
  return triangles;
}

/// Nearest triangles and unsigned distances, samples, on the way to a field.
class NearestGrid {
 public:
  NearestGrid(const std::vector<Triangle>& triangles, const Vector3i& samples)
      : triangles_(triangles),
        samples_(samples),
        nearest_(static_cast<std::size_t>(samples.x()) * samples.y() * samples.z()),
        squared_(nearest_.size(), std::numeric_limits<float>::infinity()) {}

  std::size_t index(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(samples_.x()) *
               (static_cast<std::size_t>(j) + static_cast<std::size_t>(samples_.y()) * k);
  }
  double distance(std::size_t s) const { return std::sqrt(static_cast<double>(squared_[s])); }
  const NearestPoint& nearest(std::size_t s) const { return nearest_[s]; }

  /// Exact distances around every triangle. Slices are independent, so threads change nothing.
  void fill_band() {
    constexpr int kSlab = 4;
    parallel_ranges(0, samples_.z(), kSlab, [this](int low, int high) {
      for (std::size_t t = 0; t < triangles_.size(); ++t) {
        fill_around(static_cast<std::int32_t>(t), low, high - 1);
      }
    });
  }

  /// Hands nearest triangles on, along x, y and z, forwards and backwards. What has not changed
  /// since it was handed on last is left out: it would change nothing.
  void sweep() {
    const int ny = samples_.y(), nz = samples_.z();
    changed_.assign(static_cast<std::size_t>(ny) * nz, 0);
    for (int pass = 0; pass < kSweeps; ++pass) {
      const int along_x = 1 + pass * kPhases;
      parallel_for(0, nz, [=, this](int k) {
        for (int j = 0; j < ny; ++j) sweep_row(j, k, along_x);
        for (int j = 1; j < ny; ++j) relax_row(j, k, j - 1, k, along_x + 1);
        for (int j = ny - 2; j >= 0; --j) relax_row(j, k, j + 1, k, along_x + 2);
      });
      parallel_for(0, ny, [=, this](int j) {
        for (int k = 1; k < nz; ++k) relax_row(j, k, j, k - 1, along_x + 3);
        for (int k = nz - 2; k >= 0; --k) relax_row(j, k, j, k + 1, along_x + 4);
      });
    }
  }

 private:
  void fill_around(std::int32_t number, int first_slice, int last_slice) {
    const Triangle& t = triangles_[static_cast<std::size_t>(number)];
    const Vector3d low = t.a.cwiseMin(t.b).cwiseMin(t.c);
    const Vector3d high = t.a.cwiseMax(t.b).cwiseMax(t.c);
    const auto from = [&](int axis, int least) {
      return std::max(least, static_cast<int>(std::ceil(low[axis] - kBand)));
    };
    const auto to = [&](int axis, int most) {
      return std::min(most, static_cast<int>(std::floor(high[axis] + kBand)));
    };
    for (int k = from(2, first_slice); k <= to(2, last_slice); ++k) {
      for (int j = from(1, 0); j <= to(1, samples_.y() - 1); ++j) {
        for (int i = from(0, 0); i <= to(0, samples_.x() - 1); ++i) {
          const Vector3d p(i, j, k);
          const std::size_t s = index(i, j, k);
          // Two cheap lower bounds first: the triangle's plane and its box.
          if (std::abs(t.normal.dot(p - t.a)) > kBand) continue;
          const Vector3d gap = (low - p).cwiseMax(p - high).cwiseMax(0.0);
          if (gap.squaredNorm() < squared_[s]) offer(s, p, number);
        }
      }
    }
  }

  /// Takes the triangle where it is nearer; of equals the first stays.
  void offer(std::size_t s, const Vector3d& p, std::int32_t number) {
    const Triangle& t = triangles_[static_cast<std::size_t>(number)];
    const Vector3d q = nearest_on_triangle(p, t.a, t.b, t.c);
    const auto squared = static_cast<float>((p - q).squaredNorm());
    if (squared < squared_[s]) {
      squared_[s] = squared;
      nearest_[s] = {q.cast<float>(), number};
    }
  }

  /// Whether the sample `to` = (i, j, k) takes the triangle of its neighbour `from`.
  bool relax(std::size_t to, std::size_t from, int i, int j, int k) {
    const NearestPoint& source = nearest_[from];
    if (source.triangle < 0 || source.triangle == nearest_[to].triangle) return false;
    const Vector3i at(i, j, k);
    // The neighbour's nearest point bounds the distance to its triangle: cheap, and tight enough.
    if (!((at.cast<float>() - source.point).squaredNorm() < squared_[to])) return false;
    offer(to, at.cast<double>(), source.triangle);
    return true;
  }

  // A phase is one direction of one pass. Rows know the last one that changed them. In all but the
  // first, rows are handed on before they change again.
  static constexpr int kPhases = 5;  // x both ways, y, y back, z, z back

  void sweep_row(int j, int k, int phase) {
    int& changed = changed_of(j, k);
    if (phase > kPhases && changed < phase - kPhases) return;
    const std::size_t row = index(0, j, k);
    bool any = false;
    for (int i = 1; i < samples_.x(); ++i) any |= relax(row + i, row + i - 1, i, j, k);
    for (int i = samples_.x() - 2; i >= 0; --i) any |= relax(row + i, row + i + 1, i, j, k);
    if (any) changed = phase;
  }

  void relax_row(int j, int k, int from_j, int from_k, int phase) {
    int& changed = changed_of(j, k);
    const int last = phase - kPhases;
    if (last > 0 && changed <= last && changed_of(from_j, from_k) <= last) return;
    const std::size_t row = index(0, j, k), from = index(0, from_j, from_k);
    bool any = false;
    for (int i = 0; i < samples_.x(); ++i) any |= relax(row + i, from + i, i, j, k);
    if (any) changed = phase;
  }

  int& changed_of(int j, int k) { return changed_[static_cast<std::size_t>(j + samples_.y() * k)]; }

  const std::vector<Triangle>& triangles_;
  Vector3i samples_;
  std::vector<NearestPoint> nearest_;
  std::vector<float> squared_;
  std::vector<int> changed_;  // phase, of the row (j, k)
};

/// A ray's passage through a triangle.
struct Crossing {
  std::int32_t column;   // u + v samples[u]
  std::int32_t winding;  // +1 into the solid, -1 out of it
  double at;             // along the ray, samples
};

std::vector<Crossing> crossings_along(int axis, const std::vector<Triangle>& triangles,
                                      const Vector3i& samples) {
  // Rays pass a ten-thousandth of a sample beside the samples, by different amounts in u and v, so
  // that they do not meet the edges and vertices of meshes made on some lattice.
  constexpr double kAsideU = 1.37e-4, kAsideV = 0.83e-4;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  std::vector<Crossing> crossings;
  for (const Triangle& t : triangles) {
    const double au = t.a[u] - kAsideU, av = t.a[v] - kAsideV;
    const double bu = t.b[u] - kAsideU, bv = t.b[v] - kAsideV;
    const double cu = t.c[u] - kAsideU, cv = t.c[v] - kAsideV;
    const double area = (bu - au) * (cv - av) - (bv - av) * (cu - au);
    if (area == 0.0) continue;
    const int u0 = std::max(0, static_cast<int>(std::ceil(std::min({au, bu, cu}))));
    const int v0 = std::max(0, static_cast<int>(std::ceil(std::min({av, bv, cv}))));
    const int u1 = std::min(samples[u] - 1, static_cast<int>(std::floor(std::max({au, bu, cu}))));
    const int v1 = std::min(samples[v] - 1, static_cast<int>(std::floor(std::max({av, bv, cv}))));
    for (int y = v0; y <= v1; ++y) {
      for (int x = u0; x <= u1; ++x) {
        const double wa = ((bu - x) * (cv - y) - (bv - y) * (cu - x)) / area;
        const double wb = ((cu - x) * (av - y) - (cv - y) * (au - x)) / area;
        const double wc = ((au - x) * (bv - y) - (av - y) * (bu - x)) / area;
        if (wa < 0.0 || wb < 0.0 || wc < 0.0) continue;
        // (u, v, axis) is right-handed: a positive area faces along the ray, which then leaves.
        crossings.push_back({x + y * samples[u], area > 0.0 ? -1 : 1,
                             wa * t.a[axis] + wb * t.b[axis] + wc * t.c[axis]});
      }
    }
  }
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& l, const Crossing& r) {
    if (l.column != r.column) return l.column < r.column;
    if (l.at != r.at) return l.at < r.at;
    return l.winding > r.winding;
  });
  return crossings;
}

/// Votes on every sample: above zero inside, below zero outside. Each axis has one vote; all begin
/// outside.
class Votes {
 public:
  explicit Votes(const Vector3i& samples)
      : samples_(samples),
        votes_(static_cast<std::size_t>(samples.x()) * samples.y() * samples.z(), -3) {}

  std::int8_t operator[](std::size_t s) const { return votes_[s]; }

  /// Casts the votes of the rays along an axis. Returns the part of those that meet the mesh that
  /// find a hole; 1 if none meets it.
  double cast(int axis, const std::vector<Triangle>& triangles) {
    const std::vector<Crossing> crossings = crossings_along(axis, triangles, samples_);
    std::size_t rays = 0, open = 0;
    for (auto first = crossings.begin(); first != crossings.end(); ++rays) {
      const auto last = std::find_if(first, crossings.end(),
                                     [&](const Crossing& c) { return c.column != first->column; });
      const std::span<const Crossing> ray(first, last);
      if (ray.size() % 2 == 0) {
        cast_ray(axis, ray);
      } else {
        ++open;
        // Takes back the vote for outside: abstains.
        change(axis, ray.front().column, 0, samples_[axis] - 1, 1);
      }
      first = last;
    }
    return rays == 0 ? 1.0 : static_cast<double>(open) / static_cast<double>(rays);
  }

 private:
  void cast_ray(int axis, std::span<const Crossing> ray) {
    int total = 0;
    for (const Crossing& c : ray) total += c.winding;
    int winding = 0;
    const Crossing* entry = nullptr;
    for (const Crossing& c : ray) {
      if (winding != 0) {
        // Half-open, so that a sample on a crossing counts once.
        change(axis, c.column, static_cast<int>(std::ceil(entry->at)),
               static_cast<int>(std::ceil(c.at)) - 1, 2);
      }
      winding = total == 0 ? winding + c.winding : 1 - winding;
      entry = &c;
    }
  }

  void change(int axis, std::int32_t column, int from, int to, int by) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    Vector3i at;
    at[u] = column % samples_[u];
    at[v] = column / samples_[u];
    at[axis] = std::max(from, 0);
    const std::size_t step[3] = {1, static_cast<std::size_t>(samples_.x()),
                                 static_cast<std::size_t>(samples_.x()) * samples_.y()};
    std::size_t s = at.x() * step[0] + at.y() * step[1] + at.z() * step[2];
    for (; at[axis] <= std::min(to, samples_[axis] - 1); ++at[axis], s += step[axis]) {
      votes_[s] = static_cast<std::int8_t>(votes_[s] + by);
    }
  }

  Vector3i samples_;
  std::vector<std::int8_t> votes_;
};

}  // namespace

void check_burr_mesh(const TriangleMesh& mesh_tool, std::string_view file) {
  if (mesh_tool.triangles.empty()) {
    throw InputError(file, "mesh", "no triangles", "a closed mesh of a burr");
  }
  for (std::size_t v = 0; v < mesh_tool.positions.size(); ++v) {
    if (!mesh_tool.positions[v].allFinite()) {
      throw InputError(file, "vertex " + std::to_string(v), "a position that is not finite",
                       "finite positions");
    }
  }
  for (std::size_t t = 0; t < mesh_tool.triangles.size(); ++t) {
    for (const std::uint32_t v : mesh_tool.triangles[t]) {
      if (v >= mesh_tool.positions.size()) {
        throw InputError(file, "triangle " + std::to_string(t), "vertex " + std::to_string(v),
                         "less than " + std::to_string(mesh_tool.positions.size()));
      }
    }
  }
}

DistanceField field_from_mesh(const TriangleMesh& mesh_tool, const FieldGrid& grid,
                              std::string_view file) {
  check_burr_mesh(mesh_tool, file);
  const std::vector<Triangle> triangles = triangles_in_field(mesh_tool, grid);
  const Vector3i n = grid.samples;
  Votes votes(n);
  for (int axis = 0; axis < 3; ++axis) {
    const double open = votes.cast(axis, triangles);
    if (open > kMaxOpenRays) {
      char found[96];
      std::snprintf(found, sizeof found, "holes along %.0f %% of the rays in %c", 100.0 * open,
                    "xyz"[axis]);
      throw InputError(file, "mesh", found, "a closed surface");
    }
  }
  NearestGrid nearest(triangles, n);
  nearest.fill_band();
  nearest.sweep();

  DistanceField field(grid);
  parallel_for(0, n.z(), [&](int k) {
    for (int j = 0; j < n.y(); ++j) {
      for (int i = 0; i < n.x(); ++i) {
        const std::size_t s = nearest.index(i, j, k);
        bool inside = votes[s] > 0;
        if (votes[s] == 0) {
          const NearestPoint& here = nearest.nearest(s);
          const Triangle& t = triangles[static_cast<std::size_t>(here.triangle)];
          inside = t.normal.dot(Vector3d(i, j, k) - here.point.cast<double>()) < 0.0;
        }
        const double distance = nearest.distance(s) * grid.spacing_m;
        field.kept_at(i, j, k) = static_cast<float>(inside ? -distance : distance);
      }
    }
  });
  return field;
}

}  // namespace sulcus
