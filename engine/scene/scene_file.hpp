#pragma once

#include <span>
#include <string>

#include "engine/scene/scene.hpp"

namespace sulcus {

/// Reads and checks a scene. `overrides` are the TABLE.KEY=VALUE of --set: the value is TOML, else
/// a string; tissue.NAME.KEY addresses a [[tissue]]; workpiece.file drops workpiece.shape; paths in
/// them are relative to the current folder, in the file to the file's. InputError (with line and
/// column) on an unknown key, which names the nearest known one, a wrong type, or a value out of
/// range. Files that a scene names are not opened here; `limits` are those that hold for them.
Scene load_scene(const std::string& file, std::span<const std::string> overrides = {},
                 const InputLimits& limits = {});

/// The text of a scene's file, or of one beside it. InputError where it cannot be read, or is
/// longer than a scene may be.
std::string read_scene_text(const std::string& file);

/// The same from a text, as a recording carries it; `file` is for messages and relative paths.
Scene parse_scene(const std::string& text, const std::string& file,
                  std::span<const std::string> overrides = {}, const InputLimits& limits = {});

/// An override that makes a key this text, also where the text alone would be read as TOML (a file
/// by the name "true", or "1"); as it stands where it is plain.
std::string string_override(const std::string& key, const std::string& text);

}  // namespace sulcus
