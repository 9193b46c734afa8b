#include "app/pictures/camera_option.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "engine/core/error.hpp"

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
  const bool fits = numbers.size() >= 2 && numbers.size() <= 3 && std::abs(numbers[0]) <= 360.0 &&
                    std::abs(numbers[1]) <= 90.0;
  if (!fits || (numbers.size() == 3 && !(numbers[2] >= 0.1 && numbers[2] <= 100.0))) {
    throw InputError(
        "", "--camera", "'" + text + "'",
        "review, occlusal, buccal, mesial, burr or AZIMUTH,ELEVATION[,ZOOM] in degrees");
  }
  NamedViewpoint given{text, Viewpoint(numbers[0], numbers[1])};
  if (numbers.size() == 3) given.from.zoom = numbers[2];
  std::ranges::replace(given.name, ',', '_');
  return given;
}

}  // namespace sulcus
