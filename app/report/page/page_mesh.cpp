#include "app/report/page/page_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>

#include <meshoptimizer.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace sulcus {

namespace {

constexpr std::uint32_t kUnused = ~std::uint32_t{0};

/// Squared distance of a point to a triangle [Ericson 2005, 5.1.5].
double squared_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                        const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return ap.squaredNorm();
  const Eigen::Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return bp.squaredNorm();
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return (ap - d1 / (d1 - d3) * ab).squaredNorm();
  const Eigen::Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return cp.squaredNorm();
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return (ap - d2 / (d2 - d6) * ac).squaredNorm();
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return (bp - (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b)).squaredNorm();
  }
  const double all = va + vb + vc;
  if (all <= 0.0) return std::min({ap.squaredNorm(), bp.squaredNorm(), cp.squaredNorm()});
  return (ap - vb / all * ab - vc / all * ac).squaredNorm();
}

/// Triangles by the cubes that their boxes, widened by a reach, touch.
class TriangleCubes {
 public:
  TriangleCubes(const TriangleMesh& mesh, double reach_m)
      : mesh_(mesh), edge_m_(std::max(4.0 * reach_m, 1e-9)) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      Eigen::Vector3d low = corner(t, 0), high = low;
      for (const std::size_t k : {1u, 2u}) {
        low = low.cwiseMin(corner(t, k));
        high = high.cwiseMax(corner(t, k));
      }
      const Eigen::Vector3i first = cube(low.array() - reach_m);
      const Eigen::Vector3i last = cube(high.array() + reach_m);
      for (int z = first.z(); z <= last.z(); ++z) {
        for (int y = first.y(); y <= last.y(); ++y) {
          for (int x = first.x(); x <= last.x(); ++x) {
            triangles_[key({x, y, z})].push_back(static_cast<std::uint32_t>(t));
          }
        }
      }
    }
  }

  /// To the nearest of those within reach; infinite where there is none near.
  double squared_distance_to(const Eigen::Vector3d& p) const {
    double nearest = std::numeric_limits<double>::infinity();
    const auto found = triangles_.find(key(cube(p)));
    if (found == triangles_.end()) return nearest;
    for (const std::uint32_t t : found->second) {
      nearest = std::min(nearest, squared_distance(p, corner(t, 0), corner(t, 1), corner(t, 2)));
    }
    return nearest;
  }

 private:
  Eigen::Vector3d corner(std::size_t t, std::size_t k) const {
    return mesh_.positions[mesh_.triangles[t][k]].cast<double>();
  }
  Eigen::Vector3i cube(const Eigen::Vector3d& p) const {
    return (p / edge_m_).array().floor().cast<int>();
  }
  static std::uint64_t key(const Eigen::Vector3i& c) {
    constexpr std::uint64_t kBits = (1u << 21) - 1;
    return (static_cast<std::uint64_t>(c.x()) & kBits) |
           (static_cast<std::uint64_t>(c.y()) & kBits) << 21 |
           (static_cast<std::uint64_t>(c.z()) & kBits) << 42;
  }

  const TriangleMesh& mesh_;
  double edge_m_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> triangles_;
};

std::vector<std::array<std::uint32_t, 3>> fewer_triangles(const TriangleMesh& mesh, double most_m) {
  const float* const positions = mesh.positions.front().data();
  constexpr std::size_t kStride = sizeof(Eigen::Vector3f);
  const std::size_t vertices = mesh.positions.size();
  const std::span<const std::uint32_t> indices(mesh.triangles.front().data(),
                                               3 * mesh.triangles.size());
  std::vector<std::array<std::uint32_t, 3>> fewer(mesh.triangles.size());
  const float scale = meshopt_simplifyScale(positions, vertices, kStride);
  const std::size_t left = meshopt_simplify(
      fewer.front().data(), indices.data(), indices.size(), positions, vertices, kStride, 0,
      static_cast<float>(most_m) / std::max(scale, 1e-12f), meshopt_SimplifyLockBorder, nullptr);
  fewer.resize(left / 3);
  return fewer;
}

MeshPart used_part(const TriangleMesh& mesh,
                   const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  MeshPart part;
  std::vector<std::uint32_t> place(mesh.positions.size(), kUnused);
  part.mesh.triangles.reserve(triangles.size());
  for (std::array<std::uint32_t, 3> triangle : triangles) {
    for (std::uint32_t& v : triangle) {
      if (place[v] == kUnused) {
        place[v] = static_cast<std::uint32_t>(part.vertex_of.size());
        part.vertex_of.push_back(v);
        part.mesh.positions.push_back(mesh.positions[v]);
      }
      v = place[v];
    }
    part.mesh.triangles.push_back(triangle);
  }
  return part;
}

