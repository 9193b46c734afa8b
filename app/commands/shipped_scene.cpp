#include "app/commands/shipped_scene.hpp"

#include <filesystem>

#include "app/commands/program_folder.hpp"

namespace sulcus {

namespace fs = std::filesystem;

std::string scene_file_of(const std::string& given) {
  std::error_code error;
  if (fs::exists(given, error)) return given;
  const fs::path path(given);
  const fs::path folder = path.parent_path();
  const std::string kind = path.extension().string();
  if ((!folder.empty() && folder != "scenes") || (!kind.empty() && kind != ".toml")) return given;
  const fs::path program = program_folder();
  if (program.empty() || path.stem().empty()) return given;
  for (const char* data : {SULCUS_DATA, SULCUS_SOURCE}) {
    const fs::path file = (program / data / "scenes" / path.stem()).concat(".toml");
    if (fs::exists(file, error)) return file.lexically_normal().string();
  }
  return given;
}

}  // namespace sulcus
