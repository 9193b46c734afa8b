// Compiled for AVX-512. Leaves no inline code for others to be linked with (test
// KernelsKeepToThemselves).
#include "engine/normals/map_kernels.hpp"

#ifdef __AVX512F__

#include "engine/normals/map_kernels_vector.inl"

namespace sulcus {

namespace {

constexpr MapKernels kAvx512 = vector_kernels("avx512");

}  // namespace

const MapKernels* avx512_map_kernels() noexcept { return &kAvx512; }

}  // namespace sulcus

#else

namespace sulcus {
const MapKernels* avx512_map_kernels() noexcept { return nullptr; }
}  // namespace sulcus

#endif
