#pragma once

#include <filesystem>

namespace sulcus {

/// Where the running program lies: what came with it is found from there, so that the whole may be
/// moved. Empty where the system does not tell.
inline std::filesystem::path program_folder() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
}

}  // namespace sulcus
