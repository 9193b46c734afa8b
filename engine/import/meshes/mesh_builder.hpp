#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "engine/core/error.hpp"
#include "engine/core/input_limits.hpp"
#include "engine/core/triangle_mesh.hpp"

namespace sulcus {

/// Makes the mesh that read_mesh promises out of the faces that a file holds.
class MeshBuilder {
 public:
  /// Cutting a face up takes the square of its corners.
  static constexpr std::size_t kMaxCorners = 4096;

  /// @throws InputError: a face of less than 3 corners or of more than kMaxCorners.
  static void check_corners(const std::string& path, const std::string& place,
                            std::uint64_t corners);
  /// @throws InputError: more triangles than the limits allow.
  static void check_triangles(const std::string& path, const std::string& place,
                              std::uint64_t triangles, const InputLimits& limits);
  /// Whether a place can be a vertex: finite, and within 1 km, whose square is still a good float.
  static bool is_usable(const Eigen::Vector3d& place_mm);
  /// What to say of one that cannot.
  static InputError unusable(const std::string& path, const std::string& place,
                             const Eigen::Vector3d& place_mm);

  /// The vertex at a usable place, mm: vertices at the same place are one. They are in the order in
  /// which they first occur.
  std::uint32_t vertex(const Eigen::Vector3d& place_mm);
  /// Adds a polygon of vertices, cut into triangles. Where it has less than three different ones,
  /// one after another, it bounds nothing and is dropped.
  void add_face(std::span<const std::uint32_t> vertices);
  /// The mesh, without vertices of no triangle.
  /// @throws InputError: fewer than 4 triangles, or no area.
  TriangleMesh finish(const std::string& path) &&;

 private:
  using Key = std::array<std::uint32_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& key) const;
  };
  TriangleMesh mesh_;
  std::unordered_map<Key, std::uint32_t, Hash> vertices_;
  std::vector<std::uint32_t> face_;  // without repeated corners
};

/// A file's table of vertices and the faces that refer to it.
struct IndexedFaces {
  std::vector<Eigen::Vector3d> places_mm;
  std::vector<std::uint32_t> corners;        // of all faces, one after another
  std::vector<std::uint32_t> first_of_face;  // in corners

  void begin_face() { first_of_face.push_back(static_cast<std::uint32_t>(corners.size())); }
};

/// The mesh of faces whose corners all name one of the places.
/// @throws InputError as MeshBuilder::finish, and for a place of a face that is not usable.
TriangleMesh build_mesh(const std::string& path, const IndexedFaces& faces);

}  // namespace sulcus
