#pragma once

// What the compiler puts before every source for AArch64 (the top CMakeLists.txt), where Eigen 3.4
// takes NEON: fixed vectors and matrices then have the bits that they have by x86-64's SSE2.
#ifdef __aarch64__
#include <arm_neon.h>

// Products and sums round one after the other. Eigen asks for fused ones by name, which
// -ffp-contract=off does not reach. arm_neon.h comes first since GCC's defines the macro again.
#undef __ARM_FEATURE_FMA

#include <Eigen/Core>

// Three floats are summed as a + (b + c). NEON has pairs of floats beside the fours that SSE has,
// by which it would be (a + b) + c: where fours do not fit, the pairs are not taken.
template <int Size>
struct Eigen::internal::find_best_packet_helper<Size, Eigen::internal::Packet4f, false> {
  using type = Eigen::internal::Packet4f;
};
#endif
