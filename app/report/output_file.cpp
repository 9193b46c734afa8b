#include "app/report/output_file.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <system_error>

#include <unistd.h>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/core/whole_file.hpp"

namespace sulcus {
namespace {

namespace fs = std::filesystem;

/// ".stl, .obj or .ply"
std::string list_of(std::initializer_list<std::string_view> endings) {
  std::string list;
  std::size_t left = endings.size();
  for (const std::string_view ending : endings) {
    list.append(list.empty() ? "" : left == 1 ? " or " : ", ").append(ending);
    --left;
  }
  return list;
}

[[noreturn]] void refuse(const std::string& option, const std::string& folder,
                         const std::string& why) {
  throw InputError(folder, option, "no folder that can be written (" + why + ")", "one that can");
}

}  // namespace

void check_output(const std::string& option, const std::string& file,
                  std::initializer_list<std::string_view> endings) {
  if (file.empty()) return;
  const std::string name = lower_case(file);
  const auto ends = [&](std::string_view ending) { return name.ends_with(ending); };
  if (std::ranges::none_of(endings, ends)) {
    throw InputError(file, option, "another ending", list_of(endings));
  }
  check_can_be_written(file);
}

void check_outputs_differ(std::span<const OutputOption> outputs) {
  std::map<fs::path, std::string> option_of;
  for (const auto& [option, file] : outputs) {
    if (file.empty()) continue;
    std::error_code error;  // a name that cannot be followed is compared as it was given
    const fs::path whole = fs::weakly_canonical(fs::absolute(file, error), error);
    const auto [there, is_new] = option_of.emplace(error ? fs::path(file) : whole, option);
    if (!is_new) throw InputError(file, option, "the file of " + there->second, "another file");
  }
}

void check_output_folder(const std::string& option, const std::string& folder) {
  if (folder.empty()) return;
  std::error_code error;
  fs::path there = fs::absolute(folder, error).lexically_normal();
  while (!fs::exists(there, error) && there.has_relative_path()) {
    if (error && error != std::errc::no_such_file_or_directory) {
      refuse(option, folder, error.message());
    }
    there = there.parent_path();
  }
  if (!fs::is_directory(there, error)) {
    refuse(option, folder, there.string() + " is no folder");
  }
  if (::access(there.c_str(), W_OK | X_OK) != 0) {
    refuse(option, folder, std::generic_category().message(errno));
  }
}

void make_output_folder(const std::string& option, const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) return;
  if (error == std::errc::no_space_on_device) {
    throw std::runtime_error(folder + ": cannot be made: " + error.message());
  }
  refuse(option, folder, error.message());
}

}  // namespace sulcus
