#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/filled_map.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

/// The closest point to a voxel's centre on what was fitted, map space.
struct FilledPoint {
  ClosestPoint closest;
  float residual = 0.0f;  // of the points that it was fitted to, the largest, voxels
};

/// What was fitted to the points over a side.
struct SideFit {
  enum class Explains : std::uint8_t { kNothing, kNearly, kAll };
  Explains explains = Explains::kNothing;
  FilledPoint point;
};

/// The closest point on the quadric over a whole map, if it explains all its heights to within
/// `tolerance` across it, voxels.
std::optional<FilledPoint> fit_whole_filled(const FilledMap& map, float tolerance) noexcept;

/// How much heights scatter about smooth surfaces, voxels: from the median of third differences
/// along rows and columns, in which quadrics have no part, and edges, which most are not on, do not
/// count. Zero where there are hardly any, and where it is below `least`.
float height_noise(const FilledMap& map, float least) noexcept;

/// Fits to the points of a map that lie in a ball about the voxel, in a tilted frame; to all of
/// them, or to those over a side of the map.
class FilledFitter {
 public:
  /// The points within `radius`, voxels, of the voxel, in the frame whose third axis is `normal`
  /// (unit, map space).
  void gather(const FilledMap& map, const Eigen::Vector3f& normal, float radius) noexcept;
  /// The quadric that explains all of them within `tolerance`, voxels; none: nothing does.
  std::optional<FilledPoint> fit_ball(float tolerance) noexcept;
  /// Of each side the quadric, else the plane, that explains the points over it; or one that nearly
  /// does, and may in a frame of its own.
  void fit_sides(std::span<const MapSide> sides, float tolerance, std::span<SideFit> fits) noexcept;

 private:
  FilledPoint nearest_on(const Quadric& quadric, float residual_of_fit) const noexcept;
  /// Largest residual, voxels.
  float residual(const Quadric& quadric, const TiltedPoints& points) const noexcept;

  TiltedFrame frame_;
  TiltedPoints all_;
  std::array<TiltedPoints, TiltedGroup::kSize> of_sides_;
  TiltedGroup group_;
};

}  // namespace sulcus
