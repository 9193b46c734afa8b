#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "app/pictures/image_kinds.hpp"
#include "engine/core/whole_file.hpp"

namespace sulcus {

// What pictures of several kinds are written to.

/// What is the same for all of a set.
struct ImageSetFacts {
  std::string recording;
  ImageKinds kinds;
  std::vector<ImageLabel> labels;
  double stereo_mm = 0.0;
  std::size_t frames = 0;  // times
  std::size_t width = 0, height = 0;
};

/// One file of HDF5 with all of them; what is in it, it says itself.
class ImageSetInFile {
 public:
  ImageSetInFile(const std::string& file, ImageSetFacts facts);
  void add(const ImageFrame& frame);
  void finish();

 private:
  struct Camera {
    std::vector<double> scene_from_camera_mm;
  };

  ImageSetFacts facts_;
  WholeFile whole_;
  ImageSetFile file_;
  std::vector<double> times_s_, ticks_;
  std::map<std::string, Camera> cameras_;
};

/// PNG files in a folder, and one of JSON that lists them: cameras, times, labels, units.
class ImageSetInFolder {
 public:
  ImageSetInFolder(std::string folder, ImageSetFacts facts);
  /// `name`: of its files, without kind and end. InputError where a depth does not fit into a PNG.
  void add(const ImageFrame& frame, const std::string& name);
  /// The file that lists them.
  std::string finish();

 private:
  std::string folder_;
  ImageSetFacts facts_;
  nlohmann::json list_;
};

}  // namespace sulcus
