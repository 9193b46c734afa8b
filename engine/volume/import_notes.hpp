#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/volume/input_geometry.hpp"

namespace sulcus {

/// What an import tells beside the voxels that it made.
struct ImportNotes {
  std::optional<InputGeometry> input;  // none: a built-in shape
  std::vector<std::string> warnings;   // for the user, a line each
};

}  // namespace sulcus
