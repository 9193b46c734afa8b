// The table of an instruction set's kernels: most are one writing compiled for each set, the others
// are the set's own.

#pragma once

#include "engine/normals/kernels/disc_sums.hpp"
#include "engine/normals/kernels/fit_windows.hpp"
#include "engine/normals/kernels/plane_step.hpp"
#include "engine/normals/kernels/surface_group.hpp"
#include "engine/normals/kernels/tilted_group.hpp"
#include "engine/normals/kernels/tilted_points.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

/// `own`: with the set's own kernels.
constexpr MapKernels kernel_table(const char* name, const MapKernels& own) {
  return {.name = name,
          .coarse = own.coarse,
          .trace = own.trace,
          .tile = own.tile,
          .cut = own.cut,
          .fit = own.fit,
          .choose_axes = choose_axes,
          .look_up = look_up,
          .surfaces = surfaces_of,
          .group_residuals = group_residuals,
          .sharpen_group = sharpen_group,
          .map_residuals = map_residuals,
          .close_sums = close_sums,
          .plane_step = plane_step,
          .look_at_plane = look_at_plane,
          .halves = half_sums,
          .on_plane = sums_on_plane,
          .plane_residuals = residuals_on_plane,
          .gather = gather_points,
          .moments = tilted_moments,
          .residuals = tilted_residuals,
          .sharpen_points = sharpen_points,
          .solve_quantised = solve_quantised,
          .solve_sharpened = solve_sharpened,
          .tilted_closest_points = tilted_closest_points,
          .sum_row = sum_row,
          .fit_windows = fit_windows};
}

}  // namespace

}  // namespace sulcus
