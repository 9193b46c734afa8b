#include "engine/import/volumes/text_header.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/import/volumes/volume_checks.hpp"

namespace sulcus {
namespace {

/// A line of a header, without what ends it; counts its bytes.
bool read_line(std::ifstream& in, TextHeader& header, std::string& line) {
  if (!std::getline(in, line)) return false;
  header.bytes += line.size() + (in.eof() ? 0 : 1);
  if (header.bytes > kMaxHeaderBytes) {
    throw InputError(header.path, "header", "more than 1 MiB of text", "a header that ends");
  }
  return true;
}

std::ifstream open_header(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path, "", "no readable file", "a volume");
  return in;
}

void add_field(TextHeader& header, const std::string& key, const std::string& value) {
  if (header.fields.try_emplace(key, value).second) return;
  throw InputError(header.path, key, "the field twice", "it once");
}

/// The lines left, without blanks around them.
void read_list(std::ifstream& in, TextHeader& header) {
  for (std::string line; read_line(in, header, line);) {
    if (const std::string name = trimmed(line); !name.empty()) header.behind.push_back(name);
  }
}

bool begins_list(const std::string& value) {
  const std::vector<std::string> parts = words(value);
  return !parts.empty() && lower_case(parts.front()) == "list";
}

std::string beside(const std::string& path, const std::string& name) {
  const std::filesystem::path file(name);
  return file.is_absolute() ? name : (std::filesystem::path(path).parent_path() / file).string();
}

/// Where the one place for a number stands in a pattern, "%d" to "%09d".
struct NumberPlace {
  std::size_t at = 0, length = 0, width = 0;
  bool zeros = false;
};

std::optional<NumberPlace> number_place(const std::string& pattern) {
  const std::size_t at = pattern.find('%');
  if (at == std::string::npos || pattern.find('%', at + 1) != std::string::npos) return {};
  NumberPlace place{.at = at};
  std::size_t end = at + 1;
  if (end < pattern.size() && pattern[end] == '0') place.zeros = true, ++end;
  if (end < pattern.size() && pattern[end] >= '1' && pattern[end] <= '9') {
    place.width = static_cast<std::size_t>(pattern[end++] - '0');
  }
  if (end == pattern.size() || (pattern[end] != 'd' && pattern[end] != 'i')) return {};
  place.length = end + 1 - at;
  return place;
}

std::string numbered(const std::string& pattern, const NumberPlace& place, std::int64_t n) {
  std::string digits = std::to_string(n);
  if (digits.size() < place.width) {
    digits.insert(0, place.width - digits.size(), place.zeros ? '0' : ' ');
  }
  return std::string(pattern).replace(place.at, place.length, digits);
}

}  // namespace

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> result;
  for (std::string word; in >> word;) result.push_back(word);
  return result;
}

std::vector<std::int64_t> whole_numbers(const std::string& path, const std::string& place,
                                        const std::string& text) {
  std::vector<std::int64_t> result;
  for (const std::string& word : words(text)) {
    const auto value = number<std::int64_t>(word);
    if (!value) throw InputError(path, place, "\"" + word + "\"", "a whole number");
    result.push_back(*value);
  }
  return result;
}

std::vector<double> finite_numbers(const std::string& path, const std::string& place,
                                   const std::string& text, std::size_t count) {
  std::vector<double> result;
  for (const std::string& word : words(text)) {
    const auto value = number<double>(word);
    if (!value || !std::isfinite(*value)) {
      throw InputError(path, place, "\"" + word + "\"", "a finite number");
    }
    result.push_back(*value);
  }
  if (result.size() == count) return result;
  throw InputError(path, place, std::to_string(result.size()) + " numbers", std::to_string(count));
}

const std::string& TextHeader::at(const std::string& key) const {
  static const std::string kNone;
  const auto found = fields.find(key);
  return found == fields.end() ? kNone : found->second;
}

const std::string& TextHeader::need(const std::string& key) const {
  const std::string& value = at(key);
  if (value.empty()) throw InputError(path, key, "no such field", "one");
  return value;
}

std::vector<std::int64_t> sizes_of(const TextHeader& header, const HeaderField& sizes,
                                   const HeaderField& dimension) {
  std::vector<std::int64_t> all = whole_numbers(header.path, sizes.name, header.need(sizes.key));
  const auto axes = number<int>(header.need(dimension.key));
  if (axes && *axes == static_cast<int>(all.size())) return all;
  throw InputError(header.path, sizes.name, std::to_string(all.size()) + " numbers",
                   "as many as " + dimension.name + " says (" + header.at(dimension.key) + ")");
}

