#include "engine/surface/section_face.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "engine/core/parallel.hpp"

namespace sulcus {

namespace {

/// Smooths the picture along one of its edges, 1 4 6 4 1, so that no staircase of voxels shows.
enum class Edge { kAlong, kAcross };
void smooth(SectionFace& face, Edge edge) {
  const bool along = edge == Edge::kAlong;
  const std::vector<std::array<std::uint8_t, 4>> sharp = face.pixels;
  const int count = along ? face.width : face.height, lines = along ? face.height : face.width;
  const int step = along ? 1 : face.width, next_line = along ? face.width : 1;
  parallel_for(0, lines, [&](int line) {
    for (int i = 0; i < count; ++i) {
      std::array<int, 4> sum{};
      for (int tap = -2; tap <= 2; ++tap) {
        constexpr std::array<int, 5> kWeights{1, 4, 6, 4, 1};
        const int at = line * next_line + std::clamp(i + tap, 0, count - 1) * step;
        for (std::size_t c = 0; c < 4; ++c) {
          sum[c] +=
              kWeights[static_cast<std::size_t>(tap + 2)] * sharp[static_cast<std::size_t>(at)][c];
        }
      }
      for (std::size_t c = 0; c < 4; ++c) {
        face.pixels[static_cast<std::size_t>(line * next_line + i * step)][c] =
            static_cast<std::uint8_t>((sum[c] + 8) / 16);
      }
    }
  });
}

/// Of linear RGB, wholly solid.
std::array<std::uint8_t, 4> packed(const Eigen::Vector3f& rgb) {
  std::array<std::uint8_t, 4> pixel{0, 0, 0, 255};
  for (int i = 0; i < 3; ++i) {
    pixel[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::lround(255.0f * rgb[i]));
  }
  return pixel;
}

}  // namespace

SectionFace section_face(const DrawnSurface& body, const Pose& world_from_grid,
                         const Section& section) {
  const VoxelGrid& grid = body.model().grid;
  Eigen::AlignedBox3d box;
  const Eigen::Vector3d half = 0.5 * grid.voxel_m * grid.cells.cast<double>();
  const Eigen::AlignedBox3d of_grid(-half, half);
  for (int corner = 0; corner < 8; ++corner) {
    box.extend(world_from_grid.point(
        of_grid.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
  }
  SectionFace face;
  const int axis = section.axis;
  if (section.at_m <= box.min()[axis] || section.at_m >= box.max()[axis]) return face;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Eigen::Vector3d step_u = grid.voxel_m * Eigen::Vector3d::Unit(u);
  const Eigen::Vector3d step_v = grid.voxel_m * Eigen::Vector3d::Unit(v);
  const auto pixels = [&](int a) {
    return static_cast<int>(std::ceil(box.sizes()[a] / grid.voxel_m - 1e-6));
  };
  face.width = pixels(u);
  face.height = pixels(v);
  face.corner_world = box.min();
  face.corner_world[axis] = section.at_m;
  face.along_world = face.width * step_u;
  face.across_world = face.height * step_v;
  face.pixels.assign(static_cast<std::size_t>(face.width) * static_cast<std::size_t>(face.height),
                     {});
  std::vector<std::array<std::uint8_t, 4>> colours;
  colours.reserve(body.looks().size());
  for (const TissueLook& look : body.looks()) {
    colours.push_back(packed(Eigen::Vector3f(look.colour.data())));
  }
  const bool by_values = body.values() && body.colour_scale()->inside;
  parallel_for(0, face.height, [&](int row) {
    for (int column = 0; column < face.width; ++column) {
      const Eigen::Vector3d p_world =
          face.corner_world + (column + 0.5) * step_u + (row + 0.5) * step_v;
      const Eigen::Vector3d p_index = grid.index_from_world(world_from_grid.inverse_point(p_world));
      const Cell cell = (p_index.array() + 0.5).floor().cast<int>();
      if (!body.model().solid(cell)) continue;
      const std::size_t tissue =
          std::min<std::size_t>(body.model().tissue(cell), colours.size() - 1);
      std::array<std::uint8_t, 4>& pixel =
          face.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(face.width) +
                      static_cast<std::size_t>(column)];
      pixel = colours[tissue];
      const float value = by_values ? body.values()->at(cell) : VoxelValues::kNone;
      if (!std::isnan(value)) pixel = packed(body.colour_scale()->colour(value));
      const int level = body.model().level(cell);
      if (level == kFullLevel) continue;
      for (std::uint8_t& c : pixel) {
        c = static_cast<std::uint8_t>((c * level + kFullLevel / 2) / kFullLevel);
      }
    }
  });
  smooth(face, Edge::kAlong);
  smooth(face, Edge::kAcross);
  return face;
}

}  // namespace sulcus
