#include "app/commands/shipped_files.hpp"

#include <filesystem>

namespace sulcus {

namespace fs = std::filesystem;

namespace {

/// Where the running program lies. Empty where the system does not say.
fs::path program_folder() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path();
}

}  // namespace

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

std::vector<std::string> plugin_folders(const std::string& given) {
  std::vector<std::string> folders;
  if (!given.empty()) folders.push_back(given);
  folders.push_back((program_folder() / SULCUS_PLUGIN_FOLDER).lexically_normal().string());
  return folders;
}

}  // namespace sulcus
