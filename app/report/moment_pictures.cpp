#include "app/report/moment_pictures.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "app/playback/recorded_film.hpp"
#include "app/report/video_writer.hpp"
#include "engine/graphics/renderer.hpp"

namespace sulcus {

namespace {

constexpr int kMomentWide = 640, kMomentTall = 400;  // pixels
constexpr double kMomentFps = 30.0, kBefore_s = 1.5, kAfter_s = 0.5;

/// Beside the burr, from buccal.
Viewpoint beside_the_burr() {
  Viewpoint from(-80.0, 20.0);
  from.follows_burr = true;
  from.zoom = 0.5;
  return from;
}

class MomentPictures {
 public:
  MomentPictures(const RecordingReader& reader, const std::string& recording)
      : film_(reader, recording),
        renderer_(settings(), film_.bodies(), film_.burr().mesh_tool, film_.burr().head_length_m) {
    renderer_.set_hud({.title = false, .figures = false, .arrows = true});
    renderer_.set_viewpoint(beside_the_burr());
  }

  /// Whether the recording's own ticks have the moment.
  bool has(const AssessedMeasure& measure) const {
    return measure.tick && measure.time_s && !film_.rows().empty() &&
           *measure.tick >= film_.rows().front().tick && *measure.tick <= film_.rows().back().tick;
  }
  void draw(const std::string& folder, AssessedMeasure& measure) {
    renderer_.set_section(measure.position_m ? std::optional(Section{1, measure.position_m->y()})
                                             : std::nullopt);
    measure.film = measure.name + ".mp4";
    VideoWriter video(folder + "/" + measure.film, kMomentWide, kMomentTall, kMomentFps);
    for (int i = 0; i < static_cast<int>((kBefore_s + kAfter_s) * kMomentFps); ++i) {
      video.add(picture_at(*measure.time_s - kBefore_s + i / kMomentFps));
    }
    video.close();
    measure.picture = measure.name + ".png";
    write_png(picture_at(*measure.time_s), folder + "/" + measure.picture);
  }

 private:
  static RenderSettings settings() {
    RenderSettings settings;
    settings.width = kMomentWide;
    settings.height = kMomentTall;
    settings.arrows = true;
    return settings;
  }
  /// Half a tick later, since a tick's time may be rounded to before it.
  Image picture_at(double time_s) {
    const double half_s = 0.5 / film_.scene().haptics.rate_hz;
    return renderer_.draw(film_.seek_row(film_.row_at(time_s + half_s), renderer_));
  }

  RecordedFilm film_;
  Renderer renderer_;
};

}  // namespace

std::vector<std::string> draw_moments(const RecordingReader& reader, const std::string& recording,
                                      const std::string& folder, Assessment& assessment) {
  std::vector<AssessedMeasure*> missed;
  for (AssessedMeasure& measure : assessment.measures) {
    if (!measure.met() && measure.tick) missed.push_back(&measure);
  }
  if (missed.empty()) return {};
  std::ranges::sort(missed, {}, [](const AssessedMeasure* measure) { return *measure->tick; });
  MomentPictures pictures(reader, recording);
  std::vector<std::string> files;
  for (AssessedMeasure* const measure : missed) {
    if (!pictures.has(*measure)) continue;
    pictures.draw(folder, *measure);
    files.insert(files.end(), {measure->picture, measure->film});
  }
  return files;
}

}  // namespace sulcus
