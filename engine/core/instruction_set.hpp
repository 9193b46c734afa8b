#pragma once

namespace sulcus {

/// Whether kernels compiled for AVX2 are to run: where the processor has it, unless the environment
/// says SULCUS_INSTRUCTIONS=plain, which is for comparing. Results do not depend on it.
bool use_avx2() noexcept;

}  // namespace sulcus
