// Compiled for AVX-512, sixteen contacts at a time. Leaves no inline code for others to be linked
// with (test KernelsKeepToThemselves).
#include "haptics/contact/contact_kernels.hpp"

#ifdef __AVX512F__

#define SULCUS_LANES 16
#include "haptics/contact/contact_loops.inl"

namespace sulcus {

namespace {

constexpr ContactKernels kAvx512 = kernels_named("avx512");

}  // namespace

const ContactKernels* avx512_contact_kernels() noexcept { return &kAvx512; }

}  // namespace sulcus

#else

namespace sulcus {
const ContactKernels* avx512_contact_kernels() noexcept { return nullptr; }
}  // namespace sulcus

#endif
