#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/playback/recorded_film.hpp"
#include "app/report/assessment.hpp"
#include "app/report/results.hpp"
#include "app/report/run_key.hpp"
#include "app/session/session.hpp"
#include "app/terminal/progress.hpp"
#include "app/terminal/terminal.hpp"
#include "app/window/goal_view.hpp"
#include "app/window/picture_tools.hpp"
#include "app/window/view_keys.hpp"
#include "app/window/view_windows.hpp"
#include "engine/core/realtime.hpp"
#include "engine/graphics/gl_scene.hpp"
#include "engine/graphics/panels.hpp"
#include "engine/graphics/window.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "engine/scene/assessment_table.hpp"
#include "engine/surface/surface_mesh.hpp"

namespace sulcus {

namespace {

/// Writes the tooth as it is; returns what to say of it.
std::string export_tooth(const RecordedFilm& film, const std::string& folder, double time_s) {
  const std::string file = folder + formatted("/tooth_%.3f_s.stl", time_s);
  write_mesh(file, closed_surface(film.model()));
  return file;
}

void take_keys(const WindowInput& input, double tick_s, PlayerControls& player) {
  for (const char key : input.keys) {
    const std::optional<ViewAction> action = action_of(key, true);
    if (action == ViewAction::kPause) player.playing = !player.playing;
    const double step_s = input.shift ? tick_s : 0.1;
    if (action == ViewAction::kStepBack) player.time_s -= static_cast<float>(step_s);
    if (action == ViewAction::kStepOn) player.time_s += static_cast<float>(step_s);
    if (action == ViewAction::kExport) player.export_asked = true;
  }
}

/// Where the scene has an [assessment]: the moments of what is not met.
std::vector<PlayerControls::Mark> assessed_marks(const RecordingReader& reader,
                                                 const std::string& recording) {
  std::vector<PlayerControls::Mark> marks;
  const auto settings = assessment_of(reader.header().scene_toml, recording);
  if (!settings) return marks;
  const Progress progress("assessing");
  const std::optional<Assessment> assessment = assessment_if_cut(reader, recording, *settings);
  if (!assessment) return marks;
  for (const AssessedMeasure& measure : assessment->measures) {
    if (measure.met() || !measure.time_s) continue;
    // As it is spoken: "dentine over pulp 0.32 mm".
    std::string name = measure.name.ends_with("_" + measure.unit)
                           ? measure.name.substr(0, measure.name.size() - measure.unit.size() - 1)
                           : measure.name;
    std::ranges::replace(name, '_', ' ');
    marks.push_back({static_cast<float>(*measure.time_s),
                     formatted("%s %.2f %s, %.1f s", name.c_str(), measure.value,
                               measure.unit.c_str(), *measure.time_s)});
  }
  return marks;
}

}  // namespace

void view_recording(const ViewOptions& options) {
  const RecordingReader reader(options.file);
  RecordedFilm film(reader, options.file);
  say_what_is_missing(reader);
  std::vector<PlayerControls::Mark> marks = assessed_marks(reader, options.file);
  std::optional<ResultsFolder> folder;  // once something is to be written
  RenderSettings settings = film.scene().render.value_or(RenderSettings{});
  settings.width = options.width;
  settings.height = options.height;
  Window window("Sulcus: " + film.scene().title, options.width, options.height);
  GlScene drawing(settings, film.bodies(), film.burr().mesh_tool, film.burr().head_length_m);
  CameraHand camera(settings.camera);
  PictureTools tools(film.scene(), film.start(), film.burr(), PictureTools::Turns::kLeft);
  const std::optional<VoxelModel> goal_file = reader.goal();
  GoalView plan(film.scene(), film.earlier() ? film.earlier()->start : film.start(),
                goal_file ? &*goal_file : nullptr);
  PlayerControls player;
  player.picture.has_plan = plan.has_goal();
  player.marks = std::move(marks);
  player.picture.arrows = settings.arrows;
  const double tick_s = 1.0 / film.scene().haptics.rate_hz;  // a float's time may lie before it
  player.first_s = player.time_s = static_cast<float>(film.rows().front().time_s);
  player.end_s = static_cast<float>(film.rows().back().time_s);
  std::uint64_t last_ns = steady_ns();
  while (window.is_open()) {
    const WindowInput input = window.begin();
    draw_panels(player);
    const std::uint64_t now_ns = steady_ns();
    const auto passed_s = static_cast<float>(1e-9 * static_cast<double>(now_ns - last_ns));
    last_ns = now_ns;
    take_keys(input, tick_s, player);
    if (player.playing) player.time_s += player.speed * passed_s;
    const float wanted_s = player.time_s;
    player.time_s = std::clamp(wanted_s, player.first_s, player.end_s);
    if (player.time_s != wanted_s) player.playing = false;  // an end of the recording

    tools.follow(input, drawing, camera, window, player.picture, true);
    drawing.set_hurried(player.playing);
    set_picture(drawing, camera, player.picture, window, tools.is_moving());
    const FrameState state =
        film.seek_row(film.row_at(static_cast<double>(player.time_s) + 0.5 * tick_s), drawing);
    plan.show(drawing, player.picture);
    drawing.draw(state);
    tools.end_frame(drawing, state, camera, window, player.picture, true);
    if (player.export_asked) {
      player.export_asked = false;
      try {
        if (!folder) {
          folder.emplace(ResultsPlace{.given = options.folder,
                                      .otherwise = folder_of_recording(options.file, "_view"),
                                      .force = options.force,
                                      .key = key_of_recording(reader, RecordingUse::kView),
                                      .adds = true});
        }
        player.said = export_tooth(film, folder->path(), static_cast<double>(player.time_s));
        say("%s\n", player.said.c_str());
        std::fflush(stdout);
      } catch (const std::exception& error) {  // the window stays
        player.said = error.what();
      }
    }
  }
}

}  // namespace sulcus
