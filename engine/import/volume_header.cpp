#include "engine/import/volume_header.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include <zlib.h>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"

namespace sulcus {
namespace {

// In any unit; beyond these the inverse of a direction is no good number.
constexpr double kLeastSpacing = 1e-9, kMostSpacing = 1e9;
constexpr std::int64_t kMaxVoxelsPerAxis = 1 << 24;
constexpr std::size_t kNiftiHeaderBytes = 348;
// No deflate stream expands by more than this [zlib, "Maximum Compression Factor": 1032].
constexpr std::uint64_t kMaxDeflateRatio = 1032;

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> result;
  for (std::string word; in >> word;) result.push_back(word);
  return result;
}

template <class Number>
std::optional<Number> number(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::vector<std::int64_t> parse_sizes(const std::string& path, const std::string& place,
                                      const std::string& text) {
  std::vector<std::int64_t> sizes;
  for (const std::string& word : words(text)) {
    const auto value = number<std::int64_t>(word);
    if (!value) throw InputError(path, place, "\"" + word + "\"", "a whole number of voxels");
    sizes.push_back(*value);
  }
  return sizes;
}

std::uint64_t file_bytes(const std::string& path) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  return error ? 0 : bytes;
}

/// `exact`: the data are raw, and nothing else may follow them.
void check_data_bytes(const std::string& path, std::uint64_t held, std::uint64_t announced,
                      bool exact) {
  if (held < announced || (exact && held != announced)) {
    throw InputError(
        path, "data", std::to_string(held) + " bytes",
        (exact ? "" : "at least ") + std::to_string(announced) + " bytes after the header");
  }
}

std::uint64_t least_deflated(std::uint64_t bytes) { return bytes / kMaxDeflateRatio; }

struct TextHeader {
  std::map<std::string, std::string> fields;  // keys in lower case
  std::uint64_t bytes = 0;                    // up to and with the line that ends it
};

/// Lines up to `ends(key)`, or up to an empty line where that ends the header.
template <class Ends>
TextHeader read_text_header(const std::string& path, char separator, bool empty_line_ends,
                            Ends ends) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path, "", "no readable file", "a volume");
  TextHeader header;
  for (std::string line; std::getline(in, line);) {
    header.bytes += line.size() + (in.eof() ? 0 : 1);
    if (header.bytes > kMaxHeaderBytes) {
      throw InputError(path, "header", "more than 1 MiB of text", "a header that ends");
    }
    if (trimmed(line).empty()) {
      if (empty_line_ends) return header;
      continue;
    }
    if (line.front() == '#') continue;
    const auto colon = line.find(separator);
    if (colon == std::string::npos) continue;
    const std::string key = lower_case(trimmed(std::string_view(line).substr(0, colon)));
    const auto [field, first] =
        header.fields.try_emplace(key, trimmed(std::string_view(line).substr(colon + 1)));
    // The library may take the other one.
    if (!first) throw InputError(path, key, "the field twice", "it once");
    if (ends(key)) return header;
  }
  return header;
}

std::string beside(const std::string& path, const std::string& name) {
  const std::filesystem::path file(name);
  return file.is_absolute() ? name : (std::filesystem::path(path).parent_path() / file).string();
}

std::optional<std::uint64_t> nrrd_type_bytes(const std::string& type) {
  static const std::map<std::string, std::uint64_t> kBytes = {{"signed char", 1},
                                                              {"int8", 1},
                                                              {"int8_t", 1},
                                                              {"uchar", 1},
                                                              {"unsigned char", 1},
                                                              {"uint8", 1},
                                                              {"uint8_t", 1},
                                                              {"short", 2},
                                                              {"short int", 2},
                                                              {"signed short", 2},
                                                              {"signed short int", 2},
                                                              {"int16", 2},
                                                              {"int16_t", 2},
                                                              {"ushort", 2},
                                                              {"unsigned short", 2},
                                                              {"unsigned short int", 2},
                                                              {"uint16", 2},
                                                              {"uint16_t", 2},
                                                              {"int", 4},
                                                              {"signed int", 4},
                                                              {"int32", 4},
                                                              {"int32_t", 4},
                                                              {"uint", 4},
                                                              {"unsigned int", 4},
                                                              {"uint32", 4},
                                                              {"uint32_t", 4},
                                                              {"longlong", 8},
                                                              {"long long", 8},
                                                              {"long long int", 8},
                                                              {"signed long long", 8},
                                                              {"signed long long int", 8},
                                                              {"int64", 8},
                                                              {"int64_t", 8},
                                                              {"ulonglong", 8},
                                                              {"unsigned long long", 8},
                                                              {"unsigned long long int", 8},
                                                              {"uint64", 8},
                                                              {"uint64_t", 8},
                                                              {"float", 4},
                                                              {"double", 8}};
  const auto found = kBytes.find(type);
  if (found == kBytes.end()) return std::nullopt;
  return found->second;
}

