#include "app/pictures/picture_files.hpp"

#include <cmath>
#include <fstream>
#include <iterator>

#include "app/terminal/terminal.hpp"
#include "engine/core/units.hpp"
#include "engine/core/whole_file.hpp"

namespace sulcus {

PictureNames::PictureNames(const RecordedFilm& film, const PictureOptions& options) {
  // Every tick has a time of its own.
  while (film.scene().haptics.rate_hz > std::pow(10.0, decimals_) && decimals_ < 9) ++decimals_;
  // Of many, so that they are in their order in a list.
  if (options.fps > 0.0) {
    digits_ =
        static_cast<int>(std::to_string(static_cast<long long>(film.rows().back().time_s)).size()) +
        1 + decimals_;
  }
  if (options.colour_by != "tissue") colours_ = "_by_" + options.colour_by;
  if (options.contacts) marks_ += "_contacts";
  if (options.ghost) marks_ += "_ghost";
}

std::string PictureNames::of(const std::string& camera, const TickRecord& row,
                             const std::optional<Section>& section) const {
  std::string name = camera + formatted("_%0*.*fs", digits_, decimals_, row.time_s) + colours_;
  if (section) name += formatted("_%c=%g", "xyz"[section->axis], section -> at_m / kMillimetre);
  return name + marks_;
}

std::string write_beside_others(std::string_view bytes, const std::string& folder,
                                const std::string& name, const std::string& end) {
  for (int number = 1;; ++number) {
    std::string file = folder;
    file.append("/").append(name);
    if (number > 1) file.append("-").append(std::to_string(number));
    file.append(end);
    std::ifstream before(file, std::ios::binary);
    if (!before) {
      write_whole_file(file, bytes);
      return file;
    }
    if (std::string(std::istreambuf_iterator<char>(before), {}) == bytes) return file;
  }
}

}  // namespace sulcus
