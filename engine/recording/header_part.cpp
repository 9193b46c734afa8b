#include <algorithm>
#include <cmath>

#include "engine/core/error.hpp"
#include "engine/core/hash.hpp"
#include "engine/recording/hdf5_fixed.hpp"
#include "engine/recording/recording_parts.hpp"

namespace sulcus {
namespace {

constexpr char kFormatName[] = "sulcus-recording";
constexpr std::uint64_t kMaxSceneBytes = 16u << 20;
constexpr std::uint64_t kMaxShortText = 4096;

/// What the attribute `header_check` holds for a header of its version.
std::uint64_t header_check(const RecordingHeader& header) {
  std::uint64_t hash = hash_bytes(&header.version, sizeof header.version);
  const auto add = [&](const std::string& text) {
    const std::uint64_t length = text.size();
    hash = hash_bytes(&length, sizeof length, hash);
    hash = hash_bytes(text.data(), text.size(), hash);
  };
  for (const std::string* text : {&header.scene_toml, &header.scene_sha256, &header.build}) {
    add(*text);
  }
  if (header.version > 1) {
    add(header.parent);
    add(header.repaired);
  }
  hash = hash_bytes(&header.rate_hz, sizeof header.rate_hz, hash);
  return hash_bytes(&header.workpiece_hash, sizeof header.workpiece_hash, hash);
}

void check_format(const Hdf5Handle& file, const std::string& path) {
  if (H5Aexists(file, "format") <= 0) {
    throw InputError(path, "format", "an HDF5 file without it", kFormatName);
  }
  const std::string format = read_text_attribute(file, "format", kMaxShortText);
  if (format != kFormatName) throw InputError(path, "format", '"' + format + '"', kFormatName);
  std::uint64_t version = 0;
  read_attribute(file, "version", H5T_NATIVE_UINT64, &version);
  if (version < 1 || version > kRecordingVersion) {
    throw InputError(
        path, "version", std::to_string(version),
        "1 to " + std::to_string(kRecordingVersion) + ", the newest that this program reads");
  }
}

/// Text that is only there where it says something.
std::string read_optional_text(const Hdf5Handle& file, const char* name) {
  return H5Aexists(file, name) > 0 ? read_text_attribute(file, name, kMaxShortText) : "";
}

}  // namespace

void write_header(const Hdf5Handle& file, const RecordingHeader& header) {
  write_text_attribute(file, "format", kFormatName);
  write_attribute(file, "version", H5T_STD_U32LE, &header.version);
  write_text_attribute(file, "scene", header.scene_toml);
  write_text_attribute(file, "scene_sha256", header.scene_sha256);
  write_attribute(file, "workpiece_hash", H5T_STD_U64LE, &header.workpiece_hash);
  write_text_attribute(file, "build", header.build);
  write_attribute(file, "rate_hz", H5T_IEEE_F64LE, &header.rate_hz);
  if (!header.parent.empty()) write_text_attribute(file, "parent", header.parent);
  if (!header.repaired.empty()) write_text_attribute(file, "repaired", header.repaired);
  const std::uint64_t check = header_check(header);
  write_attribute(file, "header_check", H5T_STD_U64LE, &check);
}

RecordingHeader read_header(const Hdf5Handle& file, const std::string& path,
                            std::uint64_t file_bytes) {
  check_format(file, path);
  RecordingHeader header;
  header.scene_toml = read_text_attribute(file, "scene", std::min(kMaxSceneBytes, file_bytes));
  header.scene_sha256 = read_text_attribute(file, "scene_sha256", kMaxShortText);
  header.build = read_text_attribute(file, "build", kMaxShortText);
  read_attribute(file, "rate_hz", H5T_NATIVE_DOUBLE, &header.rate_hz);
  read_attribute(file, "workpiece_hash", H5T_NATIVE_UINT64, &header.workpiece_hash);
  read_attribute(file, "version", H5T_NATIVE_UINT32, &header.version);
  header.parent = read_optional_text(file, "parent");
  header.repaired = read_optional_text(file, "repaired");
  std::uint64_t check = 0;
  read_attribute(file, "header_check", H5T_NATIVE_UINT64, &check);
  if (check != header_check(header)) {
    throw Hdf5Error("attributes: their header_check does not fit, one was changed");
  }
  if (!(std::isfinite(header.rate_hz) && header.rate_hz > 0.0)) {
    throw Hdf5Error("rate_hz: not a positive number");
  }
  return header;
}

}  // namespace sulcus
