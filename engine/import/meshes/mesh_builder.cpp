#include "engine/import/meshes/mesh_builder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <sstream>
#include <utility>

#include "engine/core/units.hpp"
#include "engine/import/meshes/cut_polygon.hpp"

namespace sulcus {
namespace {

constexpr std::size_t kLeastTriangles = 4;  // of a solid
constexpr double kFarthest_mm = 1e6;
constexpr auto kNoVertex = ~std::uint32_t{0};

/// A vertex whose only triangles lost a corner is without any.
void drop_unused_vertices(TriangleMesh& mesh) {
  std::vector<std::uint32_t> renamed(mesh.positions.size(), kNoVertex);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) renamed[v] = 0;
  }
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < renamed.size(); ++v) {
    if (renamed[v] == kNoVertex) continue;
    mesh.positions[kept] = mesh.positions[v];
    renamed[v] = kept++;
  }
  mesh.positions.resize(kept);
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& v : triangle) v = renamed[v];
  }
}

double area_m2(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.positions[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.positions[t[1]].cast<double>();
    const Eigen::Vector3d c = mesh.positions[t[2]].cast<double>();
    const Eigen::Vector3d u = b - a, v = c - a;
    area += 0.5 * std::sqrt(std::max(0.0, u.squaredNorm() * v.squaredNorm() - u.dot(v) * u.dot(v)));
  }
  return area;
}

}  // namespace

void MeshBuilder::check_corners(const std::string& path, const std::string& place,
                                std::uint64_t corners) {
  if (corners >= 3 && corners <= kMaxCorners) return;
  throw InputError(path, place, "a face of " + std::to_string(corners) + " corners",
                   "3 to " + std::to_string(kMaxCorners));
}

void MeshBuilder::check_triangles(const std::string& path, const std::string& place,
                                  std::uint64_t triangles, const InputLimits& limits) {
  if (triangles <= limits.triangles()) return;
  throw InputError(path, place, std::to_string(triangles) + " triangles",
                   "at most " + std::to_string(limits.triangles()) + " (--limit-gib)");
}

bool MeshBuilder::is_usable(const Eigen::Vector3d& place_mm) {
  return (place_mm.array().abs() <= kFarthest_mm).all();
}

InputError MeshBuilder::unusable(const std::string& path, const std::string& place,
                                 const Eigen::Vector3d& place_mm) {
  std::ostringstream found;
  for (const double x : place_mm) {
    if (std::abs(x) <= kFarthest_mm) continue;
    found << "a coordinate of " << x;
    break;
  }
  return {path, place, found.str(), "a finite one within 1 km"};
}

std::size_t MeshBuilder::Hash::operator()(const Key& key) const {
  std::uint64_t h = 0;
  for (const std::uint32_t word : key) {
    h = (h ^ word) * 0x9e3779b97f4a7c15u;
    h ^= h >> 29;
  }
  return h;
}

std::uint32_t MeshBuilder::vertex(const Eigen::Vector3d& place_mm) {
  const Eigen::Vector3f p = (place_mm * kMillimetre).cast<float>();
  const auto next = static_cast<std::uint32_t>(mesh_.positions.size());
  // Adding 0 makes -0 and 0 the same place.
  const Key key = {std::bit_cast<std::uint32_t>(p.x() + 0.0f),
                   std::bit_cast<std::uint32_t>(p.y() + 0.0f),
                   std::bit_cast<std::uint32_t>(p.z() + 0.0f)};
  const auto [entry, inserted] = vertices_.try_emplace(key, next);
  if (inserted) mesh_.positions.push_back(p);
  return entry->second;
}

void MeshBuilder::add_face(std::span<const std::uint32_t> vertices) {
  face_.clear();
  for (const std::uint32_t v : vertices) {
    if (face_.empty() || v != face_.back()) face_.push_back(v);
  }
  while (face_.size() > 1 && face_.front() == face_.back()) face_.pop_back();
  if (face_.size() >= 3) cut_polygon(mesh_.positions, face_, mesh_.triangles);
}

TriangleMesh MeshBuilder::finish(const std::string& path) && {
  // A slit's ends, where a polygon comes back to the same corner.
  std::erase_if(mesh_.triangles,
                [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  if (mesh_.triangles.size() < kLeastTriangles) {
    throw InputError(path, "", std::to_string(mesh_.triangles.size()) + " triangles",
                     "at least " + std::to_string(kLeastTriangles));
  }
  drop_unused_vertices(mesh_);
  if (!(area_m2(mesh_) > 0.0)) {
    throw InputError(path, "", "triangles without any area", "a surface");
  }
  return std::move(mesh_);
}

TriangleMesh build_mesh(const std::string& path, const IndexedFaces& faces) {
  MeshBuilder builder;
  std::vector<std::uint32_t> vertices(faces.places_mm.size(), kNoVertex);
  std::vector<std::uint32_t> face;
  for (std::size_t f = 0; f < faces.first_of_face.size(); ++f) {
    const std::size_t end =
        f + 1 < faces.first_of_face.size() ? faces.first_of_face[f + 1] : faces.corners.size();
    face.clear();
    for (std::size_t c = faces.first_of_face[f]; c < end; ++c) {
      const std::uint32_t place = faces.corners[c];
      if (vertices[place] == kNoVertex) {
        const Eigen::Vector3d& place_mm = faces.places_mm[place];
        if (!MeshBuilder::is_usable(place_mm)) {
          throw MeshBuilder::unusable(path, "vertex " + std::to_string(place), place_mm);
        }
        vertices[place] = builder.vertex(place_mm);
      }
      face.push_back(vertices[place]);
    }
    builder.add_face(face);
  }
  return std::move(builder).finish(path);
}

}  // namespace sulcus
