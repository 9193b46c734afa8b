#pragma once

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/normals/map_kernels.hpp"
#include "tests/support/instruction_sets.hpp"
#include "tests/support/shapes.hpp"

namespace sulcus::test {

/// The kernels of each instruction set against the plain ones.
class MapKernelsFixture : public ::testing::TestWithParam<InstructionSet> {
 protected:
  void SetUp() override {
    fast_ = map_kernels_of(GetParam());
    if (!fast_) GTEST_SKIP() << "this processor has no " << set_name(GetParam());
  }

  ColumnBits::Windows windows(const Workpiece& workpiece, const Cell& c, int axis) const {
    return workpiece.columns().around(axis, c[(axis + 1) % 3], c[(axis + 2) % 3], c[axis] - kLevel);
  }

  static void trace_one(const MapKernels& kernels, const ColumnBits::Windows& columns, int trace,
                        HeightMap& map) {
    kernels.trace(&columns, 1, trace, &map);
  }

  static HeightMap ask(int ns, int stride, int sign) {
    HeightMap map;
    map.ns = ns;
    map.stride = stride;
    map.sign = sign;
    map.height.fill(77);  // what a trace leaves unset shows
    return map;
  }

  /// Smooth, ragged, thin and tilted surroundings.
  static std::vector<Workpiece> shapes() {
    std::vector<Workpiece> all;
    all.emplace_back(two_balls());
    all.emplace_back(random_blobs({40, 32, 48}, 5));
    all.emplace_back(half_space({48, 48, 48}, 1e-4, {0.4, -0.3, 0.86}, {23, 24, 25}));
    all.emplace_back(make_model({48, 48, 48}, 1e-4, [](const Cell& c) {
      const double side = 0.5 * c.x() + 0.2 * c.y() + 0.84 * c.z() - 36.0;
      return std::abs(side) < 1.1;
    }));
    return all;
  }

  static bool same_sums(const PlaneSums& a, const PlaneSums& b) {
    return a.n == b.n && a.i == b.i && a.j == b.j && a.ii == b.ii && a.ij == b.ij && a.jj == b.jj &&
           a.z == b.z && a.iz == b.iz && a.jz == b.jz;
  }

  template <class Each>
  void for_maps(const Each& each) const {
    for (const Workpiece& workpiece : shapes()) {
      const std::vector<Cell> cells = surface_cells(workpiece);
      for (std::size_t k = 0; k < cells.size(); k += 7) {
        for (int axis = 0; axis < 3; ++axis) {
          for (const int sign : {-1, 1}) each(windows(workpiece, cells[k], axis), sign);
        }
      }
    }
  }

  /// Of a surface across itself, a column out.
  static float curvature_of(const ColumnQuadric& surface) {
    return (std::abs(surface.c[3]) + std::abs(surface.c[5]) + std::abs(surface.c[4])) *
           closest_point_of(surface).normal_z;
  }

  const MapKernels* const plain_ = map_kernels_of(InstructionSet::kPlain);
  const MapKernels* fast_ = nullptr;
};
}  // namespace sulcus::test
