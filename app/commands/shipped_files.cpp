#include "app/commands/shipped_files.hpp"

#include <algorithm>
#include <filesystem>

#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/file_kind.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus {

namespace fs = std::filesystem;

namespace {

/// Where the running program lies. Empty where the system does not say.
fs::path program_folder() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path();
}

/// The scenes' folders beside the program, installed or built.
std::vector<fs::path> scene_folders() {
  std::vector<fs::path> folders;
  const fs::path program = program_folder();
  if (program.empty()) return folders;
  for (const char* data : {SULCUS_DATA, SULCUS_SOURCE}) {
    folders.push_back((program / data / "scenes").lexically_normal());
  }
  return folders;
}

/// The files of those that came with the program, by name.
std::vector<fs::path> shipped_scenes() {
  std::vector<fs::path> files;
  for (const fs::path& folder : scene_folders()) {
    std::error_code none;
    for (fs::directory_iterator entry(folder, none), end; !none && entry != end;
         entry.increment(none)) {
      if (entry->path().extension() == ".toml") files.push_back(entry->path());
    }
    if (!files.empty()) break;  // those of one tree
  }
  std::ranges::sort(files);
  return files;
}

/// What takes a file that is no scene; empty where it may be one.
std::string what_takes(const std::string& file) {
  if (is_recording_file(file)) {
    return "a scene, .toml; sulcus replay, render or view takes a recording";
  }
  if (!is_mesh_file(file) && !is_volume_file(file)) return {};
  return "a scene, .toml; sulcus inspect says with which command it is cut";
}

}  // namespace

std::string scene_file_of(const std::string& given) {
  std::error_code error;
  if (fs::exists(given, error)) return given;
  const fs::path path(given);
  const fs::path folder = path.parent_path();
  const std::string kind = path.extension().string();
  if ((!folder.empty() && folder != "scenes") || (!kind.empty() && kind != ".toml")) return given;
  if (path.stem().empty()) return given;
  for (const fs::path& scenes : scene_folders()) {
    const fs::path file = (scenes / path.stem()).concat(".toml");
    if (fs::exists(file, error)) return file.lexically_normal().string();
  }
  return given;
}

std::string scene_to_run(const std::string& given) {
  const std::string file = scene_file_of(given);
  std::error_code error;
  if (!fs::exists(file, error)) {
    std::string expected = "a scene, .toml";
    const std::vector<fs::path> scenes = shipped_scenes();
    if (!scenes.empty()) expected.append(", or the name of a shipped one:");
    for (const fs::path& scene : scenes) expected.append(" ").append(scene.stem().string());
    throw InputError(file, "", "no such file", expected);
  }
  if (const std::string taker = what_takes(file); !taker.empty()) {
    throw InputError(file, "", is_recording_file(file) ? "a recording" : "a mesh or a volume",
                     taker);
  }
  return file;
}

std::string shipped_scene_help() {
  std::string text = "Scenes that came with the program, each to be run by its name:\n\n";
  for (const fs::path& scene : shipped_scenes()) {
    text += formatted("  %-20s %s\n", scene.stem().string().c_str(),
                      load_scene(scene.string()).title.c_str());
  }
  return text + "\n'sulcus run NAME' runs one, 'sulcus inspect NAME' says what it holds.\n";
}

std::string recording_file_of(const std::string& given) {
  std::error_code error;
  const fs::path inside = fs::path(given) / "recording.h5";
  return fs::is_directory(given, error) && fs::exists(inside, error) ? inside.string() : given;
}

std::vector<std::string> plugin_folders(const std::string& given) {
  std::vector<std::string> folders;
  if (!given.empty()) folders.push_back(given);
  std::error_code error;
  const fs::path built = program_folder() / "plugins";
  if (fs::is_directory(built, error)) folders.push_back(built.string());
  folders.push_back((program_folder() / SULCUS_PLUGIN_FOLDER).lexically_normal().string());
  return folders;
}

}  // namespace sulcus
