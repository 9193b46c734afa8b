#include "engine/scene/toml_table.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <sstream>

#include "engine/core/error.hpp"

namespace sulcus {

namespace {

std::string number_text(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string range_text(Range range) {
  return number_text(range.least) + " to " + number_text(range.most);
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_word(std::string_view word, std::span<const std::string> words) {
  std::string best;
  constexpr std::size_t kLongest = 64;  // nothing that a hand mistyped is longer
  if (word.size() > kLongest) return best;
  std::size_t least = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const std::string& candidate : words) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < least) {
      least = distance;
      best = candidate;
    }
  }
  return best;
}

std::string describe(const toml::node& node) {
  std::ostringstream text;
  node.visit([&](const auto& value) {
    if constexpr (toml::is_floating_point<decltype(value)>) {
      text << number_text(value.get());  // toml++ writes 17 digits, which nobody typed
    } else {
      text << value;
    }
  });
  std::string line = text.str();
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line.size() > 60 ? line.substr(0, 57) + "..." : line;
}

const toml::node* TomlTable::find(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  return table_.get(key);
}

std::string TomlTable::place(std::string_view key) const {
  std::string name = path_.empty() ? std::string(key) : path_ + "." + std::string(key);
  const toml::node* node = table_.get(key);
  const toml::source_region& region = node ? node->source() : table_.source();
  if (region.path && *region.path == kFromOverride) return std::string(kFromOverride) + " " + name;
  if (!region.begin) return name;
  return "line " + std::to_string(region.begin.line) + ", column " +
         std::to_string(region.begin.column) + ", " + name;
}

void TomlTable::fail(std::string_view key, std::string_view found,
                     std::string_view expected) const {
  throw InputError(file_, place(key), found, expected);
}

double TomlTable::checked(std::string_view key, const toml::node& node, Range range) const {
  const std::optional<double> value =
      node.is_number() ? node.value<double>() : std::optional<double>{};
  if (!value) fail(key, describe(node), "a number, " + range_text(range));
  if (!std::isfinite(*value) || *value < range.least || *value > range.most) {
    fail(key, describe(node), range_text(range));
  }
  return *value;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return {};
  if (!node->is_table()) fail(key, describe(*node), "a table, [" + std::string(key) + "]");
  return TomlTable(*node->as_table(), file_,
                   path_.empty() ? std::string(key) : path_ + "." + std::string(key));
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  const toml::node* node = find(key);
  std::vector<TomlTable> all;
  if (!node) return all;
  const std::string expected = "tables, [[" + std::string(key) + "]]";
  if (!node->is_array()) fail(key, describe(*node), expected);
  for (const toml::node& entry : *node->as_array()) {
    if (!entry.is_table()) fail(key, describe(entry), expected);
    all.emplace_back(*entry.as_table(), file_, std::string(key));
  }
  return all;
}

std::optional<double> TomlTable::number(std::string_view key, Range range) {
  const toml::node* node = find(key);
  if (!node) return {};
  return checked(key, *node, range);
}

std::optional<int> TomlTable::integer(std::string_view key, Range range) {
  const toml::node* node = find(key);
  if (!node) return {};
  if (!node->is_integer()) fail(key, describe(*node), "a whole number, " + range_text(range));
  return static_cast<int>(checked(key, *node, range));
}

std::optional<bool> TomlTable::boolean(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return {};
  if (!node->is_boolean()) fail(key, describe(*node), "true or false");
  return *node->value<bool>();
}

std::optional<std::string> TomlTable::text(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return {};
  if (!node->is_string()) fail(key, describe(*node), "a text in quotes");
  return *node->value<std::string>();
}

std::vector<double> TomlTable::numbers(std::string_view key, std::size_t count, Range range) {
  const toml::node* node = find(key);
  if (!node) return {};
  const toml::array* array = node->as_array();
  if (!array || array->size() != count) {
    fail(key, describe(*node), std::to_string(count) + " numbers, " + range_text(range));
  }
  std::vector<double> values;
  for (const toml::node& entry : *array) values.push_back(checked(key, entry, range));
  return values;
}

std::vector<double> TomlTable::limit(std::string_view key, Range range) {
  const toml::node* node = find(key);
  if (!node) return {};
  if (node->is_number()) return {checked(key, *node, range)};
  const toml::array* array = node->as_array();
  if (!array || array->size() != 2) {
    fail(key, describe(*node), "a number or [least, most], " + range_text(range));
  }
  std::vector<double> limit{checked(key, (*array)[0], range), checked(key, (*array)[1], range)};
  if (limit[0] > limit[1]) fail(key, describe(*node), "[least, most]");
  return limit;
}

std::vector<std::vector<double>> TomlTable::rows(std::string_view key, std::size_t count,
                                                 std::string_view names, Range range) {
  const toml::node* node = find(key);
  if (!node) return {};
  const std::string expected = "[[" + std::string(names) + "], ...]";
  const toml::array* array = node->as_array();
  if (!array || array->empty()) fail(key, describe(*node), expected);
  std::vector<std::vector<double>> all;
  for (const toml::node& entry : *array) {
    const toml::array* row = entry.as_array();
    if (!row || row->size() != count) fail(key, describe(entry), expected);
    std::vector<double>& values = all.emplace_back();
    for (const toml::node& value : *row) values.push_back(checked(key, value, range));
  }
  return all;
}

std::optional<Eigen::Vector3d> TomlTable::direction(std::string_view key) {
  const std::vector<double> v = numbers(key, 3, {-1e6, 1e6});
  if (v.empty()) return {};
  const Eigen::Vector3d along(v.data());
  const double length = along.norm();
  if (!(length > 1e-9)) fail(key, "a vector of no length", "a direction");
  return along / length;
}

std::optional<std::size_t> TomlTable::choice(std::string_view key,
                                             std::span<const std::string_view> words) {
  const toml::node* node = find(key);
  if (!node) return {};
  std::string list;
  for (std::string_view word : words) list.append(list.empty() ? "" : ", ").append(word);
  if (!node->is_string()) fail(key, describe(*node), "one of " + list);
  const auto found = std::find(words.begin(), words.end(), *node->value<std::string_view>());
  if (found == words.end()) fail(key, describe(*node), "one of " + list);
  return static_cast<std::size_t>(found - words.begin());
}

std::vector<std::string> TomlTable::strings(std::string_view key) {
  const toml::node* node = find(key);
  std::vector<std::string> all;
  const toml::array* array = node ? node->as_array() : nullptr;
  if (!array || !array->is_homogeneous<std::string>()) return all;
  for (const toml::node& entry : *array) all.push_back(*entry.value<std::string>());
  return all;
}

std::string TomlTable::path(std::string_view key) {
  const std::string given = text(key).value_or("");
  if (given.empty()) {
    if (has(key)) fail(key, "an empty text", "a path");
    return given;
  }
  const toml::source_region& region = table_.get(key)->source();
  const bool from_override = region.path && *region.path == kFromOverride;
  const std::filesystem::path base = from_override ? std::filesystem::current_path()
                                                   : std::filesystem::absolute(file_).parent_path();
  return (base / given).lexically_normal().string();
}

void TomlTable::finish() const {
  for (const auto& [key, node] : table_) {
    if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
    const std::string near = nearest_word(key.str(), known_);
    std::string expected;
    if (!near.empty()) {
      expected = "'" + near + "'";
    } else {
      for (const std::string& word : known_)
        expected += (expected.empty() ? "one of " : ", ") + word;
    }
    fail(key.str(), "the unknown key '" + std::string(key.str()) + "'", expected);
  }
}

toml::table parse_toml(const std::string& text, const std::string& file,
                       std::string_view expected) {
  check_toml_depth(text, file);
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    const toml::source_region& at = error.source();
    throw InputError(
        file,
        "line " + std::to_string(at.begin.line) + ", column " + std::to_string(at.begin.column),
        "text that is not valid TOML (" + std::string(error.description()) + ")", expected);
  }
}

}  // namespace sulcus
