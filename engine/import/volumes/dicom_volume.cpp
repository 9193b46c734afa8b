#include "engine/import/volumes/dicom_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/import/volumes/dicom_data_set.hpp"
#include "engine/import/volumes/dicom_pixels.hpp"
#include "engine/import/volumes/text_header.hpp"
#include "engine/import/volumes/volume_checks.hpp"

namespace sulcus {
namespace {

namespace fs = std::filesystem;

constexpr double kUnit_m = 1e-3;  // DICOM's lengths are mm
constexpr DicomTag kShared = dicom_tag(0x5200, 0x9229), kPerFrame = dicom_tag(0x5200, 0x9230);
constexpr DicomTag kPlanePosition = dicom_tag(0x0020, 0x9113),
                   kPlaneOrientation = dicom_tag(0x0020, 0x9116),
                   kPixelMeasures = dicom_tag(0x0028, 0x9110),
                   kValueTransformation = dicom_tag(0x0028, 0x9145);

/// Where a number of DICOM is said, and what it is called.
struct Attribute {
  DicomTag group;  // the sequence that holds it in enhanced files
  DicomTag tag;
  const char* name;
  std::size_t count;
};
constexpr Attribute kPosition{kPlanePosition, dicom_tag(0x20, 0x32), "ImagePositionPatient", 3},
    kOrientation{kPlaneOrientation, dicom_tag(0x20, 0x37), "ImageOrientationPatient", 6},
    kPixelSpacing{kPixelMeasures, dicom_tag(0x28, 0x30), "PixelSpacing", 2},
    kBetweenSlices{kPixelMeasures, dicom_tag(0x18, 0x88), "SpacingBetweenSlices", 1},
    kIntercept{kValueTransformation, dicom_tag(0x28, 0x1052), "RescaleIntercept", 1},
    kSlope{kValueTransformation, dicom_tag(0x28, 0x1053), "RescaleSlope", 1};

/// A picture of a file, and where it lies.
struct Frame {
  std::size_t file = 0;
  std::uint32_t index = 0;  // in its file
  std::optional<Eigen::Vector3d> position_mm;
  double slope = 1.0, intercept = 0.0;
  double instance = 0.0;
};

/// What must be the same of all frames.
struct Plane {
  std::optional<Eigen::Matrix<double, 6, 1>> orientation;
  std::optional<Eigen::Vector2d> spacing_mm;  // between rows, between columns
};

/// Of one file.
struct Slices {
  std::vector<Frame> frames;
  DicomPixelForm form;
  Plane plane;
  std::string series;
  std::optional<double> between_mm;  // SpacingBetweenSlices
  bool spread_out = false;           // places that follow from one, not each frame's own
};

std::string text_of(double value) {
  std::ostringstream text;
  text.precision(7);
  text << value;
  return text.str();
}

/// Numbers of an attribute that a data set has. @throws InputError: something else in it.
std::vector<double> numbers_in(const std::string& path, const DicomDataSet& data,
                               const Attribute& attribute) {
  const DicomElement* element = data.find(attribute.tag);
  if (!element || element->value.empty()) return {};
  const std::vector<double> numbers = data.decimals(attribute.tag);
  const bool fine = numbers.size() == attribute.count && std::ranges::all_of(numbers, [](double n) {
                      return std::isfinite(n) && std::abs(n) < 1e9;
                    });
  if (!fine) {
    throw InputError(path, attribute.name, "\"" + data.text(attribute.tag) + "\"",
                     std::to_string(attribute.count) + " finite numbers");
  }
  return numbers;
}

/// Of frame `index`: its own, else that of all frames, else of the file. Empty: not said.
/// `own`: set where it is the frame's own.
std::vector<double> numbers_of(const DicomFile& file, std::uint32_t index,
                               const Attribute& attribute, bool* own = nullptr) {
  const auto in_group = [&](const DicomDataSet* frame) -> std::vector<double> {
    const DicomDataSet* group = frame ? frame->item(attribute.group) : nullptr;
    return group ? numbers_in(file.path, *group, attribute) : std::vector<double>{};
  };
  std::vector<double> numbers = in_group(file.data.item(kPerFrame, index));
  if (own) *own = !numbers.empty();
  if (numbers.empty()) numbers = in_group(file.data.item(kShared));
  if (numbers.empty()) numbers = numbers_in(file.path, file.data, attribute);
  return numbers;
}

Plane plane_of(const DicomFile& file, std::uint32_t index) {
  Plane plane;
  if (const auto n = numbers_of(file, index, kOrientation); !n.empty()) {
    Eigen::Vector3d row(n[0], n[1], n[2]), column(n[3], n[4], n[5]);
    constexpr double kRounding = 0.01;  // of direction cosines with few digits
    if (std::abs(row.norm() - 1.0) > kRounding || std::abs(column.norm() - 1.0) > kRounding ||
        std::abs(row.dot(column)) > kRounding) {
      std::ostringstream found;
      found << row.transpose() << ", " << column.transpose();
      throw InputError(file.path, kOrientation.name, found.str(),
                       "two unit vectors at a right angle");
    }
    row.normalize();
    column = (column - row * row.dot(column)).normalized();
    plane.orientation.emplace() << row, column;
  }
  if (const auto n = numbers_of(file, index, kPixelSpacing); !n.empty()) {
    for (const double length : n) check_spacing(file.path, kPixelSpacing.name, length);
    plane.spacing_mm = Eigen::Vector2d(n[0], n[1]);
  }
  return plane;
}

/// Refuses a frame that is not in the plane of the first.
void check_plane(const std::string& path, const Plane& plane, const Plane& first) {
  constexpr double kTurned = 1e-3, kStretched = 1e-4;
  if (plane.orientation.has_value() != first.orientation.has_value() ||
      (first.orientation && (*plane.orientation - *first.orientation).norm() > kTurned)) {
    throw InputError(path, kOrientation.name, "another than of the first frame",
                     "frames that are parallel");
  }
  if (plane.spacing_mm.has_value() != first.spacing_mm.has_value() ||
      (first.spacing_mm &&
       (*plane.spacing_mm - *first.spacing_mm).norm() > kStretched * first.spacing_mm->norm())) {
    throw InputError(path, kPixelSpacing.name, "another than of the first frame",
                     "frames that are alike");
  }
}

Eigen::Vector3d normal_of(const Plane& plane) {
  return plane.orientation->head<3>().cross(plane.orientation->tail<3>());
}

/// Places of frames that share one, where the file says how far they lie apart.
void spread(const DicomFile& file, Slices& slices) {
  constexpr Attribute kOffsets{0, dicom_tag(0x3004, 0x0c), "GridFrameOffsetVector", 0};
  std::vector<double> offsets = file.data.decimals(kOffsets.tag);
  if (!offsets.empty() && offsets.size() != slices.frames.size()) {
    throw InputError(file.path, kOffsets.name, std::to_string(offsets.size()) + " numbers",
                     std::to_string(slices.frames.size()) + ", one for each frame");
  }
  if (offsets.empty()) {
    const auto between = numbers_of(file, 0, kBetweenSlices);
    if (between.empty()) return;
    for (std::size_t f = 0; f < slices.frames.size(); ++f) {
      offsets.push_back(static_cast<double>(f) * between[0]);
    }
  }
  if (!slices.plane.orientation) return;
  const Eigen::Vector3d normal = normal_of(slices.plane);
  for (std::size_t f = 0; f < slices.frames.size(); ++f) {
    std::optional<Eigen::Vector3d>& position = slices.frames[f].position_mm;
    if (position) *position += (offsets[f] - offsets[0]) * normal;
  }
  slices.spread_out = true;
}

Slices slices_of(const DicomFile& file, std::size_t number) {
  Slices slices;
  slices.form = dicom_pixel_form(file);
  slices.series = file.data.text(dicom_tag(0x20, 0x0e));
  const DicomElement* per_frame = file.data.find(kPerFrame);
  if (per_frame && per_frame->items.size() != slices.form.frames) {
    throw InputError(
        file.path, "NumberOfFrames", std::to_string(slices.form.frames),
        std::to_string(per_frame->items.size()) + ", as PerFrameFunctionalGroupsSequence has");
  }
  constexpr DicomTag kIncrement = dicom_tag(0x28, 0x09), kFrameTime = dicom_tag(0x18, 0x1063),
                     kFrameTimes = dicom_tag(0x18, 0x1065);
  if (slices.form.frames > 1 && file.data.find(kIncrement) &&
      (file.data.find(kFrameTime) || file.data.find(kFrameTimes)) && !per_frame) {
    throw InputError(file.path, "FrameIncrementPointer", "frames that follow each other in time",
                     "slices");
  }
  constexpr DicomTag kInstance = dicom_tag(0x20, 0x13);
  const std::vector<double> instance = file.data.decimals(kInstance);
  constexpr Attribute kDoseScale{0, dicom_tag(0x3004, 0x0e), "DoseGridScaling", 1};
  const std::vector<double> dose = numbers_in(file.path, file.data, kDoseScale);
  if (const auto between = numbers_of(file, 0, kBetweenSlices); !between.empty()) {
    if (between[0] == 0.0) throw InputError(file.path, kBetweenSlices.name, "0", "a length");
    slices.between_mm = std::abs(between[0]);
  }
  bool own_places = false;
  for (std::uint32_t f = 0; f < slices.form.frames; ++f) {
    Frame frame{.file = number, .index = f, .position_mm = {}};
    bool own = false;
    if (const auto n = numbers_of(file, f, kPosition, &own); !n.empty()) {
      frame.position_mm = Eigen::Vector3d(n[0], n[1], n[2]);
    }
    own_places = own_places || own;
    if (const auto n = numbers_of(file, f, kSlope); !n.empty()) frame.slope = n[0];
    if (const auto n = numbers_of(file, f, kIntercept); !n.empty()) frame.intercept = n[0];
    if (frame.slope == 0.0) throw InputError(file.path, kSlope.name, "0", "another number");
    if (!dose.empty()) frame.slope *= dose[0];
    frame.instance = instance.empty() ? std::nan("") : instance[0];
    const Plane plane = plane_of(file, f);
    if (f == 0) slices.plane = plane;
    check_plane(file.path, plane, slices.plane);
    slices.frames.push_back(frame);
  }
  if (!own_places && slices.form.frames > 1) {
    spread(file, slices);
    // One place for all says nothing of the others.
    if (!slices.spread_out) {
      for (Frame& frame : slices.frames) frame.position_mm.reset();
    }
  }
  return slices;
}

std::string name_of(const Frame& frame, std::span<const std::string> files, bool many_frames) {
  const std::string name = fs::path(files[frame.file]).filename().string();
  return many_frames ? name + " frame " + std::to_string(frame.index + 1) : name;
}

/// A line through the places of frames, in even steps.
struct Row {
  Eigen::Vector3d first_mm, step_mm;

