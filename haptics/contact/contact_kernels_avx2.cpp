// Compiled for AVX2. Leaves no inline code for others to be linked with (test
// KernelsKeepToThemselves).
#include "haptics/contact/contact_kernels.hpp"

#ifdef __AVX2__

#include "haptics/contact/contact_loops.inl"

namespace sulcus {

namespace {

constexpr ContactKernels kAvx2 = kernels_named("avx2");

}  // namespace

const ContactKernels* avx2_contact_kernels() noexcept { return &kAvx2; }

}  // namespace sulcus

#else

namespace sulcus {
const ContactKernels* avx2_contact_kernels() noexcept { return nullptr; }
}  // namespace sulcus

#endif
