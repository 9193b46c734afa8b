#pragma once

#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace sulcus::lab {

/// A number in a form of printf's.
std::string with_number(const char* form, double number);
/// The same; empty where it is not finite, as of what was not measured.
std::string number_cell(const char* form, double value);
/// A text as a cell, quoted. Double quotes in it become single ones: gnuplot knows no others.
std::string text_cell(std::string text);
/// A name of the command line as words.
std::string spaced_name(std::string name);

/// One line on a terminal that is written over; nothing in a pipe.
class ProgressLine {
 public:
  ProgressLine();
  void say(const std::string& what) const;
  void clear() const { say(""); }

 private:
  bool on_terminal_;
};

/// A table that grows line by line, so that what was measured before an interruption is there.
/// Throws std::runtime_error where it cannot be written.
class CsvFile {
 public:
  CsvFile(const std::string& path, const std::string& header);
  void write(const std::string& line);

 private:
  std::string path_;
  std::ofstream out_;
};

/// The folder of a command's results, made when there is none, and the files in it. Throws
/// InputError where it cannot be made.
class Results {
 public:
  explicit Results(std::string folder);

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  /// Path of a table, which is listed.
  std::string table(const std::string& name);
  /// PICTURE.png, drawn by charts/CHART.gp from the tables that are there, and listed where that
  /// came about; else a line says so. `subject`: the script's second argument. Whether it was
  /// drawn.
  bool draw(const std::string& chart, const std::string& picture, const std::string& subject = "");
  /// The files that were written, one a line.
  void print() const;

  const std::string& folder() const { return folder_; }

 private:
  std::string folder_;
  std::vector<std::string> files_;
};

/// A folder of a new name in that of the results, for what is none of them; goes with this object.
class TrialFolder {
 public:
  explicit TrialFolder(const Results& results);
  ~TrialFolder();
  TrialFolder(const TrialFolder&) = delete;
  TrialFolder& operator=(const TrialFolder&) = delete;

  /// Absolute.
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace sulcus::lab
