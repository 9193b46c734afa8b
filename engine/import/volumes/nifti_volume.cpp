#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <vector>

#include <Eigen/Geometry>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/import/volumes/byte_source.hpp"
#include "engine/import/volumes/volume_checks.hpp"
#include "engine/import/volumes/volume_readers.hpp"

namespace sulcus {
namespace {

namespace fs = std::filesystem;
using Kind = NumberType::Kind;

constexpr std::size_t kHeaderBytes1 = 348, kHeaderBytes2 = 540;

/// What of a header is read, of either version.
struct NiftiHeader {
  std::vector<std::int64_t> sizes;
  int datatype = 0, bitpix = 0;
  std::array<double, 4> pixdim{};  // the first: the sense of qform's third axis
  double vox_offset = 0.0, scl_slope = 0.0, scl_inter = 0.0;
  int xyzt_units = 0, qform_code = 0, sform_code = 0;
  Eigen::Vector3d quatern, qoffset;  // b, c, d; x, y, z
  Eigen::Matrix<double, 3, 4> srow;
  bool together = false;  // header and data in one file
  bool big_endian = false;
  std::size_t bytes = kHeaderBytes1;
};

/// Numbers of a header in either byte order.
class HeaderBytes {
 public:
  HeaderBytes(std::span<const std::byte> bytes, bool swap) : bytes_(bytes), swap_(swap) {}
  template <class Number>
  Number at(std::size_t offset) const {
    std::array<std::byte, sizeof(Number)> raw;
    std::memcpy(raw.data(), bytes_.data() + offset, raw.size());
    if (swap_) std::ranges::reverse(raw);
    Number value;
    std::memcpy(&value, raw.data(), raw.size());
    return value;
  }

