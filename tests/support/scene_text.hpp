#pragma once

#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus::test {

/// The least a scene must say, to which a test adds its own.
inline std::string least_scene() {
  return "[workpiece]\nshape = 'molar'\n[trajectory]\npoints_mm = [[0, 0, 9]]\n";
}

inline Scene parse(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_scene(text, "/scenes/s.toml", overrides);
}

/// What refuses it; "no error" where nothing does.
inline std::string error_of(const std::string& text,
                            const std::vector<std::string>& overrides = {}) {
  try {
    parse(text, overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace sulcus::test
