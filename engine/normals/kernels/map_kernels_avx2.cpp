// Compiled for AVX2. Leaves no inline code for others to be linked with (test
// KernelsKeepToThemselves).
#ifdef __AVX2__
#include "engine/normals/kernels/vector_kernels.hpp"
#else
#include "engine/normals/map_kernels.hpp"
#endif

namespace sulcus {

const MapKernels* avx2_map_kernels() noexcept {
#ifdef __AVX2__
  static constexpr MapKernels kKernels = vector_kernels("avx2");
  return &kKernels;
#else
  return nullptr;
#endif
}

}  // namespace sulcus
