#include "engine/import/itk_volume_io.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <itkGDCMImageIO.h>
#include <itkGDCMSeriesFileNames.h>
#include <itkImage.h>
#include <itkImageSeriesReader.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/import/png_volume.hpp"
#include "engine/import/tiff_volume.hpp"
#include "engine/import/volume_header.hpp"
#include "engine/import/written_volume.hpp"

// With itk_thresholds.cpp the only file that knows ITK. (TIFF and PNG go by their own libraries:
// tiff_volume.hpp, png_volume.hpp.)

namespace sulcus {
namespace {

namespace fs = std::filesystem;
using IOComponent = itk::IOComponentEnum;

constexpr double kUnitOfItk = 1e-3;  // m: medical files are in mm

constexpr const char* kFormats =
    ".nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz, .hdr, .img, .tif, .tiff, .dcm or a folder of slices";

/// ITK and the readers in it talk to `std::cerr` besides throwing; an error here is one line.
class Silence {
 public:
  Silence() : warnings_(itk::Object::GetGlobalWarningDisplay()), buffer_(std::cerr.rdbuf(nullptr)) {
    itk::Object::GlobalWarningDisplayOff();
  }
  ~Silence() {
    std::cerr.rdbuf(buffer_);  // clears the state, too
    itk::Object::SetGlobalWarningDisplay(warnings_);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  bool warnings_;
  std::streambuf* buffer_;
};

/// ITK's text on one line, without the object's name and address that it begins with.
std::string one_line(const itk::ExceptionObject& error) {
  std::string_view text = error.GetDescription();
  if (const auto address = text.find("(0x"); address != std::string_view::npos) {
    if (const auto end = text.find("): ", address); end != std::string_view::npos) {
      text.remove_prefix(end + 3);
    }
  }
  // NrrdIO tells the whole chain of its calls; the last of them knows the reason.
  if (const auto last = text.rfind("[nrrd] "); last != std::string_view::npos) {
    text.remove_prefix(last + 7);
  }
  std::string line;
  for (const char c : text) {
    const bool blank = std::isspace(static_cast<unsigned char>(c)) != 0;
    if (!blank) line += c;
    if (blank && !line.empty() && line.back() != ' ') line += ' ';
  }
  while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
  constexpr std::size_t kLongest = 200;
  if (line.size() > kLongest) line = line.substr(0, kLongest) + "...";
  return line.empty() ? "unreadable contents" : "unreadable contents (" + line + ")";
}

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  if (extension == ".gz") extension = path.stem().extension().string() + extension;
  return lower_case(extension);
}

bool is_tiff(const fs::path& path) {
  const std::string extension = lower_extension(path);
  return extension == ".tif" || extension == ".tiff";
}

std::size_t voxel_count(const ItkVolume& volume) {
  return static_cast<std::size_t>(volume.sizes[0]) * static_cast<std::size_t>(volume.sizes[1]) *
         static_cast<std::size_t>(volume.sizes[2]);
}

struct Format {
  itk::ImageIOBase::Pointer io;
  const char* name;
};

std::optional<Format> format_of(const std::string& extension) {
  if (extension == ".nrrd" || extension == ".nhdr") {
    return Format{itk::NrrdImageIO::New().GetPointer(), "an NRRD file"};
  }
  if (extension == ".mha" || extension == ".mhd") {
    return Format{itk::MetaImageIO::New().GetPointer(), "a MetaImage file"};
  }
  if (extension == ".nii" || extension == ".nii.gz" || extension == ".hdr" || extension == ".img" ||
      extension == ".img.gz") {
    return Format{itk::NiftiImageIO::New().GetPointer(), "a NIfTI file"};
  }
  if (extension == ".dcm" || extension == ".dicom") {
    return Format{itk::GDCMImageIO::New().GetPointer(), "a DICOM file"};
  }
  return std::nullopt;
}

VolumeHeaderFacts check_header(const std::string& path, const std::string& extension,
                               const InputLimits& limits) {
  if (extension == ".nrrd" || extension == ".nhdr") return check_nrrd_header(path, limits);
  if (extension == ".mha" || extension == ".mhd") return check_meta_image_header(path, limits);
  if (extension == ".nii" || extension == ".nii.gz" || extension == ".hdr") {
    check_nifti_header(path, limits);
  }
  return {};
}

void check_scalar(const std::string& path, const itk::ImageIOBase& io) {
  if (io.GetNumberOfComponents() != 1 || io.GetPixelType() != itk::IOPixelEnum::SCALAR) {
    throw InputError(path, "pixel type",
                     std::to_string(io.GetNumberOfComponents()) + " components (" +
                         itk::ImageIOBase::GetPixelTypeAsString(io.GetPixelType()) + ")",
                     "one grey value a voxel");
  }
}

/// Sizes, spacing, origin and direction of an axis count of three; more axes must be one voxel
/// long.
void take_geometry(const std::string& path, const itk::ImageIOBase& io, double unit_m,
                   const InputLimits& limits, ItkVolume& volume) {
  const unsigned dimensions = io.GetNumberOfDimensions();
  std::vector<std::int64_t> sizes;
  for (unsigned d = 0; d < dimensions; ++d) {
    const auto size = io.GetDimensions(d);
    constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    sizes.push_back(static_cast<std::int64_t>(std::min<std::uint64_t>(size, kMost)));
  }
  checked_voxel_count(path, "sizes", sizes, limits);
  if (dimensions < 3 ||
      std::any_of(sizes.begin() + 3, sizes.end(), [](auto s) { return s != 1; })) {
    throw InputError(path, "dimension", std::to_string(dimensions), "3");
  }
  for (unsigned d = 0; d < 3; ++d) {
    volume.sizes[d] = static_cast<int>(sizes[d]);
    check_spacing(path, "spacing", io.GetSpacing(d));
    volume.spacing_m[d] = io.GetSpacing(d) * unit_m;
    volume.origin_m[d] = io.GetOrigin(d) * unit_m;
    const std::vector<double> axis = io.GetDirection(d);
    std::copy_n(axis.begin(), 3, volume.axes[d].begin());
  }
}

template <class T>
void convert(const std::vector<std::byte>& raw, std::vector<float>& values) {
  const std::byte* from = raw.data();
  for (float& value : values) {
    T grey;
    std::memcpy(&grey, from, sizeof(T));
    from += sizeof(T);
    value = static_cast<float>(grey);
  }
}

void read_values(const std::string& path, itk::ImageIOBase& io, ItkVolume& volume) {
  itk::ImageIORegion region(io.GetNumberOfDimensions());
  for (unsigned d = 0; d < io.GetNumberOfDimensions(); ++d) {
    region.SetIndex(d, 0);
    region.SetSize(d, io.GetDimensions(d));
  }
  io.SetIORegion(region);
  volume.values.resize(voxel_count(volume));
  if (io.GetComponentType() == IOComponent::FLOAT) {
    io.Read(volume.values.data());
    return;
  }
  std::vector<std::byte> raw(volume.values.size() * io.GetComponentSize());
  io.Read(raw.data());
  switch (io.GetComponentType()) {
    case IOComponent::UCHAR:
      return convert<unsigned char>(raw, volume.values);
    case IOComponent::CHAR:
      return convert<signed char>(raw, volume.values);
    case IOComponent::USHORT:
      return convert<unsigned short>(raw, volume.values);
    case IOComponent::SHORT:
      return convert<short>(raw, volume.values);
    case IOComponent::UINT:
      return convert<unsigned int>(raw, volume.values);
    case IOComponent::INT:
      return convert<int>(raw, volume.values);
    case IOComponent::ULONG:
      return convert<unsigned long>(raw, volume.values);
    case IOComponent::LONG:
      return convert<long>(raw, volume.values);
    case IOComponent::ULONGLONG:
      return convert<unsigned long long>(raw, volume.values);
    case IOComponent::LONGLONG:
      return convert<long long>(raw, volume.values);
    case IOComponent::DOUBLE:
      return convert<double>(raw, volume.values);
    default:
      throw InputError(path, "pixel type",
                       itk::ImageIOBase::GetComponentTypeAsString(io.GetComponentType()),
                       "a number type");
  }
}

ItkVolume read_file(const std::string& path, const InputLimits& limits) {
  const std::string extension = lower_extension(path);
  const std::optional<Format> format = format_of(extension);
  if (!format && !is_tiff(path)) {
    throw InputError(path, "", "the extension \"" + extension + "\"", kFormats);
  }
  const char* name = format ? format->name : "a TIFF file";
  if (!fs::is_regular_file(path)) throw InputError(path, "", "no regular file", name);
  if (fs::file_size(path) == 0) throw InputError(path, "", "an empty file", name);
  if (!format) return read_tiff_volume({&path, 1}, limits);
  const VolumeHeaderFacts facts = check_header(path, extension, limits);
  itk::ImageIOBase& io = *format->io;
  if (!io.CanReadFile(path.c_str())) {
    throw InputError(path, "header", "contents that cannot be one", format->name);
  }
  io.SetFileName(path);
  io.ReadImageInformation();
  check_scalar(path, io);
  ItkVolume volume;
  volume.spacing_known = facts.spacing_known;
  take_geometry(path, io, facts.length_unit_m, limits, volume);
  read_values(path, io, volume);
  return volume;
}

/// Slices of a folder in the order of the numbers in their names: slice_9 before slice_10.
bool natural_less(const std::string& a, const std::string& b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      std::size_t i_end = i, j_end = j;
      while (i_end < a.size() && digit(a[i_end])) ++i_end;
      while (j_end < b.size() && digit(b[j_end])) ++j_end;
      while (i + 1 < i_end && a[i] == '0') ++i;
      while (j + 1 < j_end && b[j] == '0') ++j;
      if (i_end - i != j_end - j) return i_end - i < j_end - j;
      const int order = a.compare(i, i_end - i, b, j, j_end - j);
      if (order != 0) return order < 0;
      i = i_end;
      j = j_end;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  return a.size() - i < b.size() - j || (a.size() - i == b.size() - j && a < b);
}

std::vector<std::string> dicom_slices(const std::string& folder) {
  auto names = itk::GDCMSeriesFileNames::New();
  names->SetUseSeriesDetails(true);
  names->SetInputDirectory(folder);
  const std::vector<std::string>& series = names->GetSeriesUIDs();
  if (series.empty()) {
    throw InputError(folder, "", "no DICOM series and no .tif or .png slices",
                     "a folder of slices");
  }
  if (series.size() > 1) {
    throw InputError(folder, "", std::to_string(series.size()) + " DICOM series",
                     "one: a folder for each");
  }
  return names->GetFileNames(series.front());
}

ItkVolume read_folder(const std::string& folder, const InputLimits& limits) {
  std::vector<std::string> slices, png_slices;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    if (is_tiff(entry.path())) slices.push_back(entry.path().string());
    if (lower_extension(entry.path()) == ".png") png_slices.push_back(entry.path().string());
  }
  if (!slices.empty() && !png_slices.empty()) {
    throw InputError(folder, "", "TIFF and PNG slices", "one of them");
  }
  std::ranges::sort(slices, natural_less);
  if (!slices.empty()) return read_tiff_volume(slices, limits);
  std::ranges::sort(png_slices, natural_less);
  if (!png_slices.empty()) return read_png_volume(png_slices, limits);
  slices = dicom_slices(folder);

