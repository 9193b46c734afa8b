#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/LU>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/import/volumes/byte_source.hpp"
#include "engine/import/volumes/text_header.hpp"
#include "engine/import/volumes/volume_checks.hpp"
#include "engine/import/volumes/volume_readers.hpp"

namespace sulcus {
namespace {

using Kind = NumberType::Kind;

NumberType number_type(const TextHeader& header) {
  static const std::map<std::string, NumberType> kTypes = {
      {"met_char", {Kind::kSigned, 1}},      {"met_uchar", {Kind::kUnsigned, 1}},
      {"met_short", {Kind::kSigned, 2}},     {"met_ushort", {Kind::kUnsigned, 2}},
      {"met_int", {Kind::kSigned, 4}},       {"met_uint", {Kind::kUnsigned, 4}},
      {"met_long", {Kind::kSigned, 4}},      {"met_ulong", {Kind::kUnsigned, 4}},
      {"met_long_long", {Kind::kSigned, 8}}, {"met_ulong_long", {Kind::kUnsigned, 8}},
      {"met_float", {Kind::kFloat, 4}},      {"met_double", {Kind::kFloat, 8}}};
  const std::string& name = header.at("elementtype");
  const auto type = kTypes.find(lower_case(name));
  if (type == kTypes.end()) {
    throw InputError(header.path, "ElementType", "\"" + name + "\"", "a scalar MET_ type");
  }
  return type->second;
}

/// "True" or "False"; `otherwise` where there is no such field.
bool is_true(const TextHeader& header, const std::string& key, const char* name, bool otherwise) {
  const std::string value = lower_case(header.at(key));
  if (value.empty()) return otherwise;
  if (value == "true" || value == "t" || value == "1") return true;
  if (value == "false" || value == "f" || value == "0") return false;
  throw InputError(header.path, name, "\"" + header.at(key) + "\"", "True or False");
}

/// The first of these fields that there is: several of MetaIO's have more than one name.
std::optional<HeaderField> first_of(const TextHeader& header,
                                    std::initializer_list<HeaderField> fields) {
  for (const HeaderField& field : fields) {
    if (header.has(field.key)) return field;
  }
  return std::nullopt;
}

double unit_of(const TextHeader& header) {
  const std::string unit = lower_case(header.at("distanceunits"));
  if (unit.empty() || unit == "?" || unit == "mm") return 1e-3;
  if (unit == "um") return 1e-6;
  if (unit == "cm") return 1e-2;
  throw InputError(header.path, "DistanceUnits", "\"" + unit + "\"", "mm, um or cm");
}

/// Of letters like RAI: each axis runs from that side.
std::optional<Eigen::Matrix3d> directions_of_sides(const TextHeader& header) {
  const std::string text = lower_case(header.at("anatomicalorientation"));
  if (text.empty() || text.find('?') != std::string::npos) return std::nullopt;
  Eigen::Matrix3d directions = Eigen::Matrix3d::Zero();
  const auto wrong = [&] {
    throw InputError(header.path, "AnatomicalOrientation", "\"" + text + "\"",
                     "three letters of R or L, A or P, I or S");
  };
  if (text.size() != 3) wrong();
  for (int d = 0; d < 3; ++d) {
    static const std::string kFrom = "rai", kTo = "lps";
    const char letter = text[static_cast<std::size_t>(d)];
    if (const auto from = kFrom.find(letter); from != std::string::npos) {
      directions(static_cast<Eigen::Index>(from), d) = 1.0;
    } else if (const auto to = kTo.find(letter); to != std::string::npos) {
      directions(static_cast<Eigen::Index>(to), d) = -1.0;
    } else {
      wrong();
    }
  }
  if (std::abs(directions.determinant()) < 0.5) wrong();
  return directions;
}

void place(const TextHeader& header, std::size_t axes, MedicalVolume& volume) {
  const double unit_m = unit_of(header);
  Eigen::Vector3d spacing = Eigen::Vector3d::Ones();
  volume.spacing_known = false;
  const auto said =
      first_of(header, {{"elementspacing", "ElementSpacing"}, {"elementsize", "ElementSize"}});
  if (said) {
    const auto numbers = finite_numbers(header.path, said->name, header.at(said->key), axes);
    for (int d = 0; d < 3; ++d) {
      spacing[d] = numbers[static_cast<std::size_t>(d)];
      check_spacing(header.path, said->name, spacing[d]);
    }
    volume.spacing_known = true;
  }
  Eigen::Matrix3d directions = Eigen::Matrix3d::Identity();
  const auto sides = directions_of_sides(header);
  const auto matrix = first_of(header, {{"transformmatrix", "TransformMatrix"},
                                        {"rotation", "Rotation"},
                                        {"orientation", "Orientation"}});
  if (matrix) {
    // An axis after the other.
    const auto numbers =
        finite_numbers(header.path, matrix->name, header.at(matrix->key), axes * axes);
    for (int d = 0; d < 3; ++d) {
      for (int row = 0; row < 3; ++row) {
        directions(row, d) =
            numbers[static_cast<std::size_t>(d) * axes + static_cast<std::size_t>(row)];
      }
    }
    constexpr double kAside = 0.9;  // less than 45 degrees apart in each axis, and they agree
    if (sides && ((*sides).transpose() * directions).diagonal().minCoeff() < 1.0 - kAside) {
      volume.warnings.push_back("AnatomicalOrientation " + header.at("anatomicalorientation") +
                                " is not what " + matrix->name + " says, which is taken");
    }
  } else if (sides) {
    directions = *sides;
  }
  set_steps(volume, matrix ? matrix->name : "ElementSpacing", directions * spacing.asDiagonal(),
            unit_m);
  const auto offset =
      first_of(header, {{"offset", "Offset"}, {"position", "Position"}, {"origin", "Origin"}});
  if (offset) {
    const auto numbers = finite_numbers(header.path, offset->name, header.at(offset->key), axes);
    volume.origin_m = Eigen::Vector3d(numbers.data()) * unit_m;
  }
}

/// How the data lie in their files.
struct DataPlan {
  std::vector<std::string> files;
  std::uint64_t begin = 0, each = 0;  // bytes; of the values of a file, unpacked
  bool text = false, packed = false, exact = true;
  std::optional<std::uint64_t> packed_bytes;
};

DataPlan plan_data(const TextHeader& header, NumberType type, std::uint64_t voxels) {
  DataPlan plan;
  const bool local = lower_case(header.at("elementdatafile")) == "local";
  plan.files = local ? std::vector<std::string>{header.path}
                     : data_files(header, "elementdatafile", "ElementDataFile");
  plan.each = values_per_file(header, "ElementDataFile", voxels, plan.files.size()) * type.bytes;
  plan.text = !is_true(header, "binarydata", "BinaryData", true);
  plan.packed = is_true(header, "compresseddata", "CompressedData", false);
  if (plan.packed && (plan.text || plan.files.size() > 1)) {
    throw InputError(header.path, "CompressedData", "True", "False for text or for several files");
  }
  plan.begin = local ? header.bytes : 0;
  const std::uint64_t bytes = std::filesystem::file_size(plan.files.front());
  const std::uint64_t held = bytes - std::min(bytes, plan.begin);
  if (header.has("headersize")) {
    const auto skip = number<std::int64_t>(header.at("headersize"));
    if (!skip || *skip < -1 || (*skip < 0 && (plan.packed || plan.text))) {
      throw InputError(header.path, "HeaderSize", header.at("headersize"),
                       "a number of bytes, or -1 for plain data at the end");
    }
    if (*skip > 0) plan.begin += static_cast<std::uint64_t>(*skip);
    if (*skip < 0) plan.begin = bytes - std::min(bytes, plan.each);
    plan.exact = *skip == 0;
  }
  if (header.has("compresseddatasize") && plan.packed) {
    plan.packed_bytes = number<std::uint64_t>(header.at("compresseddatasize"));
    if (!plan.packed_bytes) {
      throw InputError(header.path, "CompressedDataSize", header.at("compresseddatasize"),
                       "a number of bytes");
    }
  }
  // Before memory is taken.
  const std::uint64_t least =
      plan.packed ? std::max(plan.packed_bytes.value_or(0), plan.each / kMaxDeflateRatio)
      : plan.text ? 2 * (voxels / plan.files.size()) - 1
                  : plan.each;
  const bool exact = !plan.packed && !plan.text && plan.exact;
  check_data_bytes(plan.files.front(), held, least,
                   exact ? DataLength::kExact : DataLength::kAtLeast);
  return plan;
}

void read_data(const TextHeader& header, const DataPlan& plan, NumberType type,
               std::span<float> values) {
  const bool big_endian = is_true(
      header, header.has("elementbyteordermsb") ? "elementbyteordermsb" : "binarydatabyteordermsb",
      "BinaryDataByteOrderMSB", false);
  const std::size_t each = values.size() / plan.files.size();
  for (std::size_t f = 0; f < plan.files.size(); ++f) {
    const std::string& file = plan.files[f];
    const std::span<float> part = values.subspan(f * each, each);
    std::unique_ptr<ByteSource> source = open_file(file, plan.begin);
    if (plan.packed) source = inflated(file, std::move(source));
    if (plan.text) {
      read_decimals(file, *source, part);
      continue;
    }
    read_numbers(file, *source, type, big_endian, part);
    check_end(file, *source, plan.each);
    if (plan.packed_bytes && source->taken() != *plan.packed_bytes) {
      throw InputError(file, "CompressedDataSize", std::to_string(*plan.packed_bytes),
                       std::to_string(source->taken()) + ", the length of the stream");
    }
  }
}

/// Grey values that are not what is stored but a line through it.
void scale(const TextHeader& header, std::span<float> values) {
  const auto one = [&](const char* key, const char* name, double otherwise) {
    return header.has(key) ? finite_numbers(header.path, name, header.at(key), 1).front()
                           : otherwise;
  };
  const double slope = one("elementtointensityfunctionslope", "ElementToIntensityFunctionSlope", 1);
  const double offset =
      one("elementtointensityfunctionoffset", "ElementToIntensityFunctionOffset", 0);
  rescale(values, slope, offset);
}

}  // namespace

MedicalVolume read_meta_image_volume(const std::string& path, const InputLimits& limits) {
  const TextHeader header = read_meta_image_text(path);
  for (const auto& [key, name] : {std::pair{"dimsize", "DimSize"},
                                  {"elementtype", "ElementType"},
                                  {"elementdatafile", "ElementDataFile"}}) {
    if (!header.has(key)) throw InputError(path, name, "no such field", "a MetaImage file");
  }
  if (const std::string& channels = header.at("elementnumberofchannels");
      !channels.empty() && channels != "1") {
    throw InputError(path, "ElementNumberOfChannels", channels, "1");
  }
  const std::vector<std::int64_t> sizes =
      sizes_of(header, {"dimsize", "DimSize"}, {"ndims", "NDims"});
  const std::uint64_t voxels = checked_voxel_count(path, "DimSize", sizes, limits);
  check_three_axes(path, sizes);
  const NumberType type = number_type(header);
  MedicalVolume volume;
  volume.file = path;
  place(header, sizes.size(), volume);
  const DataPlan plan = plan_data(header, type, voxels);
  set_sizes(volume, sizes);
  read_data(header, plan, type, volume.values);
  scale(header, volume.values);
  return volume;
}

}  // namespace sulcus
