#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "app/playback/recorded_contacts.hpp"
#include "app/playback/recorded_film.hpp"
#include "app/playback/recorded_heat.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/graphics/renderer.hpp"
#include "engine/outcome/voxel_set.hpp"
#include "engine/scene/section.hpp"
#include "engine/surface/colour_scale.hpp"

namespace sulcus {

/// What the surface of a picture is coloured by.
enum class ColourBy : std::uint8_t { kTissue, kTime, kGoal, kContacts, kNormalError, kTemperature };
inline constexpr std::array<std::string_view, 6> kColourByNames{
    "tissue", "time", "goal", "contacts", "normal_error", "temperature"};

/// The target of a recording's goal. `option` asks for it. InputError where its scene has none.
VoxelSet recorded_target(const RecordingReader& reader, const std::string& path,
                         const RecordedFilm& film, const std::string& option);

/// To either side of a planned wall: one for all recordings, so that pictures of two of them
/// compare.
inline constexpr double kGoalScale_m = 0.5e-3;
/// Colours by goal_distances; `end_m`: from the wall to where they end.
ColourScale goal_scale(double end_m = kGoalScale_m);

/// How pictures are to be coloured.
struct FilmColouring {
  ColourBy by = ColourBy::kTissue;
  bool contact_marks = false;
  std::optional<Section> section;      // of the pictures: its face shows temperatures too
  const VoxelSet* target = nullptr;    // of the goal, for kGoal
  double goal_scale_m = kGoalScale_m;  // to either side of the planned wall
};

/// Colours the pictures of a recording by a quantity, and marks the voxels in contact.
class FilmColours {
 public:
  /// Before the first row is gone to. The target outlives it. InputError where the recording's
  /// scene has no heat to be coloured by, and as RecordedContacts.
  FilmColours(const RecordingReader& reader, const std::string& path, const RecordedFilm& film,
              const FilmColouring& asked, Renderer& renderer);

  /// For the picture of the row that the film was last gone to, rows rising.
  void show(std::size_t row, const RecordedFilm& film, Renderer& renderer, FrameState& state);

 private:
  void show_goal(std::size_t row, const RecordedFilm& film, Renderer& renderer) const;
  void show_temperature(std::size_t row, const RecordedFilm& film, Renderer& renderer);

  ColourBy by_;
  bool contact_marks_;
  ColourScale scale_;
  const VoxelSet* target_;
  std::optional<RecordedContacts> contacts_;
  std::optional<RecordedHeat> heat_;
  std::optional<Section> section_;
};

}  // namespace sulcus
