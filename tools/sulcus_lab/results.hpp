#pragma once

#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace sulcus::lab {

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

  /// Path of a table, which is listed.
  std::string table(const std::string& name);
  /// `draw(path)` draws a picture, which is listed; a line says so where it returns false.
  template <class Draw>
  void picture(const std::string& name, const Draw& draw) {
    const std::string path = folder_ + "/" + name;
    drawn(path, name, draw(path));
  }
  /// The files that were written, one a line.
  void print() const;

 private:
  void drawn(const std::string& path, const std::string& name, bool success);

  std::string folder_;
  std::vector<std::string> files_;
};

}  // namespace sulcus::lab
