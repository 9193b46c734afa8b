#include "tools/sulcus_lab/results.hpp"

#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include <unistd.h>

#include "engine/core/error.hpp"

namespace sulcus::lab {

ProgressLine::ProgressLine() : on_terminal_(isatty(STDERR_FILENO) == 1) {}

void ProgressLine::say(const std::string& what) const {
  if (on_terminal_) std::fprintf(stderr, "\r\033[K%s", what.c_str());
}

CsvFile::CsvFile(const std::string& path, const std::string& header) : path_(path), out_(path) {
  write(header);
}

void CsvFile::write(const std::string& line) {
  out_ << line << '\n' << std::flush;
  if (!out_) throw std::runtime_error(path_ + ": cannot be written");
}

Results::Results(std::string folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) {
    throw InputError(folder_, "", "no folder that can be written", "one for the results, -o DIR");
  }
}

std::string Results::table(const std::string& name) {
  files_.push_back(folder_ + "/" + name);
  return files_.back();
}

void Results::drawn(const std::string& path, const std::string& name, bool success) {
  if (success) {
    files_.push_back(path);
  } else {
    std::fprintf(stderr, "sulcus-lab: %s was not drawn: gnuplot could not be run\n", name.c_str());
  }
}

void Results::print() const {
  for (const std::string& file : files_) std::printf("%s\n", file.c_str());
}

}  // namespace sulcus::lab
