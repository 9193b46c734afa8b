#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/core/whole_file.hpp"

namespace sulcus {

/// The "format" of an ImageSetFile.
inline constexpr const char* kImageSetFormat = "sulcus-images";

/// Pictures of a kind in an ImageSetFile.
struct ImageArray {
  enum class Type : std::uint8_t { kByte, kFloat };
  std::string name, what;  // what: units, and what stands where there is nothing
  Type type = Type::kByte;
  std::size_t channels = 1;
};

/// A label of pictures, and what has it.
struct ImageLabel {
  std::uint8_t label = 0;
  std::string name;  // at most 63 bytes of it are kept
};

/// Pictures of equal size as a file of HDF5, for who learns from them: of each camera a group, in
/// that each kind an array of frames x height x width (x channels), packed by gzip frame by frame.
/// Used by one thread. What goes wrong is a std::runtime_error that names the file.
class ImageSetFile {
 public:
  /// Makes it beside the name of `whole`, which outlives this and is finished after close().
  ImageSetFile(const WholeFile& whole, std::size_t frames, std::size_t width, std::size_t height);
  ~ImageSetFile();
  ImageSetFile(const ImageSetFile&) = delete;
  ImageSetFile& operator=(const ImageSetFile&) = delete;

  // Of a group, "" the root; it is made where it is not there yet.
  void set_text(const std::string& group, const char* name, const std::string& text);
  void set_number(const std::string& group, const char* name, double value);
  /// Rows of numbers; `dims`: rows first, together as many as there are values.
  void set_rows(const std::string& group, const char* name, const std::string& what,
                std::span<const std::size_t> dims, std::span<const double> values);
  /// The table /labels: label, name.
  void set_labels(std::span<const ImageLabel> labels);
  /// A frame of a kind: height x width x channels, rows from the top.
  void write(const std::string& group, const ImageArray& array, std::size_t frame,
             std::span<const std::uint8_t> bytes);
  void write(const std::string& group, const ImageArray& array, std::size_t frame,
             std::span<const float> numbers);
  /// Once, at the end: all of it is in the file then.
  void close();

 private:
  struct File;
  void write_frame(const std::string& group, const ImageArray& array, std::size_t frame,
                   std::size_t values, const void* data);

  std::unique_ptr<File> file_;
};

/// Whether a file is of HDF5 and no ImageSetFile, as recordings are: pictures may not replace it.
bool is_other_hdf5_file(const std::string& path);

}  // namespace sulcus