 private:
  std::span<const std::byte> bytes_;
  bool swap_;
};

std::unique_ptr<ByteSource> open_unpacked(const std::string& path) {
  std::unique_ptr<ByteSource> file = open_file(path);
  return is_gzip(path) ? inflated(path, std::move(file)) : std::move(file);
}

template <class Real, class Size>
void take_shape(const HeaderBytes& h, const std::string& path, std::size_t dim_at,
                std::size_t pixdim_at, NiftiHeader& header) {
  const auto dimensions = static_cast<std::int64_t>(h.at<Size>(dim_at));
  if (dimensions < 1 || dimensions > 7) {
    throw InputError(path, "dim[0]", std::to_string(dimensions), "3");
  }
  for (std::size_t d = 1; d <= static_cast<std::size_t>(dimensions); ++d) {
    header.sizes.push_back(h.at<Size>(dim_at + d * sizeof(Size)));
  }
  for (std::size_t d = 0; d < 4; ++d) {
    header.pixdim[d] = static_cast<double>(h.at<Real>(pixdim_at + d * sizeof(Real)));
  }
}

template <class Real>
void take_places(const HeaderBytes& h, std::size_t quatern_at, std::size_t srow_at,
                 NiftiHeader& header) {
  const auto real = [&](std::size_t at) { return static_cast<double>(h.at<Real>(at)); };
  for (int d = 0; d < 3; ++d) {
    const auto step = static_cast<std::size_t>(d) * sizeof(Real);
    header.quatern[d] = real(quatern_at + step);
    header.qoffset[d] = real(quatern_at + 3 * sizeof(Real) + step);
    for (int column = 0; column < 4; ++column) {
      header.srow(d, column) =
          real(srow_at +
               (4 * static_cast<std::size_t>(d) + static_cast<std::size_t>(column)) * sizeof(Real));
    }
  }
}

NiftiHeader parse_header(const std::string& path, std::span<const std::byte> raw) {
  const auto size_of = [&](bool swap) { return HeaderBytes(raw, swap).at<std::int32_t>(0); };
  NiftiHeader header;
  const bool first = size_of(false) == 348 || size_of(true) == 348;
  const bool second = size_of(false) == 540 || size_of(true) == 540;
  header.big_endian = size_of(true) == 348 || size_of(true) == 540;
  if (!first && !second) {
    throw InputError(path, "sizeof_hdr", std::to_string(size_of(false)), "348 or 540");
  }
  header.bytes = first ? kHeaderBytes1 : kHeaderBytes2;
  if (raw.size() < header.bytes) {
    throw InputError(path, "header", std::to_string(raw.size()) + " bytes",
                     std::to_string(header.bytes) + " bytes");
  }
  const HeaderBytes h(raw, header.big_endian);
  const auto* magic = reinterpret_cast<const char*>(raw.data()) + (first ? 344 : 4);
  const std::string name(magic, strnlen(magic, 3));
  const std::string together = first ? "n+1" : "n+2", apart = first ? "ni1" : "ni2";
  if (name != together && name != apart) {
    throw InputError(path, "magic",
                     name.empty() ? "none, as ANALYZE 7.5 has it" : "\"" + name + "\"",
                     together + " or " + apart + ": another names no sides");
  }
  header.together = name == together;
  if (first) {
    take_shape<float, std::int16_t>(h, path, 40, 76, header);
    header.datatype = h.at<std::int16_t>(70);
    header.bitpix = h.at<std::int16_t>(72);
    header.vox_offset = static_cast<double>(h.at<float>(108));
    header.scl_slope = static_cast<double>(h.at<float>(112));
    header.scl_inter = static_cast<double>(h.at<float>(116));
    header.xyzt_units = h.at<std::uint8_t>(123);
    header.qform_code = h.at<std::int16_t>(252);
    header.sform_code = h.at<std::int16_t>(254);
    take_places<float>(h, 256, 280, header);
  } else {
    take_shape<double, std::int64_t>(h, path, 16, 104, header);
    header.datatype = h.at<std::int16_t>(12);
    header.bitpix = h.at<std::int16_t>(14);
    header.vox_offset = static_cast<double>(h.at<std::int64_t>(168));
    header.scl_slope = h.at<double>(176);
    header.scl_inter = h.at<double>(184);
    header.xyzt_units = h.at<std::int32_t>(500);
    header.qform_code = h.at<std::int32_t>(344);
    header.sform_code = h.at<std::int32_t>(348);
    take_places<double>(h, 352, 400, header);
  }
  return header;
}

NumberType number_type(const std::string& path, const NiftiHeader& header) {
  static const std::array<std::pair<int, NumberType>, 10> kTypes{{{2, {Kind::kUnsigned, 1}},
                                                                  {4, {Kind::kSigned, 2}},
                                                                  {8, {Kind::kSigned, 4}},
                                                                  {16, {Kind::kFloat, 4}},
                                                                  {64, {Kind::kFloat, 8}},
                                                                  {256, {Kind::kSigned, 1}},
                                                                  {512, {Kind::kUnsigned, 2}},
                                                                  {768, {Kind::kUnsigned, 4}},
                                                                  {1024, {Kind::kSigned, 8}},
                                                                  {1280, {Kind::kUnsigned, 8}}}};
  const auto* found =
      std::ranges::find(kTypes, header.datatype, [](const auto& type) { return type.first; });
  if (found == kTypes.end()) {
    throw InputError(path, "datatype", std::to_string(header.datatype), "a scalar type");
  }
  const auto bits = static_cast<int>(8 * found->second.bytes);
  if (header.bitpix != bits) {
    throw InputError(path, "bitpix", std::to_string(header.bitpix),
                     std::to_string(bits) + " of datatype " + std::to_string(header.datatype));
  }
  return found->second;
}

void check_finite(const std::string& path, const char* place, double value) {
  if (std::abs(value) <= 1e9) return;
  std::ostringstream found;
  found << value;
  throw InputError(path, place, found.str(), "numbers up to 1e9");
}

/// To +x left, +y posterior, from NIfTI's +x right, +y anterior.
const Eigen::Vector3d kTurned{-1.0, -1.0, 1.0};

struct Place {
  Eigen::Matrix3d steps;
  Eigen::Vector3d origin;
};

/// nifti1.h, method 2: a rotation, the last axis turned over where pixdim[0] is -1.
Place place_of_qform(const std::string& path, const NiftiHeader& header) {
  const Eigen::Vector3d& v = header.quatern;
  const double rest = 1.0 - v.squaredNorm();
  constexpr double kRounding = 1e-4;
  if (rest < -kRounding) {
    std::ostringstream found;
    found << v.transpose();
    throw InputError(path, "quatern_b", found.str(), "numbers of a unit quaternion");
  }
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(std::sqrt(std::max(rest, 0.0)), v.x(), v.y(), v.z()).normalized();
  const double qfac = header.pixdim[0] < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d lengths(std::abs(header.pixdim[1]), std::abs(header.pixdim[2]),
                                std::abs(header.pixdim[3]) * qfac);
  return {turn.toRotationMatrix() * lengths.asDiagonal(), header.qoffset};
}

/// The farthest that a corner of one lies from the same of the other.
double furthest_apart(const Place& a, const Place& b, std::span<const std::int64_t> sizes) {
  double most = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d p_index;
    for (int d = 0; d < 3; ++d) {
      p_index[d] = (corner >> d & 1) * static_cast<double>(sizes[static_cast<std::size_t>(d)] - 1);
    }
    most = std::max(most, ((a.steps - b.steps) * p_index + a.origin - b.origin).norm());
  }
  return most;
}

double unit_of(const std::string& path, const NiftiHeader& header,
               std::vector<std::string>& warnings) {
  switch (header.xyzt_units & 7) {
    case 0:
      warnings.emplace_back("xyzt_units names no unit of length: mm are taken");
      return 1e-3;
    case 1:
      return 1.0;
    case 2:
      return 1e-3;
    case 3:
      return 1e-6;
    default:
      throw InputError(path, "xyzt_units", std::to_string(header.xyzt_units & 7),
                       "1, 2 or 3: m, mm or um");
  }
}

void place(const std::string& path, const NiftiHeader& header, MedicalVolume& volume) {
  for (std::size_t d = 1; d <= 3; ++d) check_spacing(path, "pixdim", std::abs(header.pixdim[d]));
  for (int d = 0; d < 3; ++d) {
    check_finite(path, "orientation", header.quatern[d]);
    check_finite(path, "orientation", header.qoffset[d]);
    for (int column = 0; column < 4; ++column) {
      check_finite(path, "orientation", header.srow(d, column));
    }
  }
  const double unit_m = unit_of(path, header, volume.warnings);
  Place place;
  if (header.sform_code > 0) {
    place = {header.srow.leftCols<3>(), header.srow.col(3)};
    for (int d = 0; d < 3; ++d) {
      const double length = place.steps.col(d).norm(),
                   said = std::abs(header.pixdim[static_cast<std::size_t>(d) + 1]);
      constexpr double kSame = 1e-3;
      if (std::abs(length - said) <= kSame * said) continue;
      std::ostringstream text;
      text << "pixdim says " << said << " where sform says " << length
           << ", which is taken, along axis " << d + 1;
      volume.warnings.push_back(text.str());
    }
    if (header.qform_code > 0) {
      const double apart = furthest_apart(place, place_of_qform(path, header), header.sizes);
      constexpr double kVoxels = 0.1;
      if (apart > kVoxels * place.steps.colwise().norm().minCoeff()) {
        std::ostringstream text;
        text << "sform and qform put it up to " << apart * unit_m * 1e3
             << " mm apart: sform is taken";
        volume.warnings.push_back(text.str());
      }
    }
  } else if (header.qform_code > 0) {
    place = place_of_qform(path, header);
  } else {
    volume.warnings.emplace_back(
        "neither qform nor sform has a code: its axes are taken as right, anterior, superior");
    place.steps = Eigen::Vector3d(std::abs(header.pixdim[1]), std::abs(header.pixdim[2]),
                                  std::abs(header.pixdim[3]))
                      .asDiagonal();
    place.origin.setZero();
  }
  set_steps(volume, header.sform_code > 0 ? "srow_x" : "pixdim", kTurned.asDiagonal() * place.steps,
            unit_m);
  volume.origin_m = kTurned.cwiseProduct(place.origin) * unit_m;
}

/// scl_slope; 0: values stay as they are stored.
double scale_of(const std::string& path, const NiftiHeader& header,
                std::vector<std::string>& warnings) {
  if (std::isnan(header.scl_slope)) {
    warnings.emplace_back("scl_slope is no number: values stay as they are stored");
    return 0.0;
  }
  if (header.scl_slope == 0.0) return 0.0;
  check_finite(path, "scl_slope", header.scl_slope);
  check_finite(path, "scl_inter", header.scl_inter);
  return header.scl_slope;
}

/// "a.hdr" or "a.hdr.gz" for "a.img" or "a.img.gz" and the other way round, which exists.
std::string other_half(const std::string& path, const std::string& extension) {
  fs::path stem(path);
  if (lower_case(stem.extension().string()) == ".gz") stem.replace_extension();
  stem.replace_extension();
  std::string capitals = extension;
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const std::string& end : {extension, extension + ".gz", capitals, capitals + ".GZ"}) {
    if (const std::string name = stem.string() + end; fs::is_regular_file(name)) return name;
  }
  throw InputError(path, "", "no " + extension + " beside it", "both halves of a NIfTI file");
}