  double furthest_mm(const std::vector<Frame>& frames) const {
    double most = 0.0;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const Eigen::Vector3d p = first_mm + static_cast<double>(f) * step_mm;
      most = std::max(most, (*frames[f].position_mm - p).norm());
    }
    return most;
  }
};

Row row_through_ends(const std::vector<Frame>& frames) {
  const Eigen::Vector3d first = *frames.front().position_mm;
  return {first, (*frames.back().position_mm - first) / static_cast<double>(frames.size() - 1)};
}

/// Of the least squares, for places whose digits were rounded.
Row row_between(const std::vector<Frame>& frames) {
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
                                  std::vector<Frame>& frames) {
  const auto height = [&](const Frame& frame) { return normal.dot(*frame.position_mm); };
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
    throw InputError(name, kPosition.name, between(f) + " at one place", "a place for each slice");
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
    throw InputError(name, kPosition.name,
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
  throw InputError(name, kPosition.name,
                   name_of(frames[worst], files, many_frames) + " " + text_of(off(worst)) +
                       " mm beside the even row of the others",
                   "slices in a straight row of even steps");
}

void order_by_number(const std::string& name, std::span<const std::string> files,
                     std::vector<Frame>& frames) {
  const bool one_file =
      std::ranges::all_of(frames, [&](const Frame& f) { return f.file == frames[0].file; });
  if (one_file) return;
  std::ranges::stable_sort(frames, {}, [](const Frame& f) { return f.instance; });
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (!std::isnan(frames[f].instance) &&
        (f == 0 || frames[f].instance > frames[f - 1].instance)) {
      continue;
    }
    throw InputError(name, "InstanceNumber",
                     name_of(frames[f], files, false) + " without one of its own",
                     "one for each slice, where no position puts them in order");
  }
}

/// None: a file without pixels, as structured reports and plans are, and directories of others.
std::optional<Slices> read_slices(const std::string& path, std::size_t number,
                                  const InputLimits& limits) {
  const DicomFile file = read_dicom_file(path, limits.memory_bytes);
  constexpr DicomTag kRows = dicom_tag(0x28, 0x10);
  if (!file.data.find(kRows) && !file.data.find(kPixelData)) return std::nullopt;
  return slices_of(file, number);
}

/// Where the frames lie, in the order that they then have.
void place(const std::string& name, std::span<const std::string> files, const Slices& first,
           std::vector<Frame>& frames, MedicalVolume& volume) {
  const bool many_frames = first.form.frames > 1;
  const Plane& plane = first.plane;
  const bool placed =
      std::ranges::all_of(frames, [](const Frame& f) { return f.position_mm.has_value(); });
  const auto some_placed =
      std::ranges::find_if(frames, [](const Frame& f) { return f.position_mm.has_value(); });
  if (!placed && some_placed != frames.end()) {
    const auto without =
        std::ranges::find_if(frames, [](const Frame& f) { return !f.position_mm.has_value(); });
    throw InputError(name, kPosition.name, "none in " + name_of(*without, files, many_frames),
                     "one for each slice, as others have");
  }
  if (placed && !plane.orientation) {
    throw InputError(files[frames.front().file], kOrientation.name,
                     "none beside ImagePositionPatient", "how the slices are turned");
  }
  Eigen::Matrix3d steps = Eigen::Matrix3d::Identity();
  if (plane.orientation) {
    steps.col(0) = plane.orientation->head<3>();
    steps.col(1) = plane.orientation->tail<3>();
    steps.col(2) = normal_of(plane);
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
    order_by_number(name, files, frames);
    if (frames.size() > 1) {
      volume.warnings.push_back(std::string("ImagePositionPatient is not said: slices go by ") +
                                (many_frames ? "the order of frames" : "InstanceNumber"));
    }
  }
  volume.spacing_known = plane.spacing_mm && between_mm;
  const Eigen::Vector2d across = plane.spacing_mm.value_or(Eigen::Vector2d::Ones());
  const Eigen::Vector3d spacing(across[1], across[0], between_mm.value_or(1.0));
  check_spacing(name, kBetweenSlices.name, spacing[2]);
  volume.spacing_m = spacing * kUnit_m;
  volume.direction = steps;
}

}  // namespace