  const itk::ImageIOBase::Pointer io = itk::GDCMImageIO::New().GetPointer();
  if (!io->CanReadFile(slices.front().c_str())) {
    throw InputError(slices.front(), "header", "contents that cannot be one", "a DICOM slice");
  }
  io->SetFileName(slices.front());
  io->ReadImageInformation();
  check_scalar(slices.front(), *io);
  const std::array<std::int64_t, 3> sizes = {static_cast<std::int64_t>(io->GetDimensions(0)),
                                             static_cast<std::int64_t>(io->GetDimensions(1)),
                                             static_cast<std::int64_t>(slices.size())};
  checked_voxel_count(folder, "sizes", sizes, limits);

  using Image = itk::Image<float, 3>;
  auto reader = itk::ImageSeriesReader<Image>::New();
  reader->SetImageIO(io);
  reader->SetFileNames(slices);
  reader->Update();
  const Image& image = *reader->GetOutput();
  ItkVolume volume;
  for (unsigned d = 0; d < 3; ++d) {
    volume.sizes[d] = static_cast<int>(image.GetLargestPossibleRegion().GetSize(d));
    check_spacing(folder, "spacing", image.GetSpacing()[d]);
    volume.spacing_m[d] = image.GetSpacing()[d] * kUnitOfItk;
    volume.origin_m[d] = image.GetOrigin()[d] * kUnitOfItk;
    for (unsigned row = 0; row < 3; ++row) volume.axes[d][row] = image.GetDirection()[row][d];
  }
  volume.values.assign(image.GetBufferPointer(), image.GetBufferPointer() + voxel_count(volume));
  return volume;
}

}  // namespace

