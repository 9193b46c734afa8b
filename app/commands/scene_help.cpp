#include "app/commands/scene_help.hpp"

#include <cmath>
#include <cstdio>
#include <sstream>

#include "engine/core/units.hpp"
#include "engine/scene/burr_number.hpp"

namespace sulcus {

namespace {

std::string type_of(const SceneKey& key) {
  const std::string count = std::to_string(key.count);
  switch (key.kind) {
    case KeyKind::kNumber:
      return "number";
    case KeyKind::kWhole:
      return "whole number";
    case KeyKind::kNumbers:
      return count + " numbers";
    case KeyKind::kRows:
      return "rows of " + count + " numbers [" + std::string(key.fields) + "]";
    case KeyKind::kDirection:
      return "direction [x, y, z] of any length";
    case KeyKind::kBoolean:
      return "true or false";
    case KeyKind::kText:
      return "text";
    case KeyKind::kPath:
      return "path";
    case KeyKind::kChoice:
      break;
  }
  std::string words;
  for (const std::string_view word : key.words) {
    words.append(words.empty() ? "\"" : ", \"").append(word).append("\"");
  }
  return words;
}

/// Whether the kind has a range that says something.
bool has_range(KeyKind kind) {
  return kind == KeyKind::kNumber || kind == KeyKind::kWhole || kind == KeyKind::kNumbers ||
         kind == KeyKind::kRows;
}

}  // namespace

std::string wrapped(const std::string& text, std::size_t indent, std::size_t columns) {
  std::istringstream words(text);
  std::string out;
  std::size_t at = indent;
  for (std::string word; words >> word;) {
    if (at > indent && at + 1 + word.size() > columns) {
      out.append("\n").append(indent, ' ');
      at = indent;
    } else if (at > indent) {
      out += ' ';
      ++at;
    }
    out += word;
    at += word.size();
  }
  return out;
}

KeyHelp help_of(const SceneKey& key) {
  std::ostringstream values;
  if (key.kind == KeyKind::kWhole) values.precision(10);  // all digits
  values << type_of(key);
  if (const std::string_view unit = unit_of_key(key.key); !unit.empty()) values << ", " << unit;
  if (has_range(key.kind)) values << ", " << key.range.least << " to " << key.range.most;
  if (!key.default_toml.empty()) values << "; default " << key.default_toml;
  return {std::string(key.key), values.str(), std::string(key.what)};
}

std::string heading_of(const SceneTableKeys& table) {
  if (table.name.empty()) return "Top";
  const std::string name(table.name);
  return table.repeated ? "[[" + name + "]]" : "[" + name + "]";
}

std::string text_of(const SceneTableKeys& table) {
  std::string text(table.what);
  if (!table.inherits_from.empty()) {
    text.append("; it has all that [")
        .append(table.inherits_from)
        .append("] may have, and besides:");
  }
  return text;
}

std::string scene_help() {
  constexpr std::size_t kKeyColumns = 24, kColumns = 100;
  std::string out =
      "A scene is TOML: tables of keys. What it does not name is not modelled, allocated or "
      "timed.\n"
      "Only [workpiece] and [trajectory] must be there. On a command line: --set TABLE.KEY=VALUE,\n"
      "a tissue by its name, --set tissue.NAME.KEY=VALUE. Brackets at the end name a source.\n";
  for (const SceneTableKeys& table : scene_tables()) {
    const std::string heading = heading_of(table);
    out.append("\n").append(heading).append("  ");
    out.append(wrapped(text_of(table), heading.size() + 2, kColumns)).append("\n");
    for (const SceneKey& key : table.keys) {
      const KeyHelp help = help_of(key);
      out.append("  ").append(help.key);
      const std::size_t used = 2 + help.key.size();
      if (used + 2 > kKeyColumns) {
        out.append("\n").append(kKeyColumns, ' ');
      } else {
        out.append(kKeyColumns - used, ' ');
      }
      out.append(wrapped(help.values, kKeyColumns, kColumns)).append("\n");
      out.append(kKeyColumns, ' ').append(wrapped(help.what, kKeyColumns, kColumns)).append("\n");
    }
  }
  return out;
}

std::string burr_help() {
  const std::span<const std::string_view> shapes = find_scene_key("burr", "shape")->words;
  std::string out =
      "burr.iso takes a number of ISO 6360, \"806 314 001 524 014\": material, shank, shape, "
      "toothing "
      "or\ngrit, size in tenths of a millimetre; or shape and size alone, \"001 014\". Material, "
      "toothing and\ngrit are not modelled; the shank is the friction grip's, 313 to 316. "
      "Shapes:\n\n";
  for (const BurrShapeNumber& row : burr_shape_numbers()) {
    char line[128];
    const std::string shape(shapes[static_cast<std::size_t>(row.shape)]);
    std::snprintf(
        line, sizeof line, "  %s  %-20s %-14s %-26s %s\n", row.number.data(),
        std::string(row.what).c_str(), shape.c_str(),
        row.length_m > 0.0
            ? ("head of " + std::to_string(std::lround(row.length_m / kMillimetre)) + " mm").c_str()
            : "length by our ratio",
        std::string(row.source).c_str());
    out += line;
  }
  return out +
         "\nSources: Komet's FG diamonds by ISO number as fossviking.com lists them (2019); Mr. "
         "Bur,\n"
         "Dental Bur Classification and Numbering Systems (mrbur.com, 2024). Not the standard "
         "itself.\n";
}

std::vector<std::string> keys_to_set() {
  std::vector<std::string> keys;
  for (const SceneTableKeys& table : scene_tables()) {
    if (table.repeated) continue;  // a tissue goes by its name, which a scene knows
    for (const SceneKey& key : table.keys) {
      const std::string name(table.name);
      keys.push_back((name.empty() ? name : name + ".") + std::string(key.key));
    }
  }
  return keys;
}

}  // namespace sulcus