std::size_t values_per_file(const TextHeader& header, const std::string& place,
                            std::uint64_t values, std::size_t files) {
  if (values % files == 0) return values / files;
  throw InputError(header.path, place, std::to_string(files) + " files",
                   "as many as part " + std::to_string(values) + " values evenly");
}

TextHeader read_nrrd_text(const std::string& path) {
  std::ifstream in = open_header(path);
  TextHeader header(path);
  std::string line;
  if (!read_line(in, header, line) || !line.starts_with("NRRD")) {
    throw InputError(path, "line 1", "no \"NRRD\"", "an NRRD file");
  }
  if (const std::string version = trimmed(line);
      version.size() != 8 || version < "NRRD0001" || version > "NRRD0005") {
    throw InputError(path, "line 1", "\"" + version + "\"", "NRRD0001 to NRRD0005");
  }
  while (read_line(in, header, line)) {
    if (trimmed(line).empty()) break;
    const auto colon = line.find(':');
    if (line.front() == '#' || colon == std::string::npos) continue;
    if (colon + 1 < line.size() && line[colon + 1] == '=') continue;
    const std::string key = lower_case(trimmed(std::string_view(line).substr(0, colon)));
    const std::string value = trimmed(std::string_view(line).substr(colon + 1));
    // What some write in one word is two in the format's own spelling.
    const std::string name = key == "datafile"     ? "data file"
                             : key == "byteskip"   ? "byte skip"
                             : key == "lineskip"   ? "line skip"
                             : key == "axismins"   ? "axis mins"
                             : key == "axismaxs"   ? "axis maxs"
                             : key == "centerings" ? "centers"
                                                   : key;
    add_field(header, name, value);
    if (name == "data file" && begins_list(value)) {
      read_list(in, header);
      break;
    }
  }
  return header;
}

TextHeader read_meta_image_text(const std::string& path) {
  std::ifstream in = open_header(path);
  TextHeader header(path);
  for (std::string line; read_line(in, header, line);) {
    const auto equals = line.find('=');
    if (equals == std::string::npos) continue;
    const std::string key = lower_case(trimmed(std::string_view(line).substr(0, equals)));
    const std::string value = trimmed(std::string_view(line).substr(equals + 1));
    add_field(header, key, value);
    if (key != "elementdatafile" || lower_case(value) == "local") {
      if (key == "elementdatafile") break;
      continue;
    }
    read_list(in, header);
    if (!header.behind.empty() && !begins_list(value)) {
      throw InputError(path, "ElementDataFile", "\"" + header.behind.front() + "\" behind it",
                       "it as the last field");
    }
    break;
  }
  return header;
}

std::vector<std::string> data_files(const TextHeader& header, const std::string& key,
                                    const std::string& place) {
  const std::string& value = header.need(key);
  const std::vector<std::string> parts = words(value);
  std::vector<std::string> names{value};
  if (begins_list(value)) {
    names = header.behind;
    if (names.empty()) throw InputError(header.path, place, "an empty list", "a file in each line");
  } else if (const auto at = parts.size() >= 4 ? number_place(parts[0]) : std::nullopt) {
    const auto first = number<std::int64_t>(parts[1]), last = number<std::int64_t>(parts[2]),
               step = number<std::int64_t>(parts[3]);
    constexpr std::int64_t kMost = 1 << 20;
    if (!first || !last || !step || *step == 0 || std::abs(*first) > kMost ||
        std::abs(*last) > kMost || std::abs(*step) > kMost || (*last - *first) / *step < 0) {
      throw InputError(header.path, place, "\"" + value + "\"", "a pattern, first, last and step");
    }
    names.clear();
    for (std::int64_t n = *first; *step > 0 ? n <= *last : n >= *last; n += *step) {
      names.push_back(numbered(parts[0], *at, n));
    }
  } else if (value.find('%') != std::string::npos && parts.size() > 1) {
    throw InputError(header.path, place, "\"" + value + "\"", "a pattern, first, last and step");
  }
  for (std::string& name : names) {
    const std::string file = beside(header.path, name);
    if (!std::filesystem::is_regular_file(file)) {
      throw InputError(header.path, place, "\"" + name + "\"", "a file that exists");
    }
    name = file;
  }
  return names;
}

}  // namespace sulcus
