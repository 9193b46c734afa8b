// The kernels of AVX2, and of AVX-512 where a wider step pays: written once and compiled for each
// set by the files that include this.

#pragma once

#include "engine/normals/kernels/coarse_sums.hpp"
#include "engine/normals/kernels/fit_rows.hpp"
#include "engine/normals/kernels/kernel_table.hpp"
#include "engine/normals/kernels/read_tile.hpp"
#include "engine/normals/kernels/trace_maps.hpp"

namespace sulcus {

namespace {

constexpr MapKernels vector_kernels(const char* name) {
  return kernel_table(name, {.coarse = coarse_sums,
                             .trace = trace_maps,
                             .tile = read_tile,
                             .cut = cut_map,
                             .fit = fit_rows});
}

}  // namespace

}  // namespace sulcus
