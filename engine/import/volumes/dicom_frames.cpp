#include "engine/import/volumes/dicom_frames.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <Eigen/Geometry>

#include "engine/core/error.hpp"
#include "engine/import/volumes/dicom_data_set.hpp"
#include "engine/import/volumes/volume_checks.hpp"

namespace sulcus {
namespace {

constexpr DicomTag kShared = dicom_tag(0x5200, 0x9229), kPerFrame = dicom_tag(0x5200, 0x9230);
constexpr DicomTag kPlanePosition = dicom_tag(0x0020, 0x9113),
                   kPlaneOrientation = dicom_tag(0x0020, 0x9116),
                   kPixelMeasures = dicom_tag(0x0028, 0x9110),
                   kValueTransformation = dicom_tag(0x0028, 0x9145);

constexpr double kMostNumber = 1e9;

/// Where a number of DICOM is said, and what it is called.
struct Attribute {
  DicomTag group;  // the sequence that holds it in enhanced files
  DicomTag tag;
  const char* name;
  std::size_t count;
};
constexpr Attribute kPosition{kPlanePosition, dicom_tag(0x20, 0x32), kDicomPosition, 3},
    kOrientation{kPlaneOrientation, dicom_tag(0x20, 0x37), kDicomOrientation, 6},
    kPixelSpacing{kPixelMeasures, dicom_tag(0x28, 0x30), "PixelSpacing", 2},
    kBetweenSlices{kPixelMeasures, dicom_tag(0x18, 0x88), kDicomBetweenSlices, 1},
    kIntercept{kValueTransformation, dicom_tag(0x28, 0x1052), "RescaleIntercept", 1},
    kSlope{kValueTransformation, dicom_tag(0x28, 0x1053), "RescaleSlope", 1};

/// Numbers of an attribute that a data set has. @throws InputError: something else in it.
std::vector<double> numbers_in(const std::string& path, const DicomDataSet& data,
                               const Attribute& attribute) {
  const DicomElement* element = data.find(attribute.tag);
  if (!element || element->value.empty()) return {};
  const std::vector<double> numbers = data.decimals(attribute.tag);
  const bool fine = numbers.size() == attribute.count && std::ranges::all_of(numbers, [](double n) {
                      return std::isfinite(n) && std::abs(n) < kMostNumber;
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

DicomPlane plane_of(const DicomFile& file, std::uint32_t index) {
  DicomPlane plane;
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

/// Places of frames that share one, where the file says how far they lie apart.
void spread(const DicomFile& file, DicomFrames& slices) {
  constexpr Attribute kOffsets{0, dicom_tag(0x3004, 0x0c), "GridFrameOffsetVector", 0};
  std::vector<double> offsets = file.data.decimals(kOffsets.tag);
  const DicomElement* said = file.data.find(kOffsets.tag);
  const bool finite = std::ranges::all_of(
      offsets, [](double n) { return std::isfinite(n) && std::abs(n) < kMostNumber; });
  if (said && !said->value.empty() && (offsets.empty() || !finite)) {
    throw InputError(file.path, kOffsets.name, "\"" + file.data.text(kOffsets.tag) + "\"",
                     "finite numbers");
  }
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
  const Eigen::Vector3d normal = slices.plane.normal();
  for (std::size_t f = 0; f < slices.frames.size(); ++f) {
    std::optional<Eigen::Vector3d>& position = slices.frames[f].position_mm;
    if (position) *position += (offsets[f] - offsets[0]) * normal;
  }
  slices.spread_out = true;
}

DicomFrames frames_of(const DicomFile& file, std::size_t number) {
  DicomFrames slices;
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
    DicomFrame frame{.file = number, .index = f, .position_mm = {}};
    bool own = false;
    if (const auto n = numbers_of(file, f, kPosition, &own); !n.empty()) {
      frame.position_mm = Eigen::Vector3d(n[0], n[1], n[2]);
    }
    own_places = own_places || own;
    if (const auto n = numbers_of(file, f, kSlope); !n.empty()) frame.slope = n[0];
    if (const auto n = numbers_of(file, f, kIntercept); !n.empty()) frame.intercept = n[0];
    if (frame.slope == 0.0) throw InputError(file.path, kSlope.name, "0", "another number");
    if (!dose.empty()) frame.slope *= dose[0];
    if (frame.slope == 0.0) throw InputError(file.path, kDoseScale.name, "0", "another number");
    frame.instance = instance.empty() ? std::nan("") : instance[0];
    const DicomPlane plane = plane_of(file, f);
    if (f == 0) slices.plane = plane;
    check_dicom_plane(file.path, plane, slices.plane);
    slices.frames.push_back(frame);
  }
  if (!own_places && slices.form.frames > 1) {
    spread(file, slices);
    // One place for all says nothing of the others.
    if (!slices.spread_out) {
      for (DicomFrame& frame : slices.frames) frame.position_mm.reset();
    }
  }
  return slices;
}

}  // namespace

void check_dicom_plane(const std::string& path, const DicomPlane& plane, const DicomPlane& first) {
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

std::optional<DicomFrames> read_dicom_frames(const std::string& path, std::size_t number,
                                             const InputLimits& limits) {
  const DicomFile file = read_dicom_file(path, limits.memory_bytes);
  constexpr DicomTag kRows = dicom_tag(0x28, 0x10);
  if (!file.data.find(kRows) && !file.data.find(kPixelData)) return std::nullopt;
  return frames_of(file, number);
}

}  // namespace sulcus
