#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/file_kind.hpp"
#include "engine/import/volumes/dicom_data_set.hpp"
#include "engine/import/volumes/dicom_frames.hpp"
#include "engine/import/volumes/slice_order.hpp"
#include "engine/import/volumes/volume_checks.hpp"
#include "engine/import/volumes/volume_readers.hpp"

namespace sulcus {
namespace {

namespace fs = std::filesystem;

constexpr double kUnit_m = 1e-3;  // DICOM's lengths are mm

std::string text_of(double value) {
  std::ostringstream text;
  text.precision(7);
  text << value;
  return text.str();
}

std::string name_of(const DicomFrame& frame, std::span<const std::string> files, bool many_frames) {
  const std::string name = fs::path(files[frame.file]).filename().string();
  return many_frames ? name + " frame " + std::to_string(frame.index + 1) : name;
}

/// A line through the places of frames, in even steps.
struct Row {
  Eigen::Vector3d first_mm, step_mm;

  double furthest_mm(const std::vector<DicomFrame>& frames) const {
    double most = 0.0;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const Eigen::Vector3d p = first_mm + static_cast<double>(f) * step_mm;
      most = std::max(most, (*frames[f].position_mm - p).norm());
    }
    return most;
  }
};

Row row_through_ends(const std::vector<DicomFrame>& frames) {
  const Eigen::Vector3d first = *frames.front().position_mm;
  return {first, (*frames.back().position_mm - first) / static_cast<double>(frames.size() - 1)};
}

/// Of the least squares, for places whose digits were rounded.
Row row_between(const std::vector<DicomFrame>& frames) {
  const double middle = 0.5 * static_cast<double>(frames.size() - 1);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), sum = Eigen::Vector3d::Zero();
  double squares = 0.0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const double along = static_cast<double>(f) - middle;
    mean += *frames[f].position_mm / static_cast<double>(frames.size());
    sum += along * *frames[f].position_mm;
    squares += along * along;
  }
  const Eigen::Vector3d step = sum / squares;
  return {mean - middle * step, step};
}

/// Puts frames in the order of their places, in which they lie in even steps; none where there is
/// but one.
std::optional<Row> order_by_place(const std::string& name, std::span<const std::string> files,
                                  const Eigen::Vector3d& normal, bool many_frames,
                                  std::vector<DicomFrame>& frames) {
  const auto height = [&](const DicomFrame& frame) { return normal.dot(*frame.position_mm); };
  std::ranges::stable_sort(frames, {}, height);
  if (frames.size() < 2) return std::nullopt;
  std::vector<double> steps;
  for (std::size_t f = 0; f + 1 < frames.size(); ++f) {
    steps.push_back(height(frames[f + 1]) - height(frames[f]));
  }
  std::vector<double> sorted = steps;
  std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2));
  const double usual = sorted[sorted.size() / 2];
  const auto between = [&](std::size_t f) {
    return name_of(frames[f], files, many_frames) + " and " +
           name_of(frames[f + 1], files, many_frames);
  };
  constexpr double kSamePlace_mm = 1e-4;
  for (std::size_t f = 0; f < steps.size(); ++f) {
    if (steps[f] > kSamePlace_mm) continue;
    throw InputError(name, kDicomPosition, between(f) + " at one place", "a place for each slice");
  }
  // What the digits of the positions leave open is neither shear nor an uneven step.
  constexpr double kDigits_mm = 0.005, kMostOff_mm = 0.06, kOff = 0.1;
  Row row = row_through_ends(frames);
  if (row.furthest_mm(frames) > kDigits_mm) row = row_between(frames);
  const Eigen::Vector3d straight = normal * normal.dot(row.step_mm);
  const auto last = static_cast<double>(steps.size());
  if ((row.step_mm - straight).norm() * last < kDigits_mm) row.step_mm = straight;
  const double allowed_mm = std::min(kMostOff_mm, kOff * usual);
  if (row.furthest_mm(frames) <= std::max(allowed_mm, 2.0 * kSamePlace_mm)) return row;

  constexpr double kUneven = 0.25;  // more than what is rounded, and less than half a slice
  for (std::size_t f = 0; f < steps.size(); ++f) {
    if (std::abs(steps[f] - usual) <= kUneven * usual) continue;
    const double absent = std::round(steps[f] / usual) - 1.0;
    const bool gap =
        absent >= 1.0 && std::abs(steps[f] - (absent + 1.0) * usual) <= kUneven * usual;
    std::string expected = text_of(usual) + " mm as between the others";
    if (gap) {
      expected +=
          ": " + text_of(absent) + (absent == 1.0 ? " slice is" : " slices are") + " absent";
    }
    throw InputError(name, kDicomPosition,
                     text_of(steps[f]) + " mm between " + between(f) + ", at " +
                         text_of(height(frames[f])) + " and " + text_of(height(frames[f + 1])) +
                         " mm along the normal",
                     expected);
  }
  const Row ends = row_between(frames);
  const auto off = [&](std::size_t f) {
    return (ends.first_mm + static_cast<double>(f) * ends.step_mm - *frames[f].position_mm).norm();
  };
  std::size_t worst = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) worst = off(f) > off(worst) ? f : worst;
  throw InputError(name, kDicomPosition,
                   name_of(frames[worst], files, many_frames) + " " + text_of(off(worst)) +
                       " mm beside the even row of the others",
                   "slices in a straight row of even steps");
}

