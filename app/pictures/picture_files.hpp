#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "app/pictures/picture_options.hpp"
#include "app/playback/recorded_film.hpp"
#include "engine/scene/section.hpp"

namespace sulcus {

/// What pictures are named by: what they show.
class PictureNames {
 public:
  PictureNames(const RecordedFilm& film, const PictureOptions& options);

  /// Such as occlusal_7.500s_by_goal, without an end.
  std::string of(const std::string& camera, const TickRecord& row,
                 const std::optional<Section>& section) const;

 private:
  int digits_ = 0, decimals_ = 3;
  std::string colours_, marks_;
};

/// Writes a file into a folder. Another file of that name stays, and this one gets the next free
/// one. `end`: ".png". Returns its path. std::runtime_error where it cannot be written.
std::string write_beside_others(std::string_view bytes, const std::string& folder,
                                const std::string& name, const std::string& end);

}  // namespace sulcus
