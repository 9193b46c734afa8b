#include "app/pictures/camera_option.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

std::vector<double> numbers_of(std::string_view text, char separator) {
  std::vector<double> numbers;
  const char *at = text.data(), *end = at + text.size();
  while (at != end) {
    double number = 0.0;
    const auto [next, error] = std::from_chars(at, end, number);
    const bool more = error == std::errc{} && next != end;
    if (error != std::errc{} || (more && (*next != separator || next + 1 == end))) return {};
    numbers.push_back(number);
    at = more ? next + 1 : next;
  }
  return numbers;
}

NamedViewpoint viewpoint_of(const std::string& text) {
  const auto found = std::find(kCameraNames.begin(), kCameraNames.end(), text);
  if (found != kCameraNames.end()) return {text, Camera(found - kCameraNames.begin())};
  const std::vector<double> numbers = numbers_of(text, ',');
  const std::size_t count = numbers.size();
  const bool zooms = count == 3 || count == 6, looks = count == 6;
  bool fits =
      (count == 2 || zooms) && std::abs(numbers[0]) <= 360.0 && std::abs(numbers[1]) <= 90.0;
  if (zooms) fits = fits && numbers[2] >= 0.1 && numbers[2] <= 100.0;
  constexpr double kFarthest_mm = 1000.0;
  for (std::size_t i = 3; i < count; ++i) fits = fits && std::abs(numbers[i]) <= kFarthest_mm;
  if (!fits) {
    throw InputError("", "--camera", "'" + text + "'",
                     "review, occlusal, buccal, mesial, burr or AZIMUTH,ELEVATION[,ZOOM[,X,Y,Z]]: "
                     "degrees, times (0.1 to 100), the point it looks at in mm");
  }
  NamedViewpoint given{text, Viewpoint(numbers[0], numbers[1])};
  if (zooms) given.from.zoom = numbers[2];
  if (looks) {
    given.from.middle_world = kMillimetre * Eigen::Vector3d(numbers[3], numbers[4], numbers[5]);
  }
  std::ranges::replace(given.name, ',', '_');
  return given;
}

}  // namespace sulcus
