#include "app/commands/help_text.hpp"

#include <array>
#include <cmath>
#include <sstream>
#include <string_view>

#include "app/terminal/terminal.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/burr_number.hpp"

namespace sulcus {

namespace {

// Of a terminal; of names before what they are.
constexpr std::size_t kColumns = 100, kNameColumns = 24;

std::string type_of(const SceneKey& key) {
  const std::string count = std::to_string(key.count);
  switch (key.kind) {
    case KeyKind::kNumber:
      return "number";
    case KeyKind::kWhole:
      return "whole number";
    case KeyKind::kNumbers:
      return count + " numbers";
    case KeyKind::kLimit:
      return "number or [least, most]";
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
         kind == KeyKind::kRows || kind == KeyKind::kLimit;
}

std::string_view kind_of(const StoredPart& part) {
  switch (part.kind) {
    case StoredKind::kRows:
      return "rows";
    case StoredKind::kRow:
      return "one row";
    case StoredKind::kArray:
      return "array";
    case StoredKind::kGroup:
      break;
  }
  return part.fields.empty() ? "group" : "group with attributes";
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
      if (used + 2 > kNameColumns) {
        out.append("\n").append(kNameColumns, ' ');
      } else {
        out.append(kNameColumns - used, ' ');
      }
      out.append(wrapped(help.values, kNameColumns, kColumns)).append("\n");
      out.append(kNameColumns, ' ').append(wrapped(help.what, kNameColumns, kColumns)).append("\n");
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
    const std::string shape(shapes[static_cast<std::size_t>(row.shape)]);
    const std::string length =
        row.length_m > 0.0 ? formatted("head of %ld mm", std::lround(row.length_m / kMillimetre))
                           : "length by our ratio";
    out +=
        formatted("  %s  %-20s %-14s %-26s %s\n", row.number.data(), std::string(row.what).c_str(),
                  shape.c_str(), length.c_str(), std::string(row.source).c_str());
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

std::string text_of(const StoredPart& part) {
  std::string text(kind_of(part));
  if (!part.when.empty()) text.append(", only ").append(part.when);
  text.append(": ").append(part.what);
  if (!part.like.empty()) text.append("; it has all that ").append(part.like).append(" has");
  return text;
}

std::string values_of(const StoredField& field) {
  constexpr std::array<std::string_view, 7> kNames{"u8", "u16", "u32", "u64", "f32", "f64", "text"};
  std::string text(kNames[static_cast<std::size_t>(field.type)]);
  if (field.count > 1) text.append("[").append(std::to_string(field.count)).append("]");
  if (!field.unit.empty()) text.append(", ").append(field.unit);
  return text;
}

std::string recording_notes() {
  return "A recording is HDF5. Numbers are little-endian: u8 to u64 without a sign, f32 and f64 of "
         "IEEE 754. Rows are compounds, whose fields are columns. World: the origin is the centre "
         "of the workpiece's grid. A recording whose program was killed opens in the mode of a "
         "single writer and multiple readers only; sulcus repair makes one that opens everywhere. "
         "The last rows of such a one may be torn: each has a check.";
}

std::string recording_examples() {
  return "  import h5py                                               # Python\n"
         "  with h5py.File(\"recording.h5\", \"r\", swmr=True) as f:\n"
         "      scene = f.attrs[\"scene\"].decode()\n"
         "      ticks, edits = f[\"ticks\"][:], f[\"edits\"][:]\n"
         "  force_N = ticks[\"force_N\"]                                # rows x 3\n"
         "\n"
         "  scene = h5readatt('recording.h5', '/', 'scene');          % MATLAB, closed recordings\n"
         "  ticks = h5read('recording.h5', '/ticks');                 % a struct of columns\n";
}

std::string recording_help() {
  std::string out = wrapped(recording_notes(), 0, kColumns) + "\n\n" + recording_examples();
  for (const StoredPart& part : recording_layout()) {
    const std::string path(part.path);
    out.append("\n").append(path).append("  ");
    out.append(wrapped(text_of(part), path.size() + 2, kColumns)).append("\n");
    for (const StoredField& field : part.fields) {
      std::string line = "  " + std::string(field.name);
      line.append(line.size() + 2 > kNameColumns ? 2 : kNameColumns - line.size(), ' ');
      line.append(values_of(field)).append(field.what.empty() ? "" : ": ");
      out.append(line).append(wrapped(std::string(field.what), line.size(), kColumns)).append("\n");
    }
  }
  return out;
}

}  // namespace sulcus
