// Compiled for AVX2. Leaves no inline code for others to be linked with (test
// KernelsKeepToThemselves).
#include "engine/normals/map_kernels.hpp"

#ifdef __AVX2__

#include "engine/normals/map_kernels_vector.inl"

namespace sulcus {

namespace {

constexpr MapKernels kAvx2 = vector_kernels("avx2");

}  // namespace

const MapKernels* avx2_map_kernels() noexcept { return &kAvx2; }

}  // namespace sulcus

#else

namespace sulcus {
const MapKernels* avx2_map_kernels() noexcept { return nullptr; }
}  // namespace sulcus

#endif
