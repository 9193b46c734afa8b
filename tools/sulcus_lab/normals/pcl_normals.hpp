#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/normals/surface_estimate.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus::lab {

/// The Point Cloud Library's two normal estimators over a cloud of surface voxels' centres, as
/// [Kim and Park 2019, VI-C] compares with. The neighbourhood is the ball of the same volume as the
/// cube of 2 NS + 1 voxels, radius 0.62 (2 NS + 1). Making the cloud builds its kd-tree; the
/// estimates only search it, so that the two can be timed apart. One thread.
///
/// `points` are places in the list that the cloud was made of; one result per point, in the same
/// order. A cloud of unoriented points has no outside: signs are as PCL leaves them, see
/// `turned_outward`. Offsets are 0. Undefined: fewer than three neighbours, or PCL's result is not
/// finite (PCA of points on a line).
class PclSurface {
 public:
  explicit PclSurface(const std::vector<Cell>& surface_cells);
  ~PclSurface();
  PclSurface(const PclSurface&) = delete;
  PclSurface& operator=(const PclSurface&) = delete;

  /// pcl::NormalEstimation: the direction in which the neighbours spread least.
  std::vector<SurfaceEstimate> pca(std::span<const int> points, int neighbourhood) const;
  /// pcl::MovingLeastSquares: a polynomial of order 2 over the plane of least squares with Gaussian
  /// weights of the radius, its normal at the point's projection.
  std::vector<SurfaceEstimate> mls(std::span<const int> points, int neighbourhood) const;

 private:
  struct Cloud;
  std::unique_ptr<Cloud> cloud_;
};

}  // namespace sulcus::lab
