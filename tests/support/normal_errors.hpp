#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "engine/normals/ldm.hpp"
#include "engine/normals/ldm_fast.hpp"
#include "engine/normals/surface_estimate.hpp"
#include "engine/volume/workpiece.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::test {

/// Of one voxel alone, what the methods say of many.
inline SurfaceEstimate estimate_ldm(const Workpiece& workpiece, const Cell& voxel,
                                    int neighbourhood, int trace,
                                    const Eigen::Vector3f& outward = Eigen::Vector3f::Zero()) {
  const VoxelQuery query{voxel, outward};
  SurfaceEstimate estimate;
  sulcus::estimate_ldm(workpiece, {&query, 1}, neighbourhood, trace, {&estimate, 1});
  return estimate;
}
inline SurfaceEstimate estimate_ldm_fast(const Workpiece& workpiece, const Cell& voxel,
                                         int neighbourhood, int trace,
                                         const Eigen::Vector3f& outward = Eigen::Vector3f::Zero()) {
  const VoxelQuery query{voxel, outward};
  SurfaceEstimate estimate;
  sulcus::estimate_ldm_fast(workpiece, {&query, 1}, neighbourhood, trace, {&estimate, 1});
  return estimate;
}

/// How far estimates are from the truth, over some surface voxels.
struct NormalErrors {
  int voxels = 0, undefined = 0;
  double mean_deg = 0.0, max_deg = 0.0;
  double mean_offset = 0.0;  // |offset error|, voxels
};

/// What the truth says at a voxel: outward unit normal, and how far out along it the surface lies
/// from the voxel's centre, voxels.
struct SurfaceTruth {
  Eigen::Vector3d normal;
  double offset;
};

/// `estimate(cell)` against `truth(cell)` over `cells`.
template <class Estimate, class Truth>
NormalErrors measure_errors(const std::vector<Cell>& cells, const Estimate& estimate,
                            const Truth& truth) {
  NormalErrors errors;
  for (const Cell& c : cells) {
    const SurfaceEstimate found = estimate(c);
    if (!found.defined) {
      ++errors.undefined;
      continue;
    }
    const SurfaceTruth expected = truth(c);
    const double deg = angle_deg(found.normal.template cast<double>(), expected.normal);
    ++errors.voxels;
    errors.mean_deg += deg;
    errors.max_deg = std::max(errors.max_deg, deg);
    errors.mean_offset += std::abs(static_cast<double>(found.offset) - expected.offset);
  }
  errors.mean_deg /= std::max(1, errors.voxels);
  errors.mean_offset /= std::max(1, errors.voxels);
  return errors;
}

/// Either a finite unit normal with a finite offset, or nothing and all zero.
inline ::testing::AssertionResult is_unit_or_undefined(const SurfaceEstimate& estimate) {
  const bool finite = estimate.normal.allFinite() && std::isfinite(estimate.offset);
  const float length = estimate.normal.norm();
  if (finite && estimate.defined && std::abs(length - 1.0f) < 1e-5f) {
    return ::testing::AssertionSuccess();
  }
  if (finite && !estimate.defined && length == 0.0f && estimate.offset == 0.0f) {
    return ::testing::AssertionSuccess();
  }
  return ::testing::AssertionFailure() << "normal " << estimate.normal.transpose() << " offset "
                                       << estimate.offset << " defined " << estimate.defined;
}

inline bool same_bits(const SurfaceEstimate& a, const SurfaceEstimate& b) {
  return a.normal == b.normal && a.offset == b.offset && a.defined == b.defined;
}

/// Surface voxels at least `margin` voxels from every face of the grid.
inline std::vector<Cell> inner_surface(const Workpiece& workpiece, int margin) {
  std::vector<Cell> cells = surface_cells(workpiece);
  std::erase_if(cells, [&](const Cell& c) {
    return (c.array() < margin).any() ||
           (c.array() >= workpiece.grid().cells.array() - margin).any();
  });
  return cells;
}

/// Unit normals tilted by 0 to 45 degrees from each axis and its opposite, at several azimuths.
inline std::vector<Eigen::Vector3d> tilted_normals() {
  std::vector<Eigen::Vector3d> normals;
  for (int axis = 0; axis < 3; ++axis) {
    for (int tilt = 5; tilt <= 45; tilt += 10) {
      const double t = tilt * 0.017453292519943295, azimuth = 0.3 + 1.7 * tilt + axis;
      Eigen::Vector3d n;
      n[axis] = (tilt / 10 % 2 == 0 ? 1.0 : -1.0) * std::cos(t);
      n[(axis + 1) % 3] = std::sin(t) * std::cos(azimuth);
      n[(axis + 2) % 3] = std::sin(t) * std::sin(azimuth);
      normals.push_back(n);
    }
  }
  return normals;
}

/// Three crossed bars' worth of the six neighbours: a solid voxel at `at` whose neighbours are
/// empty where `pattern` has a bit, as in exposed_faces.
inline Workpiece pattern_workpiece(int pattern, const Cell& at) {
  VoxelModel model = make_model({24, 24, 24}, 1e-4, [](const Cell&) { return false; });
  model.set(at, true);
  for (int face = 0; face < 6; ++face) {
    if ((pattern >> face & 1) != 0) continue;
    model.set(at + (face % 2 == 0 ? -1 : 1) * Cell::Unit(face / 2), true);
  }
  return Workpiece(std::move(model));
}

/// A plate `thickness` voxels thick about the middle of a cube of `edge` cells.
inline Workpiece plate(int edge, double thickness, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d centre =
      Eigen::Vector3d::Constant(0.5 * edge) + Eigen::Vector3d(.13, .29, .41);
  return Workpiece(make_model(Eigen::Vector3i::Constant(edge), 1e-4, [&](const Cell& c) {
    return std::abs(normal.dot(c.cast<double>() - centre)) <= 0.5 * thickness;
  }));
}

}  // namespace sulcus::test
