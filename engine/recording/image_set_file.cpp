#include "engine/recording/image_set_file.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>
#include <utility>

#include "engine/recording/hdf5_fixed.hpp"

namespace sulcus {
namespace {

constexpr std::uint64_t kMostFormatBytes = 64;
constexpr unsigned kImageDeflateLevel = 1;  // most of a picture is even
constexpr std::size_t kLabelNameBytes = 64;

struct LabelRow {
  std::uint8_t label;
  std::array<char, kLabelNameBytes> name;
};

/// Does it, and names the file where HDF5 cannot.
template <class Work>
void of_file(const std::string& path, const Work& work) {
  try {
    work();
  } catch (const Hdf5Error& error) {
    throw std::runtime_error(path + ": cannot be written: " + error.what());
  }
}

}  // namespace

struct ImageSetFile::File {
  std::string path;
  std::size_t frames, width, height;
  Hdf5Handle file;
  std::map<std::string, Hdf5Handle> groups, arrays;

  const Hdf5Handle& group(const std::string& name) {
    if (name.empty()) return file;
    const auto found = groups.find(name);
    if (found != groups.end()) return found->second;
    return groups.emplace(name, create_group(file, name.c_str())).first->second;
  }
  const Hdf5Handle& array(const std::string& in, const ImageArray& array);
};

const Hdf5Handle& ImageSetFile::File::array(const std::string& in, const ImageArray& array) {
  const std::string key = in + '/' + array.name;
  const auto found = arrays.find(key);
  if (found != arrays.end()) return found->second;
  const char* name = array.name.c_str();
  const std::array<hsize_t, 4> dims{frames, height, width, array.channels};
  const std::array<hsize_t, 4> chunk{1, height, width, array.channels};
  const int rank = array.channels > 1 ? 4 : 3;
  const auto space = hdf5_checked(H5Screate_simple(rank, dims.data(), nullptr), H5Sclose, name);
  const auto properties = hdf5_checked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
  hdf5_check(H5Pset_chunk(properties, rank, chunk.data()), name);
  const bool bytes = array.type == ImageArray::Type::kByte;
  if (!bytes) hdf5_check(H5Pset_shuffle(properties), name);
  hdf5_check(H5Pset_deflate(properties, kImageDeflateLevel), name);
  auto made = hdf5_checked(H5Dcreate2(group(in), name, bytes ? H5T_STD_U8LE : H5T_IEEE_F32LE, space,
                                      H5P_DEFAULT, properties, H5P_DEFAULT),
                           H5Dclose, name);
  write_text_attribute(made, "what", array.what);
  return arrays.emplace(key, std::move(made)).first->second;
}

ImageSetFile::ImageSetFile(const WholeFile& whole, std::size_t frames, std::size_t width,
                           std::size_t height)
    : file_(std::make_unique<File>()) {
  file_->path = whole.path();
  file_->frames = frames;
  file_->width = width;
  file_->height = height;
  silence_hdf5();
  of_file(file_->path, [&] {
    file_->file =
        hdf5_checked(H5Fcreate(whole.beside().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
                     H5Fclose, "file");
  });
}

ImageSetFile::~ImageSetFile() {
  if (!file_->file.valid()) return;
  // It was not finished: HDF5 1.10.8 must not be asked to close what it could not write.
  for (auto* handles : {&file_->arrays, &file_->groups}) {
    for (auto& [name, handle] : *handles) handle.release();
  }
  file_->file.release();
}

void ImageSetFile::set_text(const std::string& group, const char* name, const std::string& text) {
  of_file(file_->path, [&] { write_text_attribute(file_->group(group), name, text); });
}

void ImageSetFile::set_number(const std::string& group, const char* name, double value) {
  of_file(file_->path,
          [&] { write_attribute(file_->group(group), name, H5T_NATIVE_DOUBLE, &value); });
}

void ImageSetFile::set_rows(const std::string& group, const char* name, const std::string& what,
                            std::span<const std::size_t> dims, std::span<const double> values) {
  of_file(file_->path, [&] {
    const std::vector<hsize_t> sizes(dims.begin(), dims.end());
    const auto space = hdf5_checked(
        H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose, name);
    if (H5Sget_simple_extent_npoints(space) != static_cast<hssize_t>(values.size())) {
      throw std::invalid_argument("rows of another size than their numbers");
    }
    const auto rows = hdf5_checked(H5Dcreate2(file_->group(group), name, H5T_IEEE_F64LE, space,
                                              H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                                   H5Dclose, name);
    hdf5_check(H5Dwrite(rows, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
               name);
    write_text_attribute(rows, "what", what);
  });
}

void ImageSetFile::set_labels(std::span<const ImageLabel> labels) {
  std::vector<LabelRow> rows;
  rows.reserve(labels.size());
  for (const ImageLabel& label : labels) {
    LabelRow row{label.label, {}};
    std::copy_n(label.name.begin(), std::min(label.name.size(), kLabelNameBytes - 1),
                row.name.begin());
    rows.push_back(row);
  }
  of_file(file_->path, [&] {
    const auto name = hdf5_checked(H5Tcopy(H5T_C_S1), H5Tclose, "labels");
    hdf5_check(H5Tset_size(name, kLabelNameBytes), "labels");
    hdf5_check(H5Tset_cset(name, H5T_CSET_UTF8), "labels");
    const auto type = hdf5_checked(H5Tcreate(H5T_COMPOUND, sizeof(LabelRow)), H5Tclose, "labels");
    hdf5_check(H5Tinsert(type, "label", HOFFSET(LabelRow, label), H5T_STD_U8LE), "labels");
    hdf5_check(H5Tinsert(type, "name", HOFFSET(LabelRow, name), name), "labels");
    write_fixed_rows(file_->file, "labels", type, rows.data(), rows.size());
  });
}

void ImageSetFile::write_frame(const std::string& group, const ImageArray& array, std::size_t frame,
                               std::size_t values, const void* data) {
  if (values != file_->width * file_->height * array.channels || frame >= file_->frames) {
    throw std::invalid_argument("a picture of another size than its array");
  }
  const char* name = array.name.c_str();
  of_file(file_->path, [&] {
    const Hdf5Handle& all = file_->array(group, array);
    const int rank = array.channels > 1 ? 4 : 3;
    const std::array<hsize_t, 4> first{frame, 0, 0, 0};
    const std::array<hsize_t, 4> count{1, file_->height, file_->width, array.channels};
    const auto space = hdf5_checked(H5Dget_space(all), H5Sclose, name);
    hdf5_check(
        H5Sselect_hyperslab(space, H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr),
        name);
    const auto memory = hdf5_checked(H5Screate_simple(rank, count.data(), nullptr), H5Sclose, name);
    const hid_t type = array.type == ImageArray::Type::kByte ? H5T_NATIVE_UINT8 : H5T_NATIVE_FLOAT;
    hdf5_check(H5Dwrite(all, type, memory, space, H5P_DEFAULT, data), name);
  });
}

void ImageSetFile::write(const std::string& group, const ImageArray& array, std::size_t frame,
                         std::span<const std::uint8_t> bytes) {
  write_frame(group, array, frame, bytes.size(), bytes.data());
}

void ImageSetFile::write(const std::string& group, const ImageArray& array, std::size_t frame,
                         std::span<const float> numbers) {
  write_frame(group, array, frame, numbers.size(), numbers.data());
}

void ImageSetFile::close() {
  of_file(file_->path, [&] {
    hdf5_check(H5Fflush(file_->file, H5F_SCOPE_GLOBAL), "file");
    file_->arrays.clear();
    file_->groups.clear();
    if (!file_->file.close()) throw Hdf5Error("file: " + hdf5_reason());
  });
}

bool is_other_hdf5_file(const std::string& path) {
  silence_hdf5();
  if (H5Fis_hdf5(path.c_str()) <= 0) return false;
  try {
    const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    return !file.valid() || H5Aexists(file, "format") <= 0 ||
           read_text_attribute(file, "format", kMostFormatBytes) != kImageSetFormat;
  } catch (const Hdf5Error&) {
    return true;
  }
}

}  // namespace sulcus
