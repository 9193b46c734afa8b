#include "app/session/plugin_library.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <system_error>

#include <dlfcn.h>

#include "engine/core/error.hpp"

namespace sulcus {

namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "sulcus_device_";
constexpr const char* kSuffix = ".so";

std::string file_of(const std::string& folder, const std::string& name) {
  return folder + "/" + kPrefix + name + kSuffix;
}

/// Names of the plug-ins that the folders have, in order.
std::vector<std::string> names_in(const std::vector<std::string>& folders) {
  std::vector<std::string> names;
  for (const std::string& folder : folders) {
    std::error_code none;
    for (fs::directory_iterator entry(folder, none), end; !none && entry != end;
         entry.increment(none)) {
      const std::string file = entry->path().filename().string();
      if (!file.starts_with(kPrefix) || !file.ends_with(kSuffix)) continue;
      const std::size_t from = std::string(kPrefix).size();
      names.push_back(file.substr(from, file.size() - from - std::string(kSuffix).size()));
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::string joined(const std::vector<std::string>& parts, const std::string& between) {
  std::string text;
  for (const std::string& part : parts) {
    if (!text.empty()) text += between;
    text += part;
  }
  return text;
}

[[noreturn]] void refuse_missing(const std::string& name, const std::vector<std::string>& folders,
                                 const std::string& scene_file) {
  std::vector<std::string> files;
  files.reserve(folders.size());
  for (const std::string& folder : folders) files.push_back(file_of(folder, name));
  const std::vector<std::string> known = names_in(folders);
  const std::string there =
      known.empty() ? "a plug-in there; those folders have none" : "one of " + joined(known, ", ");
  throw InputError(scene_file, "device.plugin", "no " + joined(files, " and no "),
                   there + "; --plugins DIR names another folder");
}

/// What stands at the entry, checked to be usable.
const SulcusDevicePlugin& checked(const SulcusDevicePlugin* plugin, const std::string& file) {
  const std::string wanted = "version 1 to " + std::to_string(SULCUS_DEVICE_VERSION) +
                             " of the interface, the last as in this program's sulcus_device.h";
  if (!plugin) throw InputError(file, SULCUS_DEVICE_ENTRY, "no plug-in at its entry", wanted);
  // Nothing else may be read of another version.
  if (plugin->version < 1 || plugin->version > SULCUS_DEVICE_VERSION) {
    throw InputError(file, SULCUS_DEVICE_ENTRY, "version " + std::to_string(plugin->version),
                     wanted);
  }
  const std::size_t least =
      plugin->version == 1 ? offsetof(SulcusDevicePlugin, controls) : sizeof(SulcusDevicePlugin);
  if (plugin->struct_size < least) {
    throw InputError(file, SULCUS_DEVICE_ENTRY,
                     "a structure of " + std::to_string(plugin->struct_size) + " bytes",
                     std::to_string(least) + " bytes or more");
  }
  if (!plugin->open || !plugin->read || !plugin->write || !plugin->message || !plugin->close) {
    throw InputError(file, SULCUS_DEVICE_ENTRY, "a function that is missing",
                     "open, read, write, message and close");
  }
  return *plugin;
}

}  // namespace

const SulcusDevicePlugin& load_plugin(const std::string& name,
                                      const std::vector<std::string>& folders,
                                      const std::string& scene_file) {
  const auto folder = std::find_if(folders.begin(), folders.end(), [&](const std::string& f) {
    std::error_code none;
    return fs::exists(file_of(f, name), none);
  });
  if (folder == folders.end()) refuse_missing(name, folders, scene_file);
  // With a slash in it, or the loader would look in its own folders.
  const std::string file = fs::absolute(file_of(*folder, name)).string();
  // Never closed: see the header.
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    const char* const why = dlerror();
    throw InputError(file, "", why ? why : "what the loader refuses",
                     "a plug-in that this system can load");
  }
  using Entry = const SulcusDevicePlugin* (*)();
  const auto entry = reinterpret_cast<Entry>(dlsym(library, SULCUS_DEVICE_ENTRY));
  if (!entry) {
    throw InputError(file, "", "no symbol " SULCUS_DEVICE_ENTRY, "a plug-in after sulcus_device.h");
  }
  return checked(entry(), file);
}

}  // namespace sulcus