ItkVolume read_volume_with_itk(const std::string& path, const InputLimits& limits) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw InputError(path, "", "no such file", "a volume");
  const Silence silence;
  try {
    return fs::is_directory(status) ? read_folder(path, limits) : read_file(path, limits);
  } catch (const itk::ExceptionObject& itk_error) {
    throw InputError(path, "", one_line(itk_error), "a whole volume");
  } catch (const std::bad_alloc&) {
    throw InputError(path, "sizes", "more voxels than memory", "a smaller volume");
  } catch (const fs::filesystem_error& file_error) {
    throw InputError(path, "", "no access (" + file_error.code().message() + ")", "a volume");
  }
}

void write_volume_with_itk(const std::string& path, const ItkMask& mask) {
  WholeFile file(path);
  const Silence silence;
  try {
    const std::optional<Format> format = format_of(lower_extension(path));
    if (!format) throw std::logic_error(path + ": no format that is written");
    const itk::ImageIOBase::Pointer io = format->io;
    io->SetFileName(file.beside());
    io->SetFileTypeToBinary();
    io->SetUseCompression(true);
    io->SetNumberOfDimensions(3);
    io->SetPixelType(itk::IOPixelEnum::SCALAR);
    io->SetComponentType(IOComponent::UCHAR);
    io->SetNumberOfComponents(1);
    itk::ImageIORegion region(3);
    for (unsigned d = 0; d < 3; ++d) {
      const auto size = static_cast<itk::SizeValueType>(mask.sizes[d]);
      io->SetDimensions(d, size);
      io->SetSpacing(d, mask.spacing_m[d] / kUnitOfItk);
      io->SetOrigin(d, mask.origin_m[d] / kUnitOfItk);
      io->SetDirection(d, std::vector<double>(mask.axes[d].begin(), mask.axes[d].end()));
      region.SetIndex(d, 0);
      region.SetSize(d, size);
    }
    io->SetIORegion(region);
    io->Write(mask.voxels.data());
  } catch (const itk::ExceptionObject& itk_error) {
    file.fail_incomplete(one_line(itk_error));
  }
  if (!is_whole_volume(file.beside(), mask.voxels.size())) file.fail_incomplete();
  file.finish();
}

}  // namespace sulcus
