#include "tools/sulcus_lab/normals/pcl_normals.hpp"

#include <cstddef>

#include <pcl/features/normal_3d.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/mls.h>

// Build this file without -march flags: they change the alignment of Eigen's types, and Debian's
// PCL, built without, then crashes in MLS.

namespace sulcus::lab {

namespace {

using Points = pcl::PointCloud<pcl::PointXYZ>;

/// MovingLeastSquares hands its cloud to the tree in every call; PCL's own would build itself anew.
class BuiltTree : public pcl::search::KdTree<pcl::PointXYZ> {
 public:
  explicit BuiltTree(const Points::ConstPtr& points)
      : KdTree(false) {  // unsorted results, as PCL's estimators ask for themselves
    KdTree::setInputCloud(points);
  }
  void setInputCloud(const Points::ConstPtr& points, const pcl::IndicesConstPtr& indices) override {
    if (points != input_) KdTree::setInputCloud(points, indices);
  }
};

double search_radius(int neighbourhood) { return 0.62 * (2 * neighbourhood + 1); }

pcl::IndicesPtr indices_of(std::span<const int> points) {
  return std::make_shared<pcl::Indices>(points.begin(), points.end());
}

template <class Point>
SurfaceEstimate estimate_of(const Point& point) {
  const Eigen::Vector3f normal(point.normal_x, point.normal_y, point.normal_z);
  const float length = normal.norm();
  if (!(length > 0.0f)) return {};  // NaN too
  return {normal / length, 0.0f, true};
}

}  // namespace

struct PclSurface::Cloud {
  Points::Ptr points = std::make_shared<Points>();
  std::shared_ptr<BuiltTree> tree;
};

PclSurface::PclSurface(const std::vector<Cell>& surface_cells) : cloud_(std::make_unique<Cloud>()) {
  cloud_->points->reserve(surface_cells.size());
  for (const Cell& c : surface_cells) {
    const Eigen::Vector3f centre = c.cast<float>();
    cloud_->points->push_back(pcl::PointXYZ(centre.x(), centre.y(), centre.z()));
  }
  if (surface_cells.empty()) return;  // PCL would complain, and there is nothing to ask for
  cloud_->tree = std::make_shared<BuiltTree>(cloud_->points);
}

PclSurface::~PclSurface() = default;

std::vector<SurfaceEstimate> PclSurface::pca(std::span<const int> points, int neighbourhood) const {
  std::vector<SurfaceEstimate> estimates;
  if (points.empty()) return estimates;  // no indices would mean all
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(cloud_->points);
  estimation.setIndices(indices_of(points));
  estimation.setSearchMethod(cloud_->tree);
  estimation.setRadiusSearch(search_radius(neighbourhood));
  pcl::PointCloud<pcl::Normal> normals;
  estimation.compute(normals);
  estimates.reserve(points.size());
  for (const pcl::Normal& normal : normals) estimates.push_back(estimate_of(normal));
  return estimates;
}

std::vector<SurfaceEstimate> PclSurface::mls(std::span<const int> points, int neighbourhood) const {
  std::vector<SurfaceEstimate> estimates(points.size());
  if (points.empty()) return estimates;
  pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointNormal> surface;
  surface.setInputCloud(cloud_->points);
  surface.setIndices(indices_of(points));
  surface.setSearchMethod(cloud_->tree);
  surface.setSearchRadius(search_radius(neighbourhood));
  surface.setPolynomialOrder(2);
  surface.setComputeNormals(true);
  surface.setCacheMLSResults(false);
  surface.setNumberOfThreads(1);
  pcl::PointCloud<pcl::PointNormal> projected;
  surface.process(projected);

  // Points with too few neighbours are left out, the others keep their order.
  const pcl::Indices& found = surface.getCorrespondingIndices()->indices;
  std::size_t next = 0;
  for (std::size_t p = 0; p < points.size() && next < found.size(); ++p) {
    if (points[p] != found[next]) continue;
    estimates[p] = estimate_of(projected[next]);
    ++next;
  }
  return estimates;
}

}  // namespace sulcus::lab
