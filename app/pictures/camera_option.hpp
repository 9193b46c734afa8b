#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/graphics/camera.hpp"

namespace sulcus {

struct NamedViewpoint {
  std::string name;  // fit for a file's
  Viewpoint from;
};

/// Reads numbers from all of a text, `separator` between them; empty where it is not that.
std::vector<double> numbers_of(std::string_view text, char separator);

/// Of --camera: a name, or AZIMUTH,ELEVATION[,ZOOM[,X,Y,Z]]: degrees, times nearer, the point in
/// the middle of the picture, mm in the scene. InputError.
NamedViewpoint viewpoint_of(const std::string& text);

}  // namespace sulcus
