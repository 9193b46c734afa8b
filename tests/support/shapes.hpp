#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/volume/voxel_model.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus::test {

/// A model in which voxel `c` is solid where `solid(c)`; `cells` are multiples of 8.
template <class Solid>
VoxelModel make_model(const Eigen::Vector3i& cells, double voxel_m, const Solid& solid) {
  VoxelModel model;
  model.grid.cells = cells;
  model.grid.voxel_m = voxel_m;
  model.leaves.resize(model.grid.leaf_count());
  for (int k = 0; k < cells.z(); ++k) {
    for (int j = 0; j < cells.y(); ++j) {
      for (int i = 0; i < cells.x(); ++i) {
        if (solid(Cell(i, j, k))) model.set({i, j, k}, true);
      }
    }
  }
  return model;
}

/// With fractions: voxel `c` is filled up to `level(c)`, 0 to 255.
template <class Level>
VoxelModel filled_model(const Eigen::Vector3i& cells, double voxel_m, const Level& level) {
  VoxelModel model = make_model(cells, voxel_m, [](const Cell&) { return false; });
  model.fills.emplace(model.grid.leaf_count(), std::vector<LeafLevels>{});
  model.fills->reserve(model.grid.leaf_count());
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    model.set_level(c, static_cast<FillLevel>(level(c)));
  }
  return model;
}

/// Voxels whose centre is within `radius` voxels of `centre_index`.
inline VoxelModel ball(const Eigen::Vector3i& cells, double voxel_m,
                       const Eigen::Vector3d& centre_index, double radius) {
  return make_model(cells, voxel_m, [&](const Cell& c) {
    return (c.cast<double>() - centre_index).squaredNorm() <= radius * radius;
  });
}

/// Voxels whose centre is not beyond the plane through `point_index` with the outward `normal`.
inline VoxelModel half_space(const Eigen::Vector3i& cells, double voxel_m,
                             const Eigen::Vector3d& normal, const Eigen::Vector3d& point_index) {
  return make_model(cells, voxel_m, [&](const Cell& c) {
    return normal.dot(c.cast<double>() - point_index) <= 0.0;
  });
}

/// Voxels `lower` to `upper`, `upper` exclusive.
inline VoxelModel block(const Eigen::Vector3i& cells, double voxel_m, const Cell& lower,
                        const Cell& upper) {
  return make_model(cells, voxel_m, [&](const Cell& c) {
    return (c.array() >= lower.array()).all() && (c.array() < upper.array()).all();
  });
}

/// Balls at random, some across the faces of the grid, with one voxel in sixteen flipped: full,
/// part-full, empty and speckled leaves. The same for the same seed everywhere.
inline VoxelModel random_blobs(const Eigen::Vector3i& cells, std::uint32_t seed,
                               double voxel_m = 50e-6) {
  std::mt19937 random(seed);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  struct Ball {
    Eigen::Vector3d centre;
    double radius;
  };
  std::vector<Ball> balls;
  for (int b = 0; b < 5; ++b) {
    const Cell at(below(cells.x()), below(cells.y()), below(cells.z()));
    balls.push_back({at.cast<double>(), 2.0 + below(12)});
  }
  return make_model(cells, voxel_m, [&](const Cell& c) {
    bool solid = false;
    for (const Ball& ball : balls) {
      solid |= (c.cast<double>() - ball.centre).norm() < ball.radius;
    }
    // Speckle in half of the grid only, so that the other half keeps full and empty leaves.
    const bool speckled = c.x() % 32 < 16 && below(16) == 0;
    return solid != speckled;
  });
}

/// All solid voxels, x fastest.
inline std::vector<Cell> solid_cells(const VoxelModel& model) {
  std::vector<Cell> cells;
  for (std::uint32_t v = 0; v < model.grid.cell_count(); ++v) {
    const Cell c = model.grid.cell_of_linear(v);
    if (model.solid(c)) cells.push_back(c);
  }
  return cells;
}

/// All surface voxels, x fastest.
inline std::vector<Cell> surface_cells(const Workpiece& workpiece) {
  std::vector<Cell> cells;
  for (const Cell& c : solid_cells(workpiece.model())) {
    if (workpiece.is_surface(c)) cells.push_back(c);
  }
  return cells;
}

/// Fisher-Yates with a generator of our own count: std::shuffle differs between libraries.
template <class T>
void shuffle(std::vector<T>& items, std::mt19937& random) {
  for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[random() % i]);
}

/// Angle between two directions, degrees.
inline double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 57.29577951308232;
}

/// The same voxels seen in a mirror across `axis`.
inline VoxelModel mirrored(const VoxelModel& model, int axis) {
  return make_model(model.grid.cells, model.grid.voxel_m, [&](const Cell& c) {
    Cell from = c;
    from[axis] = model.grid.cells[axis] - 1 - c[axis];
    return model.solid(from);
  });
}

/// The shape of the symmetry tests: two balls that meet in a groove, aslant in the grid.
inline VoxelModel two_balls() {
  const Eigen::Vector3d a(20.2, 17.6, 22.9), b(28.7, 29.3, 19.4);
  return make_model({48, 48, 48}, 1e-4, [&](const Cell& c) {
    const Eigen::Vector3d p = c.cast<double>();
    return (p - a).norm() < 13.3 || (p - b).norm() < 11.7;
  });
}

}  // namespace sulcus::test
