#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/input_limits.hpp"
#include "engine/core/units.hpp"
#include "engine/core/user_text.hpp"
#include "engine/scene/burr_number.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/scene_keys.hpp"
#include "engine/scene/toml_table.hpp"

namespace sulcus {

namespace {

[[noreturn]] void refuse_override(const std::string& text, std::string_view found,
                                  std::string_view expected) {
  throw InputError("", std::string(kFromOverride) + " " + text, found, expected);
}

bool is_utf8(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  try {
    (void)toml::parse("# " + text);  // a comment may hold any text, and nothing else
    return true;
  } catch (const toml::parse_error&) {
    return false;
  }
}

/// The value as TOML, else as a string.
toml::table parse_override_value(const std::string& value) {
  try {
    return toml::parse("value = " + value, kFromOverride);
  } catch (const toml::parse_error&) {
    std::ostringstream quoted;
    quoted << toml::value<std::string>(value);
    return toml::parse("value = " + quoted.str(), kFromOverride);
  }
}

/// What burr.iso says in words, so that one of them can be changed. A number that is none stays,
/// for the reader to refuse.
void spell_burr_number_out(toml::table& burr) {
  const auto text = burr["iso"].value<std::string>();
  BurrNumberFault ignored;
  const auto number = text ? read_burr_number(*text, ignored) : std::nullopt;
  if (!number) return;
  const SceneKey& shape = *find_scene_key("burr", "shape");
  burr.erase("iso");
  burr.insert_or_assign("shape", std::string(shape.words[static_cast<std::size_t>(number->shape)]));
  burr.insert_or_assign("diameter_mm", number->diameter_m / kMillimetre);
  if (number->length_m) burr.insert_or_assign("length_mm", *number->length_m / kMillimetre);
}

/// The [[tissue]] of a name; names alone become tables that can be changed.
toml::table& tissue_of(toml::table& root, const std::string& name, const std::string& text) {
  if (toml::array* tissues = root["tissue"].as_array()) {
    if (tissues->is_homogeneous<std::string>()) {
      toml::array tables;
      for (const toml::node& entry : *tissues) {
        tables.push_back(toml::table{{"name", *entry.value<std::string>()}});
      }
      *tissues = std::move(tables);
    }
    for (toml::node& entry : *tissues) {
      toml::table* table = entry.as_table();
      if (table && (*table)["name"].value<std::string>() == name) return *table;
    }
  }
  refuse_override(text, "no [[tissue]] named '" + name + "'", "the name of a tissue of the scene");
}

}  // namespace

void apply_override(toml::table& root, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    refuse_override(text, "no '='", "TABLE.KEY=VALUE");
  }
  std::vector<std::string> path;
  std::istringstream parts(text.substr(0, equals));
  for (std::string part; std::getline(parts, part, '.');) path.push_back(part);
  for (const std::string& part : path) {
    if (part.empty()) refuse_override(text, "an empty key", "TABLE.KEY=VALUE");
  }
  if (path.size() > InputLimits::kSceneDepth) {
    refuse_override(text, "a key of " + std::to_string(path.size()) + " parts", "TABLE.KEY=VALUE");
  }
  if (!is_utf8(text)) refuse_override(text.substr(0, equals), "bytes that are no UTF-8", "text");
  const std::string value = text.substr(equals + 1);
  // A plain value holds no tables, but a path may have many dots.
  if (value.find_first_of("[{\n") != std::string::npos) {
    check_toml_depth(value, std::string(kFromOverride));
  }
  toml::table parsed = parse_override_value(value);

  toml::table* table = &root;
  std::size_t next = 0;
  if (path[0] == "tissue" && path.size() == 3) {
    table = &tissue_of(root, path[1], text);
    next = 2;
  }
  for (; next + 1 < path.size(); ++next) {
    toml::node* inner = table->get(path[next]);
    if (!inner) {
      table->insert(path[next], toml::table{});
      inner = table->get(path[next]);
    }
    if (!inner->is_table()) refuse_override(text, "'" + path[next] + "', no table", "a table");
    table = inner->as_table();
  }
  // A file stands instead of what the scene says in place.
  if (path == std::vector<std::string>{"workpiece", "file"}) table->erase("shape");
  if (path == std::vector<std::string>{"trajectory", "file"} ||
      path == std::vector<std::string>{"trajectory", "recording"}) {
    for (const char* other : {"points_mm", "file", "recording"}) table->erase(other);
  }
  if (path.size() == 2 && path[0] == "burr") {
    if (path[1] == "iso") {
      for (const char* said : {"shape", "file", "diameter_mm", "length_mm"}) table->erase(said);
      // Its digits alone would be a whole number.
      if (parsed["value"].is_integer()) {
        std::string quoted("\"");
        parsed = parse_override_value(quoted.append(value).append("\""));
      }
    } else if (path[1] == "shape" || path[1] == "file" || path[1] == "diameter_mm" ||
               path[1] == "length_mm") {
      spell_burr_number_out(*table);
    }
  }
  // Insert the node itself, not a copy of its value: it carries where it came from.
  table->insert_or_assign(path.back(), std::move(*parsed.get("value")));
}

std::string string_override(const std::string& key, const std::string& text) {
  constexpr std::array<std::string_view, 4> kWords{"true", "false", "inf", "nan"};
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view("_./-").find(static_cast<char>(c)) != std::string_view::npos;
  };
  const bool plain = !text.empty() && std::isdigit(static_cast<unsigned char>(text[0])) == 0 &&
                     text[0] != '-' && text[0] != '.' && std::ranges::all_of(text, is_plain) &&
                     std::ranges::find(kWords, text) == kWords.end();
  return key + "=" + (plain ? text : for_toml(text));
}

}  // namespace sulcus