std::optional<std::uint64_t> nifti_type_bytes(int type) {
  // DT_UINT8, INT16, INT32, FLOAT32, FLOAT64, INT8, UINT16, UINT32, INT64, UINT64 [nifti1.h].
  static const std::map<int, std::uint64_t> kBytes = {
      {2, 1}, {4, 2}, {8, 4}, {16, 4}, {64, 8}, {256, 1}, {512, 2}, {768, 4}, {1024, 8}, {1280, 8}};
  const auto found = kBytes.find(type);
  if (found == kBytes.end()) return std::nullopt;
  return found->second;
}

/// A file, gzip or plain. The library fills what is missing of a truncated .gz with zeros, so it is
/// read through here.
class PackedFile {
 public:
  explicit PackedFile(const std::string& path)
      : path_(path), file_(gzopen(path.c_str(), "rb"), gzclose_r) {
    if (!file_) throw InputError(path, "", "no readable file", "a volume");
  }

  /// Fills `begin` with what comes first; how much there was.
  std::uint64_t read_begin(std::span<char> begin) {
    const int got = gzread(file_.get(), begin.data(), static_cast<unsigned>(begin.size()));
    read_ = static_cast<std::uint64_t>(std::max(got, 0));
    failed_ = got < 0;
    return read_;
  }
  /// The length of all that it holds, unpacked; throws where that is more than `most`, so that a
  /// small file cannot keep us busy for long.
  std::uint64_t length(std::uint64_t most) {
    if (!failed_ && gzdirect(file_.get()) != 0) return file_bytes(path_);
    std::vector<char> buffer(std::size_t{1} << 18);
    for (int got = 1; !failed_ && got > 0;) {
      got = gzread(file_.get(), buffer.data(), static_cast<unsigned>(buffer.size()));
      read_ += static_cast<std::uint64_t>(std::max(got, 0));
      failed_ = got < 0;
      if (read_ > most) {
        throw InputError(path_, "data", "more than " + std::to_string(most) + " bytes, unpacked",
                         "what the header says");
      }
    }
    int error = Z_OK;
    gzerror(file_.get(), &error);
    if (failed_ || error != Z_OK) {
      throw InputError(path_, "data", "compressed data that break off or are damaged",
                       "a whole gzip stream");
    }
    return read_;
  }

 private:
  const std::string& path_;
  std::unique_ptr<gzFile_s, int (*)(gzFile)> file_;
  std::uint64_t read_ = 0;
  bool failed_ = false;
};

double nrrd_length_unit(const std::string& path, const std::string& text) {
  static const std::map<std::string, double> kUnits = {
      {"mm", 1e-3},         {"millimeter", 1e-3},  {"millimeters", 1e-3},
      {"millimetre", 1e-3}, {"millimetres", 1e-3}, {"cm", 1e-2},
      {"centimeter", 1e-2}, {"centimeters", 1e-2}, {"m", 1.0},
      {"meter", 1.0},       {"meters", 1.0},       {"um", 1e-6},
      {"\xc2\xb5m", 1e-6},  {"\xce\xbcm", 1e-6},   {"micron", 1e-6},
      {"microns", 1e-6},    {"micrometer", 1e-6},  {"micrometers", 1e-6},
      {"nm", 1e-9}};
  std::optional<double> unit;
  // "mm" "mm" "mm": each in quotes. An unknown or empty one says nothing, and mm are taken.
  for (std::size_t open = text.find('"'); open != std::string::npos;) {
    const std::size_t close = text.find('"', open + 1);
    if (close == std::string::npos) break;
    const auto found = kUnits.find(lower_case(trimmed(text.substr(open + 1, close - open - 1))));
    if (found != kUnits.end()) {
      if (unit && *unit != found->second) {
        throw InputError(path, "space units", text, "the same unit along each axis");
      }
      unit = found->second;
    }
    open = text.find('"', close + 1);
  }
  return unit.value_or(1e-3);
}

