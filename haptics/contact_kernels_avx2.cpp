// Compiled for AVX2. Leaves no inline code for others to be linked with (test
// Avx2KernelsKeepToThemselves).
#include "haptics/contact_kernels.hpp"

#ifdef __AVX2__

#include "haptics/contact_loops.inl"

namespace sulcus {

namespace {

constexpr ContactKernels kAvx2{"avx2",      find_near, leaf_distances_of,
                               measure_all, turn_all,  forces_of};

}  // namespace

const ContactKernels* avx2_contact_kernels() noexcept {
  return __builtin_cpu_supports("avx2") ? &kAvx2 : nullptr;
}

}  // namespace sulcus

#else

namespace sulcus {
const ContactKernels* avx2_contact_kernels() noexcept { return nullptr; }
}  // namespace sulcus

#endif
