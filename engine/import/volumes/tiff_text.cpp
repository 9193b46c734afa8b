#include "engine/import/volumes/tiff_text.hpp"

#include <map>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/import/volumes/text_header.hpp"

namespace sulcus {
namespace {

/// None: pixels, or nothing.
std::optional<double> unit_of(const std::string& file, const std::string& name) {
  static const std::map<std::string, double> kUnits = {
      {"mm", 1e-3},         {"millimeter", 1e-3}, {"cm", 1e-2},        {"m", 1.0},
      {"um", 1e-6},         {"micron", 1e-6},     {"microns", 1e-6},   {"\\u00b5m", 1e-6},
      {"micrometer", 1e-6}, {"\xc2\xb5m", 1e-6},  {"\xce\xbcm", 1e-6}, {"\xb5m", 1e-6},
      {"nm", 1e-9},         {"inch", 25.4e-3},    {"in", 25.4e-3}};
  const std::string text = lower_case(trimmed(name));
  if (text.empty() || text == "pixel" || text == "pixels") return std::nullopt;
  const auto found = kUnits.find(text);
  if (found == kUnits.end())
    throw InputError(file, "unit", "\"" + name + "\"", "mm, um or another length");
  return found->second;
}

TiffText read_image_j(const std::string& file, const std::string& text) {
  std::map<std::string, std::string> fields;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    if (const auto equals = line.find('='); equals != std::string::npos) {
      fields.try_emplace(line.substr(0, equals), trimmed(line.substr(equals + 1)));
    }
  }
  TiffText found;
  found.slices = number<std::int64_t>(fields["images"]);
  found.others = number<std::int64_t>(fields["channels"]).value_or(1) *
                 number<std::int64_t>(fields["frames"]).value_or(1);
  found.unit_m = unit_of(file, fields["unit"]);
  const auto spacing = number<double>(fields["spacing"]);
  if (spacing && found.unit_m) found.z_m = *spacing * *found.unit_m;
  return found;
}

/// An attribute of an XML tag.
std::string attribute(const std::string& tag, const std::string& name) {
  const std::size_t at = tag.find(" " + name + "=\"");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + name.size() + 3;
  return tag.substr(begin, std::min(tag.find('"', begin), tag.size()) - begin);
}

TiffText read_ome(const std::string& file, const std::string& text) {
  TiffText found;
  const std::size_t begin = text.find("<Pixels ");
  if (begin == std::string::npos) return found;
  const std::string tag = text.substr(begin, text.find('>', begin) - begin);
  found.slices = number<std::int64_t>(attribute(tag, "SizeZ"));
  found.others = number<std::int64_t>(attribute(tag, "SizeC")).value_or(1) *
                 number<std::int64_t>(attribute(tag, "SizeT")).value_or(1);
  if (text.find("<Pixels ", begin + 1) != std::string::npos) ++found.others;
  const auto length = [&](const std::string& name) -> std::optional<double> {
    const auto value = number<double>(attribute(tag, name));
    const std::string unit = attribute(tag, name + "Unit");
    const auto unit_m = unit_of(file, unit.empty() ? "um" : unit);  // as the schema has it
    return value && unit_m ? std::optional(*value * *unit_m) : std::nullopt;
  };
  found.x_m = length("PhysicalSizeX");
  found.y_m = length("PhysicalSizeY");
  found.z_m = length("PhysicalSizeZ");
  return found;
}

}  // namespace

TiffText read_tiff_text(const std::string& file, const std::string& description) {
  if (description.starts_with("ImageJ=")) return read_image_j(file, description);
  if (description.find("<OME") != std::string::npos) return read_ome(file, description);
  return {};
}

}  // namespace sulcus
