#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/import/volumes/byte_source.hpp"
#include "engine/import/volumes/text_header.hpp"
#include "engine/import/volumes/volume_checks.hpp"
#include "engine/import/volumes/volume_readers.hpp"

namespace sulcus {
namespace {

using Kind = NumberType::Kind;

std::optional<NumberType> number_type(const std::string& name) {
  static const std::map<std::string, NumberType> kTypes = [] {
    std::map<std::string, NumberType> types;
    const auto add = [&](Kind kind, std::size_t bytes, std::initializer_list<const char*> names) {
      for (const char* n : names) types[n] = {kind, bytes};
    };
    add(Kind::kSigned, 1, {"signed char", "int8", "int8_t"});
    add(Kind::kUnsigned, 1, {"uchar", "unsigned char", "uint8", "uint8_t"});
    add(Kind::kSigned, 2,
        {"short", "short int", "signed short", "signed short int", "int16", "int16_t"});
    add(Kind::kUnsigned, 2,
        {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"});
    add(Kind::kSigned, 4, {"int", "signed int", "int32", "int32_t"});
    add(Kind::kUnsigned, 4, {"uint", "unsigned int", "uint32", "uint32_t"});
    add(Kind::kSigned, 8,
        {"longlong", "long long", "long long int", "signed long long", "signed long long int",
         "int64", "int64_t"});
    add(Kind::kUnsigned, 8,
        {"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"});
    add(Kind::kFloat, 4, {"float"});
    add(Kind::kFloat, 8, {"double"});
    return types;
  }();
  const auto found = kTypes.find(name);
  return found == kTypes.end() ? std::nullopt : std::optional(found->second);
}

/// How long 1 is, in m; none: the text names no unit. @throws InputError: one that is not known.
std::optional<double> length_of_unit(const TextHeader& header, const char* field,
                                     const std::string& name) {
  static const std::map<std::string, double> kUnits = [] {
    std::map<std::string, double> units;
    const auto add = [&](double metres, std::initializer_list<const char*> names) {
      for (const char* n : names) units[n] = metres;
    };
    add(1.0, {"m", "meter", "meters", "metre", "metres"});
    add(1e-2, {"cm", "centimeter", "centimeters", "centimetre", "centimetres"});
    add(1e-3, {"mm", "millimeter", "millimeters", "millimetre", "millimetres"});
    add(1e-6, {"um", "\xc2\xb5m", "\xce\xbcm", "micron", "microns", "micrometer", "micrometers",
               "micrometre", "micrometres"});
    add(1e-9, {"nm", "nanometer", "nanometers", "nanometre", "nanometres"});
    add(25.4e-3, {"in", "inch", "inches"});
    return units;
  }();
  const std::string text = lower_case(trimmed(name));
  if (text.empty() || text == "???" || text == "none") return std::nullopt;
  const auto found = kUnits.find(text);
  if (found == kUnits.end())
    throw InputError(header.path, field, "\"" + name + "\"", "mm, um or another length");
  return found->second;
}

/// What stands in quotes, one after the other; of a text without them, which some write, its words.
std::vector<std::string> quoted(const std::string& text) {
  if (text.find('"') == std::string::npos) return words(text);
  std::vector<std::string> parts;
  for (std::size_t open = text.find('"'); open != std::string::npos;) {
    const std::size_t close = text.find('"', open + 1);
    if (close == std::string::npos) break;
    parts.push_back(text.substr(open + 1, close - open - 1));
    open = text.find('"', close + 1);
  }
  return parts;
}

/// The numbers of "(x,y,z)"; none: no three finite ones.
std::optional<Eigen::Vector3d> vector_of(std::string text) {
  text = trimmed(text);
  if (text.size() < 2 || text.front() != '(' || text.back() != ')') return std::nullopt;
  std::ranges::replace(text, ',', ' ');
  const std::vector<std::string> parts = words(text.substr(1, text.size() - 2));
  if (parts.size() != 3) return std::nullopt;
  Eigen::Vector3d v;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto value = number<double>(parts[d]);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    v[static_cast<Eigen::Index>(d)] = *value;
  }
  return v;
}

/// "none" and "(x,y,z)", which may hold blanks, one after the other.
std::vector<std::string> vectors_and_nones(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t at = text.find_first_not_of(" \t"); at != std::string::npos;) {
    std::size_t end = text[at] == '(' ? text.find(')', at) : text.find_first_of(" \t", at);
    if (end == std::string::npos) end = text.size() - (text[at] == '(' ? 1 : 0);
    if (text[at] == '(') ++end;
    parts.push_back(text.substr(at, end - at));
    at = text.find_first_not_of(" \t", std::min(end, text.size()));
  }
  return parts;
}

/// What of an axis is read.
struct Axis {
  std::int64_t samples = 0;
  std::optional<Eigen::Vector3d> direction;  // in the file's space and unit
  std::optional<double> spacing, least, most;
  std::optional<bool> cell;  // centred in its cell, or at its node
  double unit_m = 1e-3;
  bool of_space = true;
};

/// A field with a word for each axis; empty: no such field.
std::vector<std::string> words_of_axes(const TextHeader& header, const char* name,
                                       std::size_t axes) {
  const std::vector<std::string> parts = words(header.at(name));
  if (!parts.empty() && parts.size() != axes) {
    throw InputError(header.path, name, std::to_string(parts.size()) + " words",
                     "one for each of " + std::to_string(axes) + " axes");
  }
  return parts;
}

std::optional<double> number_or_nan(const TextHeader& header, const char* name,
                                    const std::string& word) {
  if (lower_case(word) == "nan") return std::nullopt;
  const auto value = number<double>(word);
  if (!value || !std::isfinite(*value)) {
    throw InputError(header.path, name, word, "numbers, or NaN for what is not of space");
  }
  return value;
}

bool is_space_kind(const std::string& kind) {
  return kind == "domain" || kind == "space" || kind == "none" || kind == "???";
}

std::vector<Axis> read_axes(const TextHeader& header) {
  const std::vector<std::int64_t> sizes =
      sizes_of(header, {"sizes", "sizes"}, {"dimension", "dimension"});
  std::vector<Axis> axes(sizes.size());
  for (std::size_t a = 0; a < axes.size(); ++a) axes[a].samples = sizes[a];

  const std::vector<std::string> directions = vectors_and_nones(header.at("space directions"));
  if (!directions.empty() && directions.size() != axes.size()) {
    throw InputError(header.path, "space directions", std::to_string(directions.size()),
                     "one for each of " + std::to_string(axes.size()) + " axes");
  }
  for (std::size_t a = 0; a < directions.size(); ++a) {
    if (lower_case(directions[a]) == "none") {
      axes[a].of_space = false;
      continue;
    }
    axes[a].direction = vector_of(directions[a]);
    if (!axes[a].direction) {
      throw InputError(header.path, "space directions", "\"" + directions[a] + "\"",
                       "none or three finite numbers in brackets");
    }
  }
  const auto kinds = words_of_axes(header, "kinds", axes.size());
  for (std::size_t a = 0; a < kinds.size(); ++a) {
    if (!is_space_kind(lower_case(kinds[a]))) axes[a].of_space = false;
  }
  const auto each = [&](const char* name, std::optional<double> Axis::*field) {
    const auto parts = words_of_axes(header, name, axes.size());
    for (std::size_t a = 0; a < parts.size(); ++a) {
      axes[a].*field = number_or_nan(header, name, parts[a]);
    }
  };
  each("spacings", &Axis::spacing);
  each("axis mins", &Axis::least);
  each("axis maxs", &Axis::most);
  const auto centers = words_of_axes(header, "centers", axes.size());
  for (std::size_t a = 0; a < centers.size(); ++a) {
    const std::string center = lower_case(centers[a]);
    if (center == "cell" || center == "node") {
      axes[a].cell = center == "cell";
    } else if (center != "none" && center != "???") {
      throw InputError(header.path, "centers", "\"" + centers[a] + "\"", "cell, node or none");
    }
  }
  const std::vector<std::string> units = quoted(header.at("units"));
  for (std::size_t a = 0; a < std::min(units.size(), axes.size()); ++a) {
    if (axes[a].of_space) axes[a].unit_m = length_of_unit(header, "units", units[a]).value_or(1e-3);
  }
  return axes;
}

/// The three axes of space; others have one sample.
std::array<Axis, 3> space_axes(const TextHeader& header, const std::vector<Axis>& all) {
  std::vector<Axis> left;
  for (const Axis& axis : all) {
    if (!axis.of_space && axis.samples != 1) {
      throw InputError(header.path, header.has("kinds") ? "kinds" : "space directions",
                       "an axis of " + std::to_string(axis.samples) + " that is not of space",
                       "one grey value a voxel");
    }
    if (axis.of_space) left.push_back(axis);
  }
  // Axes behind the third that hold one sample, whatever they are.
  while (left.size() > 3 && left.back().samples == 1) left.pop_back();
  if (left.size() != 3) {
    throw InputError(header.path, "dimension", std::to_string(left.size()), "3");
  }
  return {left[0], left[1], left[2]};
}

/// Rows that turn the file's space into +x left, +y posterior, +z superior; none: a space of three
/// axes without a name.
std::optional<Eigen::Vector3d> signs_of_space(const TextHeader& header) {
  const std::string space = lower_case(header.at("space"));
  static const std::map<std::string, std::array<double, 3>> kSpaces = {
      {"right-anterior-superior", {-1, -1, 1}},
      {"ras", {-1, -1, 1}},
      {"left-anterior-superior", {1, -1, 1}},
      {"las", {1, -1, 1}},
      {"left-posterior-superior", {1, 1, 1}},
      {"lps", {1, 1, 1}},
      {"scanner-xyz", {1, 1, 1}},
      {"3d-right-handed", {1, 1, 1}},
      // Nobody's sides are named; turned over once it is the same solid in a right-handed space.
      {"3d-left-handed", {1, 1, -1}}};
  if (const auto found = kSpaces.find(space); found != kSpaces.end()) {
    return Eigen::Vector3d(found->second.data());
  }
  if (!space.empty()) {
    throw InputError(header.path, "space", "\"" + space + "\"", "a space of three axes");
  }
  const std::string& count = header.at("space dimension");
  if (count.empty()) return std::nullopt;
  if (count != "3") throw InputError(header.path, "space dimension", count, "3");
  return Eigen::Vector3d::Ones();
}

/// Where space directions are said.
void place_in_space(const TextHeader& header, const std::array<Axis, 3>& axes,
                    MedicalVolume& volume) {
  const auto signs = signs_of_space(header);
  if (!signs) {
    throw InputError(header.path, "space", "none beside space directions",
                     "what their numbers are measured in");
  }
  Eigen::Vector3d rows = *signs;
  if (!header.has("space units") && header.has("units")) {
    // Which are for axes without directions, but some write them.
    if (axes[1].unit_m != axes[0].unit_m || axes[2].unit_m != axes[0].unit_m) {
      throw InputError(header.path, "units", header.at("units"), "the same along each axis");
    }
    rows *= axes[0].unit_m * 1e3;
  }
  if (header.has("space units")) {
    // Of the space's axes, each row its own; in mm as long as they are all alike.
    const std::vector<std::string> units = quoted(header.at("space units"));
    if (units.size() != 3) {
      throw InputError(header.path, "space units", std::to_string(units.size()),
                       "one in quotes for each of 3 axes");
    }
    for (std::size_t d = 0; d < 3; ++d) {
      rows[static_cast<Eigen::Index>(d)] *=
          length_of_unit(header, "space units", units[d]).value_or(1e-3) * 1e3;
    }
  }
  Eigen::Matrix3d steps;
  for (int d = 0; d < 3; ++d) {
    const auto& direction = axes[static_cast<std::size_t>(d)].direction;
    if (!direction) {
      throw InputError(header.path, "space directions", "none for an axis of space", "three");
    }
    steps.col(d) = *direction;
  }
  const double unit = std::abs(rows[0]);
  const bool alike = std::abs(rows[1]) == unit && std::abs(rows[2]) == unit;
  if (alike) {
    set_steps(volume, "space directions", rows.cwiseSign().asDiagonal() * steps, unit * 1e-3);
  } else {
    set_steps(volume, "space directions", rows.asDiagonal() * steps, 1e-3);
  }
  for (int d = 0; d < 3; ++d) {
    const auto& spacing = axes[static_cast<std::size_t>(d)].spacing;
    constexpr double kSame = 1e-3;
    if (spacing && std::abs(*spacing - steps.col(d).norm()) > kSame * steps.col(d).norm()) {
      throw InputError(header.path, "spacings", "others than space directions have", "one of them");
    }
  }
  if (!header.has("space origin")) return;
  const auto origin = vector_of(header.at("space origin"));
  if (!origin) {
    throw InputError(header.path, "space origin", "\"" + header.at("space origin") + "\"",
                     "three finite numbers in brackets");
  }
  volume.origin_m = rows.cwiseProduct(*origin) * 1e-3;
}

/// Where there are none: along the axes themselves.
void place_along_axes(const TextHeader& header, const std::array<Axis, 3>& axes,
                      MedicalVolume& volume) {
  for (int d = 0; d < 3; ++d) {
    const Axis& axis = axes[static_cast<std::size_t>(d)];
    std::optional<double> spacing = axis.spacing;
    if (spacing) check_spacing(header.path, "spacings", *spacing);
    if (axis.least && axis.most && axis.cell && (*axis.cell || axis.samples > 1)) {
      const double between =
          (*axis.most - *axis.least) / static_cast<double>(axis.samples - (*axis.cell ? 0 : 1));
      check_spacing(header.path, "axis maxs", between);
      constexpr double kSame = 1e-3;
      if (spacing && std::abs(*spacing - between) > kSame * between) {
        throw InputError(header.path, "spacings", "others than axis mins and maxs say",
                         "one of them");
      }
      if (!spacing) spacing = between;
    }
    volume.spacing_known = volume.spacing_known && spacing.has_value();
    volume.spacing_m[d] = spacing.value_or(1.0) * axis.unit_m;
    // Centred in cells where nothing is said, as teem has it.
    const double first = axis.cell.value_or(true) ? 0.5 * spacing.value_or(0.0) : 0.0;
    if (axis.least) volume.origin_m[d] = (*axis.least + first) * axis.unit_m;
  }
}

/// Bytes up to the end of line `count` from `begin` on.
std::uint64_t bytes_of_lines(const std::string& path, std::uint64_t begin, std::int64_t count) {
  std::ifstream in(path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(begin));
  for (; count > 0; --count) {
    for (int c = in.get(); c != '\n'; c = in.get()) {
      if (!in) throw InputError(path, "line skip", "fewer lines", std::to_string(count) + " more");
    }
  }
  return static_cast<std::uint64_t>(in.tellg()) - begin;
}

/// The data of all files, one after the other.
void read_data(const TextHeader& header, NumberType type, std::span<float> values) {
  const std::string encoding = lower_case(header.need("encoding"));
  const auto skip_of = [&](const char* name, std::int64_t least) {
    if (!header.has(name)) return std::int64_t{0};
    const auto value = number<std::int64_t>(header.at(name));
    if (!value || *value < least) {
      throw InputError(header.path, name, header.at(name), least < 0 ? "-1 or more" : "0 or more");
    }
    return *value;
  };
  const bool raw = encoding == "raw";
  const bool text = encoding == "ascii" || encoding == "text" || encoding == "txt";
  const std::int64_t byte_skip = skip_of("byte skip", raw ? -1 : 0);
  const std::int64_t line_skip = skip_of("line skip", 0);
  const std::string endian = lower_case(header.at("endian"));
  if (!endian.empty() && endian != "little" && endian != "big") {
    throw InputError(header.path, "endian", "\"" + endian + "\"", "little or big");
  }
  if (endian.empty() && type.bytes > 1 && !text) {
    throw InputError(header.path, "endian", "no such field", "little or big");
  }

  const bool attached = !header.has("data file");
  const std::vector<std::string> files = attached ? std::vector<std::string>{header.path}
                                                  : data_files(header, "data file", "data file");
  const std::size_t each = values_per_file(header, "data file", values.size(), files.size());
  const std::uint64_t announced = each * type.bytes;
  for (std::size_t f = 0; f < files.size(); ++f) {
    const std::string& file = files[f];
    const std::span<float> part = values.subspan(f * each, each);
    std::uint64_t begin = attached ? header.bytes : 0;
    begin += bytes_of_lines(file, begin, line_skip);
    if (byte_skip < 0) {
      const std::uint64_t held = std::filesystem::file_size(file);
      if (held < begin + announced) {
        throw InputError(file, "data", std::to_string(held - std::min(held, begin)) + " bytes",
                         std::to_string(announced) + " bytes");
      }
      begin = held - announced;
    }
    std::unique_ptr<ByteSource> source = open_file(file, begin);
    if (encoding == "gzip" || encoding == "gz") {
      source = inflated(file, std::move(source));
    } else if (encoding == "bzip2" || encoding == "bz2") {
      source = bunzipped(file, std::move(source));
    } else if (encoding == "hex") {
      source = from_hex(file, std::move(source));
    } else if (!raw && !text) {
      throw InputError(header.path, "encoding", "\"" + encoding + "\"",
                       "raw, text, hex, gzip or bzip2");
    }
    if (byte_skip > 0) skip_bytes(file, *source, static_cast<std::uint64_t>(byte_skip));
    if (text) {
      read_decimals(file, *source, part);
    } else {
      read_numbers(file, *source, type, endian == "big", part);
      check_end(file, *source, announced);
    }
  }
}

/// Refuses what cannot hold the data before memory is taken for them.
void check_length(const TextHeader& header, NumberType type, std::uint64_t voxels) {
  const std::string encoding = lower_case(header.need("encoding"));
  std::uint64_t held = 0;
  if (header.has("data file")) {
    for (const std::string& file : data_files(header, "data file", "data file")) {
      held += std::filesystem::file_size(file);
    }
  } else {
    const std::uint64_t bytes = std::filesystem::file_size(header.path);
    held = bytes - std::min(bytes, header.bytes);
  }
  const std::uint64_t announced = voxels * type.bytes;
  const bool text = encoding == "ascii" || encoding == "text" || encoding == "txt";
  const std::uint64_t least = encoding == "raw"   ? announced
                              : text              ? 2 * voxels - 1
                              : encoding == "hex" ? 2 * announced
                              : encoding == "bzip2" || encoding == "bz2"
                                  ? announced / kMaxBzip2Ratio
                                  : announced / kMaxDeflateRatio;
  const bool exact = encoding == "raw" && !header.has("byte skip") && !header.has("line skip");
  check_data_bytes(header.path, held, least, exact ? DataLength::kExact : DataLength::kAtLeast);
}

}  // namespace

MedicalVolume read_nrrd_volume(const std::string& path, const InputLimits& limits) {
  const TextHeader header = read_nrrd_text(path);
  const std::vector<Axis> all = read_axes(header);
  std::vector<std::int64_t> sizes;
  sizes.reserve(all.size());
  for (const Axis& axis : all) sizes.push_back(axis.samples);
  const std::uint64_t voxels = checked_voxel_count(path, "sizes", sizes, limits);
  const std::string type_name = lower_case(header.need("type"));
  const auto type = number_type(type_name);
  if (!type) throw InputError(path, "type", "\"" + type_name + "\"", "a number type");
  const std::array<Axis, 3> axes = space_axes(header, all);

  MedicalVolume volume;
  volume.file = path;
  if (header.has("space directions")) {
    place_in_space(header, axes, volume);
  } else {
    place_along_axes(header, axes, volume);
  }
  check_length(header, *type, voxels);
  set_sizes(volume, std::array{axes[0].samples, axes[1].samples, axes[2].samples});
  read_data(header, *type, volume.values);
  return volume;
}

}  // namespace sulcus
