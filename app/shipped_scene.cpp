#include "app/shipped_scene.hpp"

#include <filesystem>

namespace sulcus {

namespace fs = std::filesystem;

std::string scene_file_of(const std::string& given) {
  std::error_code error;
  if (fs::exists(given, error)) return given;
  const fs::path path(given);
  const fs::path folder = path.parent_path();
  const std::string kind = path.extension().string();
  if ((!folder.empty() && folder != "scenes") || (!kind.empty() && kind != ".toml")) return given;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error || path.stem().empty()) return given;
  for (const char* data : {SULCUS_DATA, SULCUS_SOURCE}) {
    const fs::path file = (program.parent_path() / data / "scenes" / path.stem()).concat(".toml");
    if (fs::exists(file, error)) return file.lexically_normal().string();
  }
  return given;
}

}  // namespace sulcus