void check_nrrd_data(const std::string& path, const TextHeader& header, std::uint64_t voxels,
                     std::uint64_t announced) {
  const auto field = [&](const char* name) {
    const auto found = header.fields.find(name);
    return found == header.fields.end() ? std::string{} : lower_case(found->second);
  };
  std::string data_path = path;
  std::uint64_t held = 0;
  for (const char* name : {"data file", "datafile"}) {
    const auto found = header.fields.find(name);
    if (found == header.fields.end()) continue;
    // A list of files or a numbered pattern has no length that could be checked.
    if (words(found->second).size() != 1 || lower_case(found->second) == "list") {
      throw InputError(path, "data file", "\"" + found->second + "\"", "one file");
    }
    data_path = beside(path, found->second);
    if (!std::filesystem::is_regular_file(data_path)) {
      throw InputError(path, "data file", "\"" + found->second + "\"", "a file that exists");
    }
  }
  const std::uint64_t bytes = file_bytes(data_path);
  held = data_path == path ? bytes - std::min(bytes, header.bytes) : bytes;
  const std::string encoding = field("encoding");
  const bool skips = header.fields.contains("byte skip") || header.fields.contains("byteskip") ||
                     header.fields.contains("line skip") || header.fields.contains("lineskip");
  if (encoding == "raw") {
    check_data_bytes(data_path, held, announced, !skips);
  } else if (encoding == "gzip" || encoding == "gz") {
    // The library would hold all that the stream unpacks to.
    for (const char* name : {"byte skip", "byteskip"}) {
      if (number<std::int64_t>(field(name)).value_or(0) >= 0) continue;
      throw InputError(path, name, field(name), "0 or more before compressed data");
    }
    check_data_bytes(data_path, held, least_deflated(announced), false);
  } else if (encoding == "ascii" || encoding == "text" || encoding == "txt") {
    // A digit each, and what stands between them.
    check_data_bytes(data_path, held, 2 * voxels - 1, false);
  } else if (encoding == "hex") {
    check_data_bytes(data_path, held, 2 * announced, false);
  } else {
    throw InputError(path, "encoding", "\"" + encoding + "\"", "raw, gzip, ascii or hex");
  }
}

}  // namespace

std::uint64_t checked_voxel_count(const std::string& path, const std::string& place,
                                  std::span<const std::int64_t> sizes, const InputLimits& limits) {
  std::uint64_t count = 1;
  for (const std::int64_t size : sizes) {
    if (size <= 0) throw InputError(path, place, std::to_string(size), "at least 1 voxel");
    // Compared by division: the product itself may not fit in 64 bits.
    if (size > kMaxVoxelsPerAxis || static_cast<std::uint64_t>(size) > limits.voxels() / count) {
      std::string text;
      for (const std::int64_t s : sizes) text += (text.empty() ? "" : " x ") + std::to_string(s);
      throw InputError(path, place, text + " voxels",
                       "at most " + std::to_string(limits.voxels()) + " (--limit-gib)");
    }
    count *= static_cast<std::uint64_t>(size);
  }
  return count;
}

void check_spacing(const std::string& path, const std::string& place, double spacing) {
  if (spacing >= kLeastSpacing && spacing <= kMostSpacing) return;
  std::ostringstream found;
  found << spacing;
  throw InputError(path, place, found.str(), "a positive length");
}

