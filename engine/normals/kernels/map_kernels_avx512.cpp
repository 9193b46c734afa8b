// Compiled for AVX-512. Leaves no inline code for others to be linked with (test
// KernelsKeepToThemselves).
#ifdef __AVX512F__
#include "engine/normals/kernels/vector_kernels.hpp"
#else
#include "engine/normals/map_kernels.hpp"
#endif

namespace sulcus {

const MapKernels* avx512_map_kernels() noexcept {
#ifdef __AVX512F__
  static constexpr MapKernels kKernels = vector_kernels("avx512");
  return &kKernels;
#else
  return nullptr;
#endif
}

}  // namespace sulcus
