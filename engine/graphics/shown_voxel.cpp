#include "engine/graphics/shown_voxel.hpp"

#include <limits>

#include "engine/core/parallel.hpp"
#include "engine/graphics/pinhole.hpp"

namespace sulcus {
namespace {

/// The one that `is_solid` nearest to a point, up to `reach` voxels away along each axis.
template <class IsSolid>
std::uint32_t nearest(const VoxelGrid& grid, const Eigen::Vector3d& p_index, int reach,
                      const IsSolid& is_solid) {
  const Cell here = (p_index.array() + 0.5).floor().cast<int>();
  if (grid.contains(here) && is_solid(here)) return grid.linear(here);
  double least = std::numeric_limits<double>::infinity();
  std::uint32_t found = kNoVoxel;
  for (int ring = 1; ring <= reach; ++ring) {
    // Further out nothing is nearer than so many voxels less a half.
    if (least <= (ring - 0.5) * (ring - 0.5)) break;
    for_each_cell(here - Cell::Constant(ring), here + Cell::Constant(ring + 1), [&](const Cell& c) {
      if ((c - here).cwiseAbs().maxCoeff() != ring || !grid.contains(c) || !is_solid(c)) return;
      const double squared = (c.cast<double>() - p_index).squaredNorm();
      if (squared >= least) return;
      least = squared;
      found = grid.linear(c);
    });
  }
  return found;
}

}  // namespace

std::vector<std::uint32_t> shown_voxels(const GlScene& scene, const GeometryImage& image,
                                        std::span<const Pose> pieces) {
  const Pinhole camera = pinhole_of(scene.view(), image.width, image.height);
  const auto width = static_cast<std::size_t>(image.width);
  std::vector<std::uint32_t> voxels(image.objects.size(), kNoVoxel);
  constexpr double kInside = 0.01;  // of a voxel
  parallel_for(0, image.height, [&](int v) {
    for (std::size_t u = 0; u < width; ++u) {
      const std::size_t pixel = static_cast<std::size_t>(v) * width + u;
      const ShownObject shown = image.object(pixel);
      const bool of_piece = shown.kind == ShownObject::Kind::kPiece;
      if (shown.kind != ShownObject::Kind::kSurface &&
          shown.kind != ShownObject::Kind::kSectionFace && !of_piece) {
        continue;
      }
      const std::size_t body = of_piece ? 0 : shown.index;
      const DrawnSurface& surface = scene.surface(body);
      const VoxelGrid& grid = surface.model().grid;
      Eigen::Vector3d p =
          camera.point_world(static_cast<double>(u), v, static_cast<double>(image.depth_m[pixel]));
      const auto& n = image.normal_camera[pixel];
      p -= kInside * grid.voxel_m *
           (camera.world_from_camera.topLeftCorner<3, 3>() *
            Eigen::Vector3f(n.data()).cast<double>());
      if (of_piece) p = pieces[shown.index].inverse_point(p);
      const Eigen::Vector3d p_index =
          grid.index_from_world(scene.world_from_grid(body).inverse_point(p));
      const int reach = 3 * surface.cell_voxels();
      voxels[pixel] =
          of_piece ? nearest(grid, p_index, reach,
                             [&](const Cell& c) {
                               return surface.solid_at_start(grid.leaf_of(c)).has(leaf_place(c));
                             })
                   : nearest(grid, p_index, reach,
                             [&](const Cell& c) { return surface.model().solid(c); });
    }
  });
  return voxels;
}

}  // namespace sulcus