VolumeHeaderFacts check_nrrd_header(const std::string& path, const InputLimits& limits) {
  const TextHeader header =
      read_text_header(path, ':', true, [](const std::string&) { return false; });
  {
    std::array<char, 4> magic{};
    std::ifstream(path, std::ios::binary).read(magic.data(), magic.size());
    if (std::memcmp(magic.data(), "NRRD", 4) != 0) {
      throw InputError(path, "line 1", "no \"NRRD\"", "an NRRD file");
    }
  }
  const auto field = [&](const char* name) -> const std::string& {
    const auto found = header.fields.find(name);
    if (found == header.fields.end()) throw InputError(path, name, "no such field", "one");
    return found->second;
  };
  const std::vector<std::int64_t> sizes = parse_sizes(path, "sizes", field("sizes"));
  const auto dimension = number<int>(field("dimension"));
  if (!dimension || *dimension != static_cast<int>(sizes.size())) {
    throw InputError(path, "sizes", std::to_string(sizes.size()) + " numbers",
                     "as many as dimension says (" + field("dimension") + ")");
  }
  const std::uint64_t voxels = checked_voxel_count(path, "sizes", sizes, limits);
  const std::string type = lower_case(field("type"));
  const auto type_bytes = nrrd_type_bytes(type);
  if (!type_bytes) throw InputError(path, "type", "\"" + type + "\"", "a number type");

  VolumeHeaderFacts facts;
  facts.spacing_known = false;
  if (const auto found = header.fields.find("spacings"); found != header.fields.end()) {
    for (const std::string& word : words(found->second)) {
      // NaN marks an axis that is not spatial.
      if (lower_case(word) == "nan" && sizes.size() > 3) continue;
      check_spacing(path, "spacings", number<double>(word).value_or(std::nan("")));
    }
    facts.spacing_known = true;
  }
  facts.spacing_known |= header.fields.contains("space directions");
  if (const auto found = header.fields.find("space units"); found != header.fields.end()) {
    facts.length_unit_m = nrrd_length_unit(path, found->second);
  } else if (const auto units = header.fields.find("units"); units != header.fields.end()) {
    facts.length_unit_m = nrrd_length_unit(path, units->second);
  }
  check_nrrd_data(path, header, voxels, voxels * *type_bytes);
  return facts;
}

VolumeHeaderFacts check_meta_image_header(const std::string& path, const InputLimits& limits) {
  const TextHeader header = read_text_header(
      path, '=', false, [](const std::string& key) { return key == "elementdatafile"; });
  const auto field = [&](const char* name) {
    const auto found = header.fields.find(name);
    return found == header.fields.end() ? std::string{} : found->second;
  };
  for (const char* name : {"dimsize", "elementtype", "elementdatafile"}) {
    if (field(name).empty()) throw InputError(path, name, "no such field", "a MetaImage file");
  }
  const std::string channels = field("elementnumberofchannels");
  if (!channels.empty() && channels != "1") {
    throw InputError(path, "ElementNumberOfChannels", channels, "1");
  }
  const std::vector<std::int64_t> sizes = parse_sizes(path, "DimSize", field("dimsize"));
  const auto dimension = number<int>(field("ndims"));
  if (!dimension || *dimension != static_cast<int>(sizes.size())) {
    throw InputError(path, "DimSize", std::to_string(sizes.size()) + " numbers",
                     "as many as NDims says (" + field("ndims") + ")");
  }
  const std::uint64_t voxels = checked_voxel_count(path, "DimSize", sizes, limits);

  static const std::map<std::string, std::uint64_t> kBytes = {
      {"MET_CHAR", 1},      {"MET_UCHAR", 1},      {"MET_SHORT", 2}, {"MET_USHORT", 2},
      {"MET_INT", 4},       {"MET_UINT", 4},       {"MET_FLOAT", 4}, {"MET_DOUBLE", 8},
      {"MET_LONG_LONG", 8}, {"MET_ULONG_LONG", 8}, {"MET_LONG", 4},  {"MET_ULONG", 4}};
  const auto type = kBytes.find(field("elementtype"));
  if (type == kBytes.end()) {
    throw InputError(path, "ElementType", "\"" + field("elementtype") + "\"", "a scalar MET_ type");
  }
  VolumeHeaderFacts facts;
  facts.spacing_known = false;
  for (const char* name : {"elementspacing", "elementsize"}) {
    const std::string text = field(name);
    if (text.empty()) continue;
    facts.spacing_known = true;
    for (const std::string& word : words(text)) {
      check_spacing(path,
                    name == std::string_view("elementsize") ? "ElementSize" : "ElementSpacing",
                    number<double>(word).value_or(std::nan("")));
    }
  }
  const std::string data = field("elementdatafile");
  const bool local = lower_case(data) == "local";
  // One file a slice has no length that could be checked.
  if (!local && (words(data).size() != 1 || lower_case(data) == "list" ||
                 data.find('%') != std::string::npos)) {
    throw InputError(path, "ElementDataFile", "\"" + data + "\"", "LOCAL or one file");
  }
  const std::string data_path = local ? path : beside(path, data);
  if (!std::filesystem::is_regular_file(data_path)) {
    throw InputError(path, "ElementDataFile", "\"" + data + "\"", "a file that exists");
  }
  const std::uint64_t bytes = file_bytes(data_path);
  const std::uint64_t held = local ? bytes - std::min(bytes, header.bytes) : bytes;
  const std::uint64_t announced = voxels * type->second;
  if (lower_case(field("compresseddata")).starts_with("t")) {
    // The stream's own length, where it is said, shows a file that was cut off.
    const std::string said = field("compresseddatasize");
    const auto stream = number<std::uint64_t>(said);
    if (!stream && !said.empty()) {
      throw InputError(path, "CompressedDataSize", said, "a number of bytes");
    }
    check_data_bytes(data_path, held, std::max(stream.value_or(0), least_deflated(announced)),
                     false);
  } else {
    check_data_bytes(data_path, held, announced, field("headersize").empty());
  }
  return facts;
}

