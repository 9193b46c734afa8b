#include "app/pictures/image_sets.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "app/pictures/picture_files.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

namespace {

constexpr const char* kConventions =
    "Pixel (u, v) has its middle at (u, v), (0, 0) being the upper left one. Camera space: x "
    "right, y down, z along the optical axis. u = f X / Z + cx, v = f Y / Z + cy; cameras are in "
    "perspective, pixels square. A pixel is what its middle meets: nothing is smoothed but colour.";
constexpr double kDepthStep_mm = 0.002;  // of a PNG, which reaches 131 mm

/// Row by row, lengths in mm.
std::array<double, 16> scene_from_camera_mm(const Pinhole& pinhole) {
  std::array<double, 16> rows{};
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) {
      const double value = pinhole.world_from_camera(r, c);
      rows[static_cast<std::size_t>(4 * r + c)] = c == 3 && r < 3 ? value / kMillimetre : value;
    }
  }
  return rows;
}

std::string_view bytes_of(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

ImageSetInFile::ImageSetInFile(const std::string& file, ImageSetFacts facts)
    : facts_(std::move(facts)),
      whole_(file),
      file_(whole_, facts_.frames, facts_.width, facts_.height) {
  file_.set_text("", "format", kImageSetFormat);
  file_.set_text("", "conventions", kConventions);
  file_.set_text("", "recording", facts_.recording);
  if (facts_.kinds.labels) file_.set_labels(facts_.labels);
}

void ImageSetInFile::add(const ImageFrame& frame) {
  const std::string& in = frame.camera;
  if (!cameras_.contains(in)) {
    const Pinhole& p = frame.pinhole;
    file_.set_number(in, "f", p.focal_pixels);
    file_.set_number(in, "cx", p.centre_pixels.x());
    file_.set_number(in, "cy", p.centre_pixels.y());
    file_.set_number(in, "near_mm", p.near_m / kMillimetre);
    file_.set_number(in, "far_mm", p.far_m / kMillimetre);
    if (facts_.stereo_mm > 0.0) file_.set_number(in, "baseline_mm", facts_.stereo_mm);
  }
  Camera& camera = cameras_[in];
  for (const double value : scene_from_camera_mm(frame.pinhole)) {
    camera.scene_from_camera_mm.push_back(value);
  }
  if (times_s_.size() == frame.frame) {
    times_s_.push_back(frame.time_s);
    ticks_.push_back(static_cast<double>(frame.tick));
  }
  using Type = ImageArray::Type;
  static const ImageArray kColour{"colour", "sRGB, 8 bits", Type::kByte, 3};
  static const ImageArray kDepth{
      "depth_mm", "mm from the eye along the optical axis; 0: nothing is there", Type::kFloat, 1};
  static const ImageArray kLabels{"labels", "as in the table /labels", Type::kByte, 1};
  static const ImageArray kNormals{
      "normals", "outward unit normal in camera space; 0: nothing is there", Type::kFloat, 3};
  static const ImageArray kContact{"contact", "1: shows a voxel in contact with the burr",
                                   Type::kByte, 1};
  if (facts_.kinds.colour) file_.write(in, kColour, frame.frame, frame.colour.rgb);
  if (facts_.kinds.depth) {
    std::vector<float> depth_mm = frame.geometry.depth_m;
    for (float& depth : depth_mm) depth *= static_cast<float>(1.0 / kMillimetre);
    file_.write(in, kDepth, frame.frame, depth_mm);
  }
  if (facts_.kinds.labels) file_.write(in, kLabels, frame.frame, frame.labels);
  if (facts_.kinds.normals) {
    // To a 16384th, which packs twice as well.
    constexpr float kSteps = 16384.0f;
    std::vector<float> normals;
    normals.reserve(3 * frame.geometry.normal_camera.size());
    for (const auto& normal : frame.geometry.normal_camera) {
      for (const float part : normal) normals.push_back(std::round(part * kSteps) / kSteps);
    }
    file_.write(in, kNormals, frame.frame, normals);
  }
  if (facts_.kinds.contact) file_.write(in, kContact, frame.frame, frame.contact);
}

void ImageSetInFile::finish() {
  const std::array<std::size_t, 3> dims{times_s_.size(), 4, 4};
  file_.set_rows("", "time_s", "s, of the run", {dims.data(), 1}, times_s_);
  file_.set_rows("", "tick", "number of the tick", {dims.data(), 1}, ticks_);
  for (const auto& [name, camera] : cameras_) {
    file_.set_rows(name, "scene_from_camera_mm", "of points, mm, row by row", dims,
                   camera.scene_from_camera_mm);
  }
  file_.close();
  whole_.finish();
}

ImageSetInFolder::ImageSetInFolder(std::string folder, ImageSetFacts facts)
    : folder_(std::move(folder)), facts_(std::move(facts)) {
  list_["format"] = "sulcus-images";
  list_["recording"] = facts_.recording;
  list_["conventions"] = kConventions;
  if (facts_.kinds.depth) list_["depth_mm_per_step"] = kDepthStep_mm;
  if (facts_.kinds.depth) list_["depth"] = "along the optical axis; 0: nothing is there";
  if (facts_.kinds.normals) {
    list_["normals"] = "outward, camera space: value / 32767.5 - 1; 0, 0, 0: nothing is there";
  }
  if (facts_.kinds.contact) list_["contact"] = "255: shows a voxel in contact with the burr";
  if (facts_.stereo_mm > 0.0) list_["baseline_mm"] = facts_.stereo_mm;
  for (const ImageLabel& label : facts_.labels) {
    list_["labels"].push_back({{"label", label.label}, {"name", label.name}});
  }
  list_["pictures"] = nlohmann::json::array();
}

void ImageSetInFolder::add(const ImageFrame& frame, const std::string& name) {
  const Pinhole& p = frame.pinhole;
  const int width = static_cast<int>(facts_.width), height = static_cast<int>(facts_.height);
  nlohmann::json entry{{"camera", frame.camera},
                       {"time_s", frame.time_s},
                       {"tick", frame.tick},
                       {"f", p.focal_pixels},
                       {"cx", p.centre_pixels.x()},
                       {"cy", p.centre_pixels.y()},
                       {"near_mm", p.near_m / kMillimetre},
                       {"far_mm", p.far_m / kMillimetre},
                       {"scene_from_camera_mm", scene_from_camera_mm(p)}};
  const auto write = [&](const char* kind, const std::vector<std::uint8_t>& png) {
    const std::string file = write_beside_others(bytes_of(png), folder_, name + '_' + kind, ".png");
    entry[kind] = file.substr(file.rfind('/') + 1);
  };
  if (facts_.kinds.colour) write("colour", png_bytes(frame.colour));
  if (facts_.kinds.depth) {
    std::vector<std::uint16_t> steps;
    steps.reserve(frame.geometry.depth_m.size());
    for (const float depth_m : frame.geometry.depth_m) {
      const long step = std::lround(static_cast<double>(depth_m) / kMillimetre / kDepthStep_mm);
      if (step > 65535) {
        throw InputError(
            "", "--kind depth",
            formatted("a depth of %.4g mm", static_cast<double>(depth_m) / kMillimetre),
            "131 mm at most in a PNG, or --data");
      }
      steps.push_back(static_cast<std::uint16_t>(step));
    }
    write("depth", png_bytes(steps, width, height, 1));
  }
  if (facts_.kinds.labels) write("labels", png_bytes(frame.labels, width, height));
  if (facts_.kinds.normals) {
    std::vector<std::uint16_t> steps;
    steps.reserve(3 * frame.geometry.normal_camera.size());
    for (std::size_t i = 0; i < frame.geometry.normal_camera.size(); ++i) {
      const bool there = frame.geometry.objects[i] != 0;
      for (const float part : frame.geometry.normal_camera[i]) {
        const long step = std::lround((static_cast<double>(part) + 1.0) * 32767.5);
        steps.push_back(there ? static_cast<std::uint16_t>(std::clamp(step, 0L, 65535L))
                              : std::uint16_t{0});
      }
    }
    write("normals", png_bytes(steps, width, height, 3));
  }
  if (facts_.kinds.contact) {
    std::vector<std::uint8_t> seen = frame.contact;
    for (std::uint8_t& pixel : seen) pixel = pixel != 0 ? 255 : 0;
    write("contact", png_bytes(seen, width, height));
  }
  list_["pictures"].push_back(std::move(entry));
}

std::string ImageSetInFolder::finish() {
  return write_beside_others(list_.dump(1) + '\n', folder_, "images", ".json");
}

}  // namespace sulcus
