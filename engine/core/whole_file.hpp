#pragma once

#include <string>
#include <string_view>

namespace sulcus {

/// The one way in which a file is written: beside its name, checked, then renamed, so that who
/// looks finds the whole file, or what was there before, or nothing: when the disk is full, when
/// the process is stopped (engine/core/stop.hpp), when an exception passes.
class WholeFile {
 public:
  /// Nothing is made yet; `path` may name a file that is there, which finish() replaces.
  /// @throws InputError where its folder is not there, `path` is no regular file, or no file can be
  /// made there: bad use, known before any work. std::runtime_error where the disk is full.
  explicit WholeFile(std::string path);
  /// Removes what was not finished.
  ~WholeFile();
  WholeFile(WholeFile&& other) noexcept;
  WholeFile& operator=(WholeFile&&) = delete;

  /// Where the file is to be written: in the same folder, with the same end (.nii.gz).
  const std::string& beside() const { return beside_; }
  /// Puts bytes there, once; for those who do not write to beside() themselves.
  /// @throws std::runtime_error where they cannot all be written (a full disk).
  void write(std::string_view bytes);
  /// Gives the file its name, once it is on the disk. Who wrote to beside() has seen that all of it
  /// is there. @throws std::runtime_error.
  void finish();
  /// For those who wrote to beside() and see that not all of it is there. @throws
  /// std::runtime_error with the reason that the system gives for not writing more, else with
  /// `otherwise`.
  [[noreturn]] void fail_incomplete(const std::string& otherwise = "it is not whole") const;

  const std::string& path() const { return path_; }

 private:
  std::string path_, beside_;  // beside_ is empty once finished
};

/// A whole file of these bytes. @throws as WholeFile.
void write_whole_file(const std::string& path, std::string_view bytes);

/// Before the work that leads to a file: whether it could be written. Nothing stays of it.
/// @throws as WholeFile.
void check_can_be_written(const std::string& path);

}  // namespace sulcus