namespace {

/// Where the values of a NIfTI file lie, by its header.
struct NiftiData {
  std::uint64_t offset = 0, bytes = 0;
  bool here = false;  // and not in an .img beside it
};

NiftiData nifti_data(const std::string& path, std::span<const char> raw,
                     const InputLimits& limits) {
  const auto swapped = [](auto value) {
    auto bytes = std::array<char, sizeof(value)>{};
    std::memcpy(bytes.data(), &value, sizeof(value));
    std::ranges::reverse(bytes);
    std::memcpy(&value, bytes.data(), sizeof(value));
    return value;
  };
  const auto raw_value = [&](auto value, std::size_t offset) {
    std::memcpy(&value, raw.data() + offset, sizeof(value));
    return value;
  };
  const std::int32_t header_bytes = raw_value(std::int32_t{}, 0);
  const bool swap = swapped(header_bytes) == 348;
  if (header_bytes != 348 && !swap) {
    if (header_bytes == 540 || swapped(header_bytes) == 540) {
      throw InputError(path, "sizeof_hdr", "540, NIfTI-2", "348, NIfTI-1");
    }
    throw InputError(path, "sizeof_hdr", std::to_string(header_bytes), "348");
  }
  const auto value = [&](auto type, std::size_t offset) {
    const auto v = raw_value(type, offset);
    return swap ? swapped(v) : v;
  };
  const int dimensions = value(std::int16_t{}, 40);
  if (dimensions < 1 || dimensions > 7) {
    throw InputError(path, "dim[0]", std::to_string(dimensions), "3");
  }
  std::vector<std::int64_t> sizes;
  for (int d = 1; d <= dimensions; ++d) {
    sizes.push_back(value(std::int16_t{}, 40 + 2 * static_cast<std::size_t>(d)));
  }
  const std::uint64_t voxels = checked_voxel_count(path, "dim", sizes, limits);
  for (int d = 1; d <= std::min(dimensions, 3); ++d) {
    // The sign of pixdim has no meaning in NIfTI, its size has.
    check_spacing(path, "pixdim", std::abs(value(float{}, 76 + 4 * static_cast<std::size_t>(d))));
  }
  // quatern_b to qoffset_z, srow_x to srow_z: the library ends the program over what is not finite.
  for (std::size_t field = 256; field < 328; field += sizeof(float)) {
    const float number = value(float{}, field);
    if (std::abs(number) <= 1e9f) continue;
    std::ostringstream found;
    found << number;
    throw InputError(path, "orientation", found.str(), "numbers up to 1e9");
  }
  const int type = value(std::int16_t{}, 70);
  const auto bytes_each = nifti_type_bytes(type);
  if (!bytes_each) throw InputError(path, "datatype", std::to_string(type), "a scalar type");
  // "n+1": header and data in one file; "ni1": the data lie in an .img beside it.
  if (std::memcmp(raw.data() + 344, "n+1", 3) != 0) return {};
  const double offset = value(float{}, 108);
  const std::uint64_t skip =
      offset >= 348.0 && offset < 1e9 ? static_cast<std::uint64_t>(offset) : std::uint64_t{352};
  return {skip, voxels * *bytes_each, true};
}

}  // namespace

void check_nifti_header(const std::string& path, const InputLimits& limits) {
  std::array<char, kNiftiHeaderBytes> raw{};
  PackedFile file(path);
  if (const std::uint64_t held = file.read_begin(raw); held < raw.size()) {
    throw InputError(path, "header", std::to_string(held) + " bytes",
                     std::to_string(raw.size()) + " bytes");
  }
  const NiftiData data = nifti_data(path, raw, limits);
  constexpr std::uint64_t kMoreBehind = std::uint64_t{1} << 20;
  const std::uint64_t held = file.length(data.offset + data.bytes + kMoreBehind);
  if (!data.here) return;
  check_data_bytes(path, held - std::min(held, data.offset), data.bytes, false);
}

}  // namespace sulcus
