#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "engine/normals/column_quadric.hpp"
#include "engine/normals/height_map.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

/// The closest point to the voxel's centre on the least-squares plane of the map's points
/// within 3.6 voxels of it; none where they are fewer than five or in line.
std::optional<ClosestPoint> close_plane(const HeightMap& map) noexcept;

/// A fit that is asked for, and what came of it.
struct TiltedFit {
  const HeightMap* map = nullptr;  // of stride 1
  Eigen::Vector3f normal;          // third axis of the frame, unit, map space
  float radius = 0.0f;             // voxels
  MapSide side;
  std::optional<ClosestPoint> closest;  // on what explains the points
  /// Where nothing does, of the quadric all the same: the mean square of its residuals by degrees
  /// of freedom, voxels^2, infinite where there is no quadric; and the closest point on it.
  float scatter = std::numeric_limits<float>::infinity();
  ClosestPoint unexplained{};
  float sagitta = 0.0f;  // of it from its tangent plane to the ball's rim, voxels
};

/// Fits tilted surfaces, TiltedGroup::kSize of them side by side.
class TiltedFitter {
 public:
  /// The plane, else the quadric, that explains all points of a map, or of a side of it, within
  /// `radius` of the voxel to their quantisation, fitted in the frame whose third axis is `normal`:
  /// there a curved surface is a quadric farther out than over the columns. None where neither
  /// does.
  void fit(std::span<TiltedFit> fits) noexcept;

 private:
  enum class Found : std::uint8_t { kNothing, kFlat, kCurved };

  void fit_group(std::span<TiltedFit> fits) noexcept;  // or fewer
  void gather(std::span<const TiltedFit> fits) noexcept;
  /// Whether what was solved for a fit explains its points; a plane is put in its quadric's place.
  /// `scatter`: of a quadric that does not.
  Found judge(std::size_t k, float& scatter) noexcept;
  void sharpen(std::span<const Found> found) noexcept;

  // Lanes beyond the fits hold what earlier ones left.
  TiltedGroup group_, sharpened_;
  std::array<TiltedFrame, TiltedGroup::kSize> frames_;
  std::array<TiltedPoints, TiltedGroup::kSize> points_;
};

}  // namespace sulcus
