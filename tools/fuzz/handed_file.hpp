#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <unistd.h>

#include "engine/core/error.hpp"
#include "tools/fuzz/fuzz_targets.hpp"

namespace sulcus::fuzz {

/// Bytes as a file of a name, in memory where the system has a folder for that; gone with it.
class HandedFile {
 public:
  HandedFile(Bytes bytes, const std::string& name) : path_(folder() + "/" + name) {
    std::ofstream out(path_, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) throw std::runtime_error(path_ + ": cannot be written");
  }
  ~HandedFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    std::filesystem::remove(std::filesystem::path(path_).parent_path(), ignored);
  }
  HandedFile(const HandedFile&) = delete;
  HandedFile& operator=(const HandedFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  static std::string folder() {
    namespace fs = std::filesystem;
    const fs::path memory = "/dev/shm";
    std::error_code ignored;
    const fs::path base = fs::is_directory(memory, ignored) ? memory : fs::temp_directory_path();
    const fs::path own = base / ("sulcus_fuzz_" + std::to_string(getpid()));
    fs::create_directories(own);
    return own.string();
  }

  std::string path_;
};

/// A contract of the readers that was broken: of whatever type, nobody catches it.
inline void expect(bool kept, const std::string& what) {
  if (!kept) throw std::logic_error(what);
}

/// Runs `read`; false where it refused its input, which it must do in one line of a length that
/// somebody can read.
template <class Read>
bool reads(const Read& read) {
  constexpr std::size_t kLongest = 2000;
  try {
    read();
    return true;
  } catch (const InputError& error) {
    const std::string line = error.what();
    expect(line.size() < kLongest, "a message of " + std::to_string(line.size()) + " bytes");
    expect(line.find("found ") != std::string::npos && line.find(", expected ") < line.size(),
           "a message without what was found or expected: " + line);
    for (const char c : line) {
      expect(static_cast<unsigned char>(c) >= ' ', "a control character in: " + line);
    }
    return false;
  }
}

}  // namespace sulcus::fuzz
