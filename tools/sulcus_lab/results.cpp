#include "tools/sulcus_lab/results.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "app/report/gnuplot.hpp"
#include "engine/core/error.hpp"
#include "engine/core/user_text.hpp"

namespace sulcus::lab {

std::string with_number(const char* form, double number) {
  char text[128];
  std::snprintf(text, sizeof text, form, number);
  return text;
}

std::string number_cell(const char* form, double value) {
  return std::isfinite(value) ? with_number(form, value) : "";
}

std::string text_cell(std::string text) {
  std::replace(text.begin(), text.end(), '"', '\'');
  return '"' + for_terminal(text) + '"';
}

std::string spaced_name(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

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

bool Results::draw(const std::string& chart, const std::string& picture,
                   const std::string& subject) {
  const std::string file = folder_ + "/" + picture + ".png";
  const bool drawn = draw_with_gnuplot(file, SULCUS_LAB_CHARTS "/" + chart + ".gp",
                                       {std::filesystem::absolute(folder_).string(), subject});
  if (drawn) {
    files_.push_back(file);
  } else {
    std::fprintf(stderr, "sulcus-lab: %s.png was not drawn: gnuplot could not be run\n",
                 picture.c_str());
  }
  return drawn;
}

void Results::print() const {
  for (const std::string& file : files_) std::printf("%s\n", file.c_str());
}

TrialFolder::TrialFolder(const Results& results)
    : path_(std::filesystem::absolute(results.folder()) / "trial_XXXXXX") {
  if (!::mkdtemp(path_.data())) {
    throw std::runtime_error(results.folder() + ": no folder can be made in it");
  }
}

TrialFolder::~TrialFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace sulcus::lab
