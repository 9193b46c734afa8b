#include <cstddef>
#include <cstdint>

#include "tools/fuzz/fuzz_targets.hpp"

// One program for each target; the build says which.
// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  sulcus::fuzz::SULCUS_FUZZ_TARGET({data, size});
  return 0;
}
