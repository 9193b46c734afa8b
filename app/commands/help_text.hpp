#pragma once

#include <string>
#include <vector>

#include "engine/recording/recording_layout.hpp"
#include "engine/scene/scene_keys.hpp"

namespace sulcus {

// What help and manual say of scenes and recordings.

/// A text broken at spaces; further lines begin with `indent` of them, as does, unwritten, the
/// first.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t columns);

/// A key as help and manual have it.
struct KeyHelp {
  std::string key, values, what;  // values: type, unit, range, default
};
KeyHelp help_of(const SceneKey& key);

/// "[burr]", "[[body]]", and for the top of the file its title alone.
std::string heading_of(const SceneTableKeys& table);
/// What the table is, and whose keys it has besides.
std::string text_of(const SceneTableKeys& table);

/// All tables with all keys, for a terminal of 100 columns.
std::string scene_help();

/// The shape numbers that burr.iso knows, with their sources.
std::string burr_help();

/// TABLE.KEY of every key that --set can change.
std::vector<std::string> keys_to_set();

/// A part of a recording as help and manual have it: "rows, with [cutting]: one row for each ...".
std::string text_of(const StoredPart& part);
/// A column, an attribute, or the values of an array: "f64[3], m".
std::string values_of(const StoredField& field);

/// What reads a recording, in Python and MATLAB.
std::string recording_examples();
/// What holds for all of it.
std::string recording_notes();

/// The whole layout, for a terminal of 100 columns.
std::string recording_help();

}  // namespace sulcus
