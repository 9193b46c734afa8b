#include "app/session/plugin_library.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include <dlfcn.h>
#include <link.h>

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

/// Whether all that the loader maps is in the file. The loader does not check it: to read beyond
/// the end of a file that was cut short is a SIGBUS. What is no library of this system's is left to
/// it.
bool has_its_segments(const std::string& file) {
  std::error_code none;
  const std::uint64_t bytes = fs::file_size(file, none);
  std::ifstream in(file, std::ios::binary);
  ElfW(Ehdr) header{};
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header) ||
      std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 ||
      header.e_phentsize != sizeof(ElfW(Phdr))) {
    return true;
  }
  in.seekg(static_cast<std::streamoff>(header.e_phoff));
  for (unsigned n = 0; n < header.e_phnum; ++n) {
    ElfW(Phdr) segment{};
    if (!in.read(reinterpret_cast<char*>(&segment), sizeof segment)) return false;
    const bool fits = segment.p_offset <= bytes && segment.p_filesz <= bytes - segment.p_offset;
    if (segment.p_type == PT_LOAD && !fits) return false;
  }
  return true;
}

/// Whether a symbol of a library is a function.
bool is_function(void* symbol) {
  Dl_info info;
  void* found = nullptr;
  if (dladdr1(symbol, &info, &found, RTLD_DL_SYMENT) == 0 || !found) return false;
  return ELF64_ST_TYPE(static_cast<const ElfW(Sym)*>(found)->st_info) == STT_FUNC;
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
    return fs::is_regular_file(file_of(f, name), none);
  });
  if (folder == folders.end()) refuse_missing(name, folders, scene_file);
  // With a slash in it, or the loader would look in its own folders.
  const std::string file = fs::absolute(file_of(*folder, name)).string();
  if (!has_its_segments(file)) {
    throw InputError(file, "", "a library that was cut short", "a whole one");
  }
  // Never closed: see the header.
  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    const char* const why = dlerror();
    throw InputError(file, "", why ? why : "what the loader refuses",
                     "a plug-in that this system can load");
  }
  using Entry = const SulcusDevicePlugin* (*)();
  void* const entry = dlsym(library, SULCUS_DEVICE_ENTRY);
  if (!entry || !is_function(entry)) {
    throw InputError(
        file, "",
        entry ? SULCUS_DEVICE_ENTRY ", which is no function" : "no symbol " SULCUS_DEVICE_ENTRY,
        "a plug-in after sulcus_device.h");
  }
  return checked(reinterpret_cast<Entry>(entry)(), file);
}

}  // namespace sulcus
