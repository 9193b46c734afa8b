#include "engine/normals/normal_errors.hpp"

#include <bit>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/parallel.hpp"
#include "engine/normals/exact.hpp"
#include "engine/normals/normal_method.hpp"

namespace sulcus {

namespace {

/// Of the surface voxels of one leaf.
VoxelValues::Block errors_of_leaf(const Workpiece& workpiece, const NormalSettings& settings,
                                  std::uint32_t leaf) {
  std::vector<VoxelQuery> queries;
  const Cell first = workpiece.grid().leaf_origin(leaf);
  for_each_voxel(workpiece.surface(leaf),
                 [&](int place) { queries.push_back(VoxelQuery{first + cell_in_leaf(place)}); });
  std::vector<SurfaceEstimate> felt(queries.size());
  estimate_surfaces(workpiece, queries, settings, felt);
  VoxelValues::Block errors;
  errors.fill(VoxelValues::kNone);
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const SurfaceEstimate exact =
        estimate_exact(workpiece, queries[q].voxel, settings.neighbourhood);
    if (!felt[q].defined || !exact.defined) continue;
    // By the tangent: the cosine of a small angle says little of it.
    const Eigen::Vector3d a = felt[q].normal.cast<double>(), b = exact.normal.cast<double>();
    errors[leaf_place(queries[q].voxel)] =
        static_cast<float>(std::atan2(a.cross(b).norm(), a.dot(b)));
  }
  return errors;
}

}  // namespace

VoxelValues normal_errors(const Workpiece& workpiece, const NormalSettings& settings) {
  prepare_normals();
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t leaf = 0; leaf < workpiece.grid().leaf_count(); ++leaf) {
    if (any(workpiece.surface(leaf))) leaves.push_back(leaf);
  }
  std::vector<VoxelValues::Block> blocks(leaves.size());
  parallel_for(std::size_t{0}, leaves.size(),
               [&](std::size_t n) { blocks[n] = errors_of_leaf(workpiece, settings, leaves[n]); });
  VoxelValues errors(workpiece.grid());
  for (std::size_t n = 0; n < leaves.size(); ++n) errors.set_block(leaves[n], blocks[n]);
  return errors;
}

}  // namespace sulcus
