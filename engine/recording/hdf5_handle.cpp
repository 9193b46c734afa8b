#include "engine/recording/hdf5_handle.hpp"

#include <string_view>

namespace sulcus {

void silence_hdf5() {
  H5dont_atexit();  // counts before the library's first other call only
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

std::string hdf5_reason() {
  std::string line;
  const auto take_innermost = [](unsigned, const H5E_error2_t* entry, void* out) -> herr_t {
    auto& text = *static_cast<std::string*>(out);
    if (text.empty() && entry->desc) text = entry->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_innermost, &line);
  // The file drivers wrap strerror's text in addresses and sizes that tell nobody anything.
  constexpr std::string_view kSystem = "error message = '";
  if (const auto begin = line.find(kSystem); begin != std::string::npos) {
    line.erase(0, begin + kSystem.size());
    line.erase(line.find('\''));
  }
  for (char& c : line) {
    if (c == '\n') c = ' ';
  }
  return line.empty() ? "HDF5 gives no reason" : line;
}

Hdf5Handle hdf5_checked(hid_t id, Hdf5Handle::Close closer, const char* what) {
  hdf5_check(id < 0 ? -1 : 0, what);
  return {id, closer};
}

void hdf5_check(herr_t status, const char* what) {
  if (status < 0) throw Hdf5Error(std::string(what) + ": " + hdf5_reason());
}

}  // namespace sulcus
