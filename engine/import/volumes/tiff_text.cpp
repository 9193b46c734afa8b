#include "engine/import/volumes/tiff_text.hpp"

#include <algorithm>
#include <map>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/import/volumes/text_header.hpp"
#include "engine/import/volumes/xml_tags.hpp"

namespace sulcus {
namespace {

/// None: pixels, or nothing, or `unknown`.
std::optional<double> unit_of(const std::string& name, std::string& unknown) {
  static const std::map<std::string, double> kUnits = {
      {"m", 1.0},           {"meter", 1.0},       {"metre", 1.0},       {"dm", 0.1},
      {"cm", 1e-2},         {"centimeter", 1e-2}, {"centimetre", 1e-2}, {"mm", 1e-3},
      {"millimeter", 1e-3}, {"millimetre", 1e-3}, {"um", 1e-6},         {"micron", 1e-6},
      {"\\u00b5m", 1e-6},   {"\xc2\xb5m", 1e-6},  {"\xce\xbcm", 1e-6},  {"\xb5m", 1e-6},
      {"micrometer", 1e-6}, {"micrometre", 1e-6}, {"nm", 1e-9},         {"nanometer", 1e-9},
      {"nanometre", 1e-9},  {"angstrom", 1e-10},  {"\xc3\x85", 1e-10},  {"\xe2\x84\xab", 1e-10},
      {"\xc5", 1e-10},      {"\\u00c5", 1e-10},   {"pm", 1e-12},        {"in", 25.4e-3},
      {"inch", 25.4e-3},    {"inches", 25.4e-3}};
  const std::string text = lower_case(trimmed(name));
  if (text.empty() || text == "pixel" || text == "pixels" || text == "reference frame") {
    return std::nullopt;
  }
  auto found = kUnits.find(text);
  // "millimeters", and not "mms".
  if (text.size() > 4 && text.ends_with('s') && found == kUnits.end()) {
    found = kUnits.find(text.substr(0, text.size() - 1));
  }
  if (found != kUnits.end()) return found->second;
  unknown = name;
  return std::nullopt;
}

TiffText read_image_j(const std::string& text) {
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
  found.one_stack = number<std::int64_t>(fields["channels"]).value_or(1) == 1 &&
                    number<std::int64_t>(fields["frames"]).value_or(1) == 1;
  found.unit_m = unit_of(fields["unit"], found.unknown_unit);
  const auto spacing = number<double>(fields["spacing"]);
  if (spacing && found.unit_m) found.z_m = *spacing * *found.unit_m;
  return found;
}

/// None: it is not said. @throws InputError: it is said otherwise than by a whole number.
std::optional<std::int64_t> whole_number(const std::string& file, const XmlTag& tag,
                                         const std::string& name) {
  const std::string text = trimmed(tag.at(name));
  const auto value = number<std::int64_t>(text);
  constexpr std::int64_t kMost = std::int64_t{1} << 40;
  if (!text.empty() && (!value || *value < 0 || *value > kMost)) {
    throw InputError(file, "ImageDescription", name + " \"" + text + "\"", "a whole number");
  }
  return value;
}

void take_pixels(const std::string& file, const XmlTag& tag, TiffText& found) {
  found.slices = whole_number(file, tag, "SizeZ");
  found.one_stack = whole_number(file, tag, "SizeC").value_or(1) == 1 &&
                    whole_number(file, tag, "SizeT").value_or(1) == 1;
  const auto length = [&](const std::string& name) -> std::optional<double> {
    const auto value = number<double>(trimmed(tag.at(name)));
    const std::string unit = tag.at(name + "Unit");
    const auto unit_m =
        unit_of(unit.empty() ? "um" : unit, found.unknown_unit);  // as the schema has it
    return value && unit_m ? std::optional(*value * *unit_m) : std::nullopt;
  };
  found.x_m = length("PhysicalSizeX");
  found.y_m = length("PhysicalSizeY");
  found.z_m = length("PhysicalSizeZ");
}

TiffText read_ome(const std::string& file, const XmlTags& text) {
  if (!text.whole) {
    throw InputError(file, "ImageDescription", "OME's XML, damaged or broken off", "a whole text");
  }
  TiffText found;
  bool described = false;
  for (const XmlTag& tag : text.tags) {
    if (tag.name == "StructuredAnnotations") break;  // anything may stand there
    if (tag.name == "TiffData") {
      found.blocks.push_back({.file = {},
                              .page = whole_number(file, tag, "IFD").value_or(0),
                              .slice = whole_number(file, tag, "FirstZ").value_or(0)});
    } else if (tag.name == "UUID" && !found.blocks.empty()) {
      found.blocks.back().file = tag.at("FileName");
    } else if (tag.name == "Pixels" && described) {
      found.one_stack = false;
    } else if (tag.name == "Pixels") {
      described = true;
      take_pixels(file, tag, found);
    }
  }
  return found;
}

/// Of {"shape": [14, 17, 19]}.
TiffText read_shape(const std::string& text) {
  TiffText found;
  std::size_t at = text.find('[', text.find("\"shape\""));
  if (at == std::string::npos) return found;
  const std::size_t end = std::min(text.find(']', at), text.size());
  while (at < end) {
    const std::size_t begin = at + 1;
    at = std::min(text.find(',', begin), end);
    const auto size = number<std::int64_t>(trimmed(text.substr(begin, at - begin)));
    if (!size || *size < 1) return {};
    found.shape.push_back(*size);
  }
  // A volume has three axes; more are channels or points in time.
  found.one_stack = std::ranges::count_if(found.shape, [](auto size) { return size > 1; }) <= 3;
  return found;
}

}  // namespace

TiffText read_tiff_text(const std::string& file, const std::string& description) {
  if (description.starts_with("ImageJ=")) return read_image_j(description);
  if (description.starts_with("{\"") && description.find("\"shape\"") != std::string::npos) {
    return read_shape(description);
  }
  if (description.find("OME") == std::string::npos) return {};
  const XmlTags text = xml_tags(description);
  if (text.tags.empty() || text.tags.front().name != "OME") return {};
  return read_ome(file, text);
}

}  // namespace sulcus
