#include "engine/import/volumes/medical_volume.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <new>
#include <sstream>

#include <Eigen/LU>

#include "engine/core/error.hpp"
#include "engine/core/file_kind.hpp"
#include "engine/import/volumes/dicom_data_set.hpp"
#include "engine/import/volumes/slice_order.hpp"
#include "engine/import/volumes/volume_readers.hpp"

namespace sulcus {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormats =
    ".nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz, .hdr, .img, .tif, .tiff, .dcm or a folder of slices";

bool is_tiff(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".tif" || extension == ".tiff";
}

MedicalVolume read_tiff_file(const std::string& path, const InputLimits& limits) {
  return read_tiff_volume({&path, 1}, limits);
}
MedicalVolume read_one_dicom_file(const std::string& path, const InputLimits& limits) {
  return read_dicom_volume(path, {&path, 1}, limits);
}

struct Format {
  MedicalVolume (*read)(const std::string& path, const InputLimits& limits);
  const char* name;
};

Format format_of(const std::string& path) {
  const std::string extension = lower_extension(path);
  const auto is_one_of = [&](std::initializer_list<const char*> names) {
    return std::ranges::find(names, extension) != names.end();
  };
  if (is_one_of({".nrrd", ".nhdr"})) return {read_nrrd_volume, "an NRRD file"};
  if (is_one_of({".mha", ".mhd"})) return {read_meta_image_volume, "a MetaImage file"};
  if (is_one_of({".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"})) {
    return {read_nifti_volume, "a NIfTI file"};
  }
  if (is_tiff(path)) return {read_tiff_file, "a TIFF file"};
  // Scanners name DICOM files in many ways, and by no extension.
  if (is_one_of({".dcm", ".dicom"}) || is_dicom(path)) return {read_one_dicom_file, "a DICOM file"};
  throw InputError(path, "", "the extension \"" + extension + "\"", kFormats);
}

MedicalVolume read_file(const std::string& path, const InputLimits& limits) {
  if (!fs::is_regular_file(path)) throw InputError(path, "", "no regular file", "a volume");
  const Format format = format_of(path);
  if (fs::file_size(path) == 0) throw InputError(path, "", "an empty file", format.name);
  return format.read(path, limits);
}

MedicalVolume read_folder(const std::string& folder, const InputLimits& limits) {
  std::vector<std::string> tiffs, pngs, others;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string file = entry.path().string();
    std::error_code gone;
    // Hidden ones are editors' notes that a file is open.
    if (entry.is_symlink() && !fs::exists(file, gone) &&
        !entry.path().filename().string().starts_with('.')) {
      throw InputError(file, "", "a link to nothing", "a slice, or another file");
    }
    if (!entry.is_regular_file(gone)) continue;
    (is_tiff(file) ? tiffs : lower_extension(file) == ".png" ? pngs : others).push_back(file);
  }
  std::ranges::sort(others);  // a folder has no order of its own
  const DicomSlices dicom = dicom_slices(others);
  const auto full = [](const std::vector<std::string>& files) { return files.empty() ? 0 : 1; };
  if (full(tiffs) + full(pngs) + full(dicom.files) > 1) {
    throw InputError(folder, "", "slices of more than one of TIFF, PNG and DICOM",
                     "slices of one format");
  }
  const auto with = [](MedicalVolume volume, const std::vector<std::string>& warnings) {
    volume.warnings.insert(volume.warnings.end(), warnings.begin(), warnings.end());
    return volume;
  };
  if (!dicom.files.empty()) {
    return with(read_dicom_volume(folder, dicom.files, limits), dicom.warnings);
  }
  if (tiffs.empty() && pngs.empty()) {
    throw InputError(folder, "", "no DICOM series and no .tif or .png slices",
                     "a folder of slices");
  }
  const SliceOrder order = slice_order(folder, tiffs.empty() ? pngs : tiffs);
  return with((tiffs.empty() ? read_png_volume : read_tiff_volume)(order.files, limits),
              order.warnings);
}

void check_placement(const MedicalVolume& volume) {
  constexpr double kFlat = 1e-3;
  if (!volume.origin_m.allFinite() || !volume.direction.allFinite() ||
      std::abs(volume.direction.determinant()) < kFlat) {
    throw InputError(volume.file, "direction", "axes that span no volume or are not finite",
                     "three independent axes");
  }
}

/// Values that are not finite would spread along whole lines when the grid is interpolated.
void replace_non_finite(MedicalVolume& volume) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  float least = kInfinity, most = -kInfinity;
  std::size_t above = 0, others = 0;
  for (const float v : volume.values) {
    if (std::isfinite(v)) {
      least = std::min(least, v);
      most = std::max(most, v);
    } else {
      ++(v == kInfinity ? above : others);
    }
  }
  if (above + others == 0) return;
  if (least > most) throw InputError(volume.file, "data", "no finite grey value", "grey values");
  for (float& v : volume.values) {
    if (!std::isfinite(v)) v = v == kInfinity ? most : least;
  }
  const auto warn = [&](std::size_t count, const char* of, const char* end, float value) {
    if (count == 0) return;
    std::ostringstream text;
    text << count << (count == 1 ? " value is " : " values are ") << of << ": taken as the " << end
         << ", " << value;
    volume.warnings.push_back(text.str());
  };
  warn(above, "infinite, or too large", "largest", most);
  warn(others, "no number, padding, or below all", "smallest", least);
}

}  // namespace

MedicalVolume read_medical_volume(const std::string& path, const InputLimits& limits) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw InputError(path, "", "no such file", "a volume");
  try {
    MedicalVolume volume =
        fs::is_directory(status) ? read_folder(path, limits) : read_file(path, limits);
    volume.file = path;
    check_placement(volume);
    replace_non_finite(volume);
    return volume;
  } catch (const std::bad_alloc&) {
    throw InputError(path, "sizes", "more voxels than memory", "a smaller volume");
  } catch (const fs::filesystem_error& file_error) {
    throw InputError(path, "", "no access (" + file_error.code().message() + ")", "a volume");
  }
}

}  // namespace sulcus