/// Triangles that hang together; those of pieces that are too small to be simplified are one.
std::vector<std::vector<std::size_t>> pieces_of(const TriangleMesh& mesh) {
  constexpr std::size_t kSmall = 64;
  std::vector<std::uint32_t> parent(mesh.positions.size());
  for (std::uint32_t v = 0; v < parent.size(); ++v) parent[v] = v;
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    parent[root(b)] = root(a);
    parent[root(c)] = root(a);
  }
  std::map<std::uint32_t, std::vector<std::size_t>> of_root;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    of_root[root(mesh.triangles[t][0])].push_back(t);
  }
  std::vector<std::vector<std::size_t>> pieces(1);
  for (auto& [first, triangles] : of_root) {
    if (triangles.size() > kSmall) {
      pieces.push_back(std::move(triangles));
    } else {
      pieces[0].insert(pieces[0].end(), triangles.begin(), triangles.end());
    }
  }
  return pieces;
}

/// Of a mesh in one piece, or of some that are small: what is farther off than that has gone whole,
/// so that these are best left alone.
MeshPart simplified_piece(const TriangleMesh& mesh, double most_m) {
  // The method's estimate is of planes, and is often, not always, above what is measured.
  double target_m = most_m;
  for (int attempt = 0; attempt < 8 && !mesh.triangles.empty(); ++attempt, target_m *= 0.6) {
    MeshPart part = used_part(mesh, fewer_triangles(mesh, target_m));
    if (std::isfinite(greatest_distance(mesh, part.mesh, most_m))) return part;
  }
  return used_part(mesh, mesh.triangles);
}

/// `vertex_of`: of the vertices that the part was made of.
void append(const MeshPart& part, const std::vector<std::uint32_t>& vertex_of, MeshPart& all) {
  const auto first = static_cast<std::uint32_t>(all.vertex_of.size());
  for (std::size_t v = 0; v < part.vertex_of.size(); ++v) {
    all.vertex_of.push_back(vertex_of[part.vertex_of[v]]);
    all.mesh.positions.push_back(part.mesh.positions[v]);
  }
  for (const auto& [a, b, c] : part.mesh.triangles) {
    all.mesh.triangles.push_back({first + a, first + b, first + c});
  }
}

}  // namespace

std::vector<Eigen::Vector3f> smoothed_normals(const TriangleMesh& mesh, int passes) {
  std::vector<Eigen::Vector3f> normals(mesh.positions.size(), Eigen::Vector3f::Zero());
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f& p = mesh.positions[a];
    // In mm: squares of metres of a voxel lose their small parts.
    const Eigen::Vector3f area =
        (1e3f * (mesh.positions[b] - p)).cross(1e3f * (mesh.positions[c] - p));
    for (const std::uint32_t v : {a, b, c}) normals[v] += area;
  }
  for (Eigen::Vector3f& n : normals) n.normalize();
  std::vector<Eigen::Vector3f> sums;
  for (int pass = 0; pass < passes; ++pass) {
    sums = normals;
    for (const auto& [a, b, c] : mesh.triangles) {
      sums[a] += 0.5f * (normals[b] + normals[c]);
      sums[b] += 0.5f * (normals[c] + normals[a]);
      sums[c] += 0.5f * (normals[a] + normals[b]);
    }
    for (std::size_t v = 0; v < sums.size(); ++v) normals[v] = sums[v].normalized();
  }
  return normals;
}

double greatest_distance(const TriangleMesh& from, const TriangleMesh& to, double limit_m) {
  const TriangleCubes cubes(to, limit_m);
  const double greatest = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, from.positions.size()), 0.0,
      [&](const tbb::blocked_range<std::size_t>& range, double most) {
        for (std::size_t v = range.begin(); v < range.end(); ++v) {
          most = std::max(most, cubes.squared_distance_to(from.positions[v].cast<double>()));
        }
        return most;
      },
      [](double a, double b) { return std::max(a, b); });
  return greatest <= limit_m * limit_m ? std::sqrt(greatest)
                                       : std::numeric_limits<double>::infinity();
}

MeshPart part_of(const TriangleMesh& mesh, const std::vector<std::size_t>& triangles) {
  std::vector<std::array<std::uint32_t, 3>> some;
  some.reserve(triangles.size());
  for (const std::size_t t : triangles) some.push_back(mesh.triangles[t]);
  return used_part(mesh, some);
}

MeshPart simplified(const TriangleMesh& mesh, double most_m) {
  MeshPart all;
  for (const std::vector<std::size_t>& piece : pieces_of(mesh)) {
    const MeshPart part = part_of(mesh, piece);
    append(simplified_piece(part.mesh, most_m), part.vertex_of, all);
  }
  return all;
}

}  // namespace sulcus