MedicalVolume read_dicom_volume(const std::string& name, std::span<const std::string> files,
                                const InputLimits& limits) {
  std::vector<Frame> frames;
  std::optional<Slices> first;
  std::vector<DicomPixelForm> forms(files.size());
  std::vector<std::string> series;
  MedicalVolume volume;
  volume.file = name;
  for (std::size_t f = 0; f < files.size(); ++f) {
    std::optional<Slices> read = read_slices(files[f], f, limits);
    if (!read) {
      volume.warnings.push_back(fs::path(files[f]).filename().string() +
                                " holds no pixels, and is left out");
      continue;
    }
    const Slices& slices = *read;
    if (!first) first = slices;
    if (std::ranges::find(series, slices.series) == series.end()) series.push_back(slices.series);
    if (slices.form.columns != first->form.columns || slices.form.rows != first->form.rows) {
      if (series.size() > 1) continue;  // which says more
      throw InputError(files[f], "Rows", "slices of another size", "that of the first");
    }
    if (series.size() == 1) check_plane(files[f], slices.plane, first->plane);
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
      const double slope = frames[k].slope, intercept = frames[k].intercept;
      if (slope == 1.0 && intercept == 0.0) continue;
      for (float& value : slice) {
        value = static_cast<float>(slope * static_cast<double>(value) + intercept);
      }
    }
  }
  return volume;
}

DicomSlices dicom_slices(std::span<const std::string> files) {
  DicomSlices slices;
  std::vector<std::string> others;
  const auto extension = [](const std::string& file) {
    return lower_case(fs::path(file).extension().string());
  };
  for (const std::string& file : files) (is_dicom(file) ? slices.files : others).push_back(file);
  for (const std::string& file : others) {
    const std::string name = extension(file);
    if (name == ".dcm" || name == ".dicom") {
      throw InputError(file, "header", "contents that cannot be one", "a DICOM slice");
    }
    const bool as_slices_are = std::ranges::any_of(
        slices.files, [&](const std::string& slice) { return extension(slice) == name; });
    if (!as_slices_are) continue;
    slices.warnings.push_back(fs::path(file).filename().string() +
                              " is no DICOM file, and is left out");
  }
  return slices;
}

}  // namespace sulcus