void order_by_number(const std::string& name, std::span<const std::string> files,
                     std::vector<DicomFrame>& frames, std::vector<std::string>& warnings) {
  const bool one_file =
      std::ranges::all_of(frames, [&](const DicomFrame& f) { return f.file == frames[0].file; });
  if (one_file) return;
  std::ranges::stable_sort(frames, {}, [](const DicomFrame& f) { return f.instance; });
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (!std::isnan(frames[f].instance) &&
        (f == 0 || frames[f].instance > frames[f - 1].instance)) {
      continue;
    }
    throw InputError(name, "InstanceNumber",
                     name_of(frames[f], files, false) + " without one of its own",
                     "one for each slice, where no position puts them in order");
  }
  std::vector<SliceNumber> numbers;
  numbers.reserve(frames.size());
  for (const DicomFrame& frame : frames) {
    numbers.push_back({frame.instance, text_of(frame.instance), name_of(frame, files, false)});
  }
  warn_of_gaps(numbers, warnings);
}

/// Where the frames lie, in the order that they then have.
void place(const std::string& name, std::span<const std::string> files, const DicomFrames& first,
           std::vector<DicomFrame>& frames, MedicalVolume& volume) {
  const bool many_frames = first.form.frames > 1;
  const DicomPlane& plane = first.plane;
  const bool placed =
      std::ranges::all_of(frames, [](const DicomFrame& f) { return f.position_mm.has_value(); });
  const auto some_placed =
      std::ranges::find_if(frames, [](const DicomFrame& f) { return f.position_mm.has_value(); });
  if (!placed && some_placed != frames.end()) {
    const auto without = std::ranges::find_if(
        frames, [](const DicomFrame& f) { return !f.position_mm.has_value(); });
    throw InputError(name, kDicomPosition, "none in " + name_of(*without, files, many_frames),
                     "one for each slice, as others have");
  }
  if (placed && !plane.orientation) {
    throw InputError(files[frames.front().file], kDicomOrientation,
                     "none beside ImagePositionPatient", "how the slices are turned");
  }
  Eigen::Matrix3d steps = Eigen::Matrix3d::Identity();
  if (plane.orientation) {
    steps.col(0) = plane.orientation->head<3>();
    steps.col(1) = plane.orientation->tail<3>();
    steps.col(2) = plane.normal();
  } else {
    volume.warnings.emplace_back(
        "ImageOrientationPatient is not said: rows and columns are taken as left and posterior");
  }
  // Of files of one frame each it says nothing where they are not placed: which is the next?
  std::optional<double> between_mm;
  if (placed || many_frames) between_mm = first.between_mm;
  if (placed) {
    volume.origin_m = *frames.front().position_mm * kUnit_m;
    if (const auto row = order_by_place(name, files, steps.col(2), many_frames, frames)) {
      volume.origin_m = row->first_mm * kUnit_m;
      const double along = steps.col(2).dot(row->step_mm);
      constexpr double kSame = 0.05;
      if (between_mm && std::abs(*between_mm - along) > kSame * along) {
        volume.warnings.push_back("SpacingBetweenSlices says " + text_of(*between_mm) +
                                  " mm where the slices lie " + text_of(along) +
                                  " mm apart, which is taken");
      }
      between_mm = row->step_mm.norm();
      steps.col(2) = row->step_mm.normalized();
    }
  } else {
    order_by_number(name, files, frames, volume.warnings);
    if (frames.size() > 1) {
      volume.warnings.push_back(std::string("ImagePositionPatient is not said: slices go by ") +
                                (many_frames ? "the order of frames" : "InstanceNumber"));
    }
  }
  volume.spacing_known = plane.spacing_mm && between_mm;
  const Eigen::Vector2d across = plane.spacing_mm.value_or(Eigen::Vector2d::Ones());
  const Eigen::Vector3d spacing(across[1], across[0], between_mm.value_or(1.0));
  check_spacing(name, kDicomBetweenSlices, spacing[2]);
  volume.spacing_m = spacing * kUnit_m;
  volume.direction = steps;
}

}  // namespace