std::vector<std::byte> header_bytes(const std::string& path) {
  std::vector<std::byte> raw(kHeaderBytes2);
  raw.resize(open_unpacked(path)->read(raw));
  if (raw.size() < kHeaderBytes1) {
    throw InputError(path, "header", std::to_string(raw.size()) + " bytes",
                     std::to_string(kHeaderBytes1) + " bytes");
  }
  return raw;
}

/// The rest of what is packed, so that its checksum is seen; something may follow the values.
void read_out(const std::string& path, ByteSource& source, std::uint64_t announced) {
  constexpr std::size_t kMoreBehind = std::size_t{1} << 20;
  std::vector<std::byte> rest(kMoreBehind);
  if (source.read(rest) == rest.size()) check_end(path, source, announced + kMoreBehind);
}

}  // namespace

MedicalVolume read_nifti_volume(const std::string& path, const InputLimits& limits) {
  const std::string name = lower_case(path);
  const bool data_half = name.ends_with(".img") || name.ends_with(".img.gz");
  const std::string header_path = data_half ? other_half(path, ".hdr") : path;
  const NiftiHeader header = parse_header(header_path, header_bytes(header_path));
  const bool single = name.ends_with(".nii") || name.ends_with(".nii.gz");
  if (header.together != single) {
    throw InputError(header_path, "magic",
                     header.together ? "data behind the header" : "data in an .img",
                     "what its name says");
  }
  const std::string data_path = single ? path : data_half ? path : other_half(path, ".img");

  const std::uint64_t voxels = checked_voxel_count(header_path, "dim", header.sizes, limits);
  check_three_axes(header_path, header.sizes);
  const NumberType type = number_type(header_path, header);
  MedicalVolume volume;
  volume.file = path;
  place(header_path, header, volume);

  const std::uint64_t least_offset = single ? header.bytes + 4 : 0;
  // Some leave it at 0, and mean the first place that may be.
  const double offset =
      single && header.vox_offset == 0.0 ? static_cast<double>(least_offset) : header.vox_offset;
  if (!(offset >= static_cast<double>(least_offset) && offset < 1e12)) {
    std::ostringstream found;
    found << header.vox_offset;
    throw InputError(header_path, "vox_offset", found.str(),
                     "at least " + std::to_string(least_offset));
  }
  const auto begin = static_cast<std::uint64_t>(offset);
  const std::uint64_t announced = voxels * type.bytes;
  const std::uint64_t bytes = fs::file_size(data_path);
  const std::uint64_t ratio = is_gzip(data_path) ? kMaxDeflateRatio : 1;
  const std::uint64_t held = ratio > 1 ? bytes : bytes - std::min(bytes, begin);
  check_data_bytes(data_path, held, announced / ratio, DataLength::kAtLeast);
  const double slope = scale_of(header_path, header, volume.warnings);
  set_sizes(volume, header.sizes);
  const std::unique_ptr<ByteSource> source = open_unpacked(data_path);
  skip_bytes(data_path, *source, begin);
  read_numbers(data_path, *source, type, header.big_endian, volume.values);
  if (ratio > 1) read_out(data_path, *source, begin + announced);
  if (slope != 0.0) rescale(volume.values, slope, header.scl_inter);
  return volume;
}

}  // namespace sulcus