MedicalVolume read_dicom_volume(const std::string& name, std::span<const std::string> files,
                                const InputLimits& limits) {
  std::vector<DicomFrame> frames;
  std::optional<DicomFrames> first;
  std::vector<DicomPixelForm> forms(files.size());
  std::vector<std::string> series;
  MedicalVolume volume;
  volume.file = name;
  for (std::size_t f = 0; f < files.size(); ++f) {
    std::optional<DicomFrames> read = read_dicom_frames(files[f], f, limits);
    if (!read) {
      volume.warnings.push_back(fs::path(files[f]).filename().string() +
                                " holds no pixels, and is left out");
      continue;
    }
    const DicomFrames& slices = *read;
    if (!first) first = slices;
    if (std::ranges::find(series, slices.series) == series.end()) series.push_back(slices.series);
    if (slices.form.columns != first->form.columns || slices.form.rows != first->form.rows) {
      if (series.size() > 1) continue;  // which says more
      throw InputError(files[f], "Rows", "slices of another size", "that of the first");
    }
    if (series.size() == 1) check_dicom_plane(files[f], slices.plane, first->plane);
    frames.insert(frames.end(), slices.frames.begin(), slices.frames.end());
    forms[f] = slices.form;
    const std::array<std::int64_t, 3> sizes{first->form.columns, first->form.rows,
                                            static_cast<std::int64_t>(frames.size())};
    checked_voxel_count(name, "sizes", sizes, limits);
  }
  if (series.size() > 1) {
    throw InputError(name, "SeriesInstanceUID", std::to_string(series.size()) + " DICOM series",
                     "one: a folder for each");
  }
  if (!first) throw InputError(name, "PixelData", "no file that holds pixels", "slices");
  place(name, files, *first, frames, volume);
  const std::array<std::int64_t, 3> sizes{first->form.columns, first->form.rows,
                                          static_cast<std::int64_t>(frames.size())};
  set_sizes(volume, sizes);

  // File by file, each frame to its slice.
  std::vector<std::vector<std::size_t>> slices_of_file(files.size());
  for (std::size_t k = 0; k < frames.size(); ++k) slices_of_file[frames[k].file].push_back(k);
  const std::size_t pixels = first->form.pixels();
  for (std::size_t f = 0; f < files.size(); ++f) {
    if (slices_of_file[f].empty()) continue;
    const DicomFile file = read_dicom_file(files[f], limits.memory_bytes);
    const DicomPixelForm form = dicom_pixel_form(file);
    if (form.pixels() != pixels || form.frames != forms[f].frames) {
      throw InputError(files[f], "", "a slice that changed", "a whole DICOM file");
    }
    for (const std::size_t k : slices_of_file[f]) {
      const std::span<float> slice = std::span(volume.values).subspan(k * pixels, pixels);
      read_dicom_frame(file, form, frames[k].index, slice);
      rescale(slice, frames[k].slope, frames[k].intercept);
    }
  }
  return volume;
}

DicomSlices dicom_slices(std::span<const std::string> files) {
  DicomSlices slices;
  std::vector<std::string> others;
  for (const std::string& file : files) (is_dicom(file) ? slices.files : others).push_back(file);
  for (const std::string& file : others) {
    const std::string name = lower_extension(file);
    if (name == ".dcm" || name == ".dicom") {
      throw InputError(file, "header", "contents that cannot be one", "a DICOM slice");
    }
    const bool as_slices_are = std::ranges::any_of(
        slices.files, [&](const std::string& slice) { return lower_extension(slice) == name; });
    if (!as_slices_are) continue;
    slices.warnings.push_back(fs::path(file).filename().string() +
                              " is no DICOM file, and is left out");
  }
  return slices;
}

}  // namespace sulcus
