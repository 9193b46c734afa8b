#include "app/report/review_page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <sstream>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "app/playback/recorded_film.hpp"
#include "app/playback/recorded_heat.hpp"
#include "app/playback/recorded_sound.hpp"
#include "app/report/assessment.hpp"
#include "app/report/measures_table.hpp"
#include "app/report/page/curves.hpp"
#include "app/report/page/page_html.hpp"
#include "app/report/page/web_files.hpp"
#include "app/report/page_attempt.hpp"
#include "app/report/summary.hpp"
#include "app/report/video_writer.hpp"
#include "app/session/run_marks.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/base64.hpp"
#include "engine/core/units.hpp"
#include "engine/core/user_text.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/graphics/renderer.hpp"
#include "engine/scene/assessment_table.hpp"
#include "engine/scene/section.hpp"

namespace sulcus {

namespace {

constexpr int kWide = 800, kTall = 500;            // pixels of a picture
constexpr int kStripWide = 640, kStripTall = 400;  // of the way there, shown small
constexpr std::size_t kStrip = 8;

std::string picture(const Image& image, const std::string& words) {
  return "<figure><img alt=\"" + for_html(words) + "\" src=\"data:image/png;base64," +
         base64(png_bytes(image)) + "\"><figcaption>" + for_html(words) +
         "</figcaption></figure>\n";
}

/// A curve over the whole run of what `value(row)` gives.
template <class Value>
std::string curve(const std::string& name, const std::string& unit, const char* colour,
                  std::span<const TickRecord> rows, const Value& value) {
  Curve line{.name = name, .unit = unit, .colour = colour};
  std::vector<double> times_s;
  times_s.reserve(rows.size());
  line.values.reserve(rows.size());
  for (const TickRecord& row : rows) {
    times_s.push_back(row.time_s);
    line.values.push_back(value(row));
  }
  return curve_figure(line, times_s);
}

double norm(const double (&v)[3]) { return std::hypot(v[0], v[1], v[2]); }

void add_rows(const nlohmann::ordered_json& value, const std::string& name, std::ostream& table) {
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items()) {
      add_rows(inner, name.empty() ? key : name + ", " + key, table);
    }
    return;
  }
  table << "<tr><th>" << for_html(name) << "</th><td>"
        << for_html(value.is_string() ? value.get<std::string>() : value.dump()) << "</td></tr>\n";
}

/// What came of `ticks` ticks.
std::string outcome_table(const FrameState& end, std::uint64_t ticks, double rate_hz) {
  std::string table = "<table class=\"facts\">\n";
  table += row_of("Duration", formatted("%.3f s, %ju ticks", static_cast<double>(ticks) / rate_hz,
                                        std::uintmax_t{ticks}));
  table += row_of("Removed", formatted("%.3f mm\xC2\xB3", end.removed_mm3));
  for (const OutcomeLine& line : end.outcome) table += row_of(line.name, line.value);
  return table + "</table>\n";
}

/// The state at the end of a recording's own ticks, as if nothing had come before them.
FrameState end_of_own_part(const RecordingReader& reader, const RecordedFilm& film) {
  FrameHistory history(film.scene(), film.start());
  const std::vector<CuttingRecord> cutting = reader.cutting();
  const std::vector<PortRecord> port = reader.port();
  for (std::size_t row = 0; row < film.rows().size(); ++row) {
    history.add(film.rows()[row], row < cutting.size() ? &cutting[row] : nullptr,
                row < port.size() ? &port[row] : nullptr);
  }
  for (const Edit& edit : film.edits_before(film.rows().size() - 1)) history.add(edit);
  FrameState end = history.state();
  end.force_history_N = end.torque_history_mNm = end.tick_history_us = {};  // the history's own
  return end;
}

/// What summary.json would say of a run with [cutting], from its rows.
nlohmann::ordered_json marks_of_rows(const RecordingReader& reader, const RecordedFilm& film) {
  const Scene& scene = film.scene();
  nlohmann::ordered_json figures = nlohmann::ordered_json::object();
  if (!scene.cutting) return figures;
  const std::optional<VoxelModel> goal = reader.goal();
  RunMarks marks =
      std::move(begin_marks(scene, film.start(), goal ? &*goal : nullptr, film.earlier()).front());
  for (const Edit& edit : film.edits_before(film.rows().size() - 1)) marks.preparation.add(edit);
  for (const TickRecord& row : film.rows()) marks.measures.add(row, nullptr);
  const OutcomeResult outcome = end_marks(marks, film.model());
  figures["outcome"] = outcome_json(scene, outcome);
  if (outcome.goal) figures["goal"] = goal_json(scene, *outcome.goal);
  return figures;
}

/// What came of it: of the whole, and of its own part where that is less. The film is at its end.
std::string outcome_section(const RecordingReader& reader, const RecordedFilm& film,
                            const FrameState& end) {
  const double rate_hz = film.scene().haptics.rate_hz;
  const std::uint64_t own = film.rows().size();
  const std::string& parent = reader.header().parent;
  std::ostringstream html;
  if (const EarlierRun* earlier = film.earlier()) {
    const std::string from = formatted("%.3f s", film.rows().front().time_s);
    html << "<p>Goes on from " << for_html(earlier->recording) << " at " << from << " ("
         << for_html(parent) << "). This is of the whole, from the first tooth on:</p>\n"
         << outcome_table(end, earlier->measures.ticks + own, rate_hz)
         << "<p>This part alone, from " << from << " on:</p>\n"
         << outcome_table(end_of_own_part(reader, film), own, rate_hz);
  } else {
    if (!parent.empty()) {
      html << "<p>Goes on from " << for_html(parent)
           << ". It does not hold what came before: this is of its own part alone.</p>\n";
    }
    html << outcome_table(end, own, rate_hz);
  }
  return html.str();
}

/// All figures of the run as the program wrote them, and what made it.
std::string figures_section(const RecordingReader& reader, const RecordedFilm& film) {
  std::ostringstream html;
  nlohmann::ordered_json figures;
  if (reader.summary()) {
    figures = nlohmann::ordered_json::parse(*reader.summary(), nullptr, false);
  }
  std::string title = "All figures, summary.json";
  if (!figures.is_object()) {
    html << "<p>The recording holds no summary of its run, which was not ended, or was recorded "
            "before they were kept: these figures are from its rows alone.</p>\n";
    title = "All figures, from the rows";
    figures = marks_of_rows(reader, film);
  }
  html << "<details><summary>" << title << "</summary><table class=\"facts\">\n";
  add_rows(figures, "", html);
  html << "</table>\n<p>"
       << for_html("scene_sha256 " + reader.header().scene_sha256 + ", recorded by " +
                   reader.header().build)
       << "</p></details>\n";
  return html.str();
}

/// A plane across y through the middle of what was cut; none where nothing was.
std::optional<Section> section_of_cut(const RecordedFilm& film, std::span<const Edit> edits) {
  double sum = 0.0;
  std::size_t count = 0;
  const VoxelGrid& grid = film.model().grid;
  for (const Edit& edit : edits) {
    if (edit.body != 0 || edit.cause != EditCause::kCut || !edit.is_gone()) continue;
    sum += grid.world_from_index(grid.cell_of_linear(edit.voxel).cast<double>()).y();
    ++count;
  }
  if (count == 0) return {};
  return Section{1, sum / static_cast<double>(count)};
}

constexpr std::array<Camera, 4> kSides{Camera::kOcclusal, Camera::kReview, Camera::kBuccal,
                                       Camera::kMesial};
constexpr HudParts kNoHud{.title = false, .figures = false, .arrows = false};

/// The tooth after a row, from each side. Returns what it shows.
FrameState draw_sides(RecordedFilm& film, std::size_t row, const char* when, Renderer& renderer,
                      std::array<std::string, kSides.size()>& sides) {
  FrameState state = film.seek_row(row, renderer);
  state.burr_shown = false;
  for (std::size_t side = 0; side < kSides.size(); ++side) {
    renderer.set_viewpoint(kSides[side]);
    const std::string name(kCameraNames[static_cast<std::size_t>(kSides[side])]);
    sides[side] = picture(renderer.draw(state), name + ", " + when);
  }
  return state;
}

/// Beside the burr, cut open at it, at equal steps of the way.
std::string draw_way(RecordedFilm& film, Renderer& renderer) {
  const std::vector<TickRecord>& rows = film.rows();
  Viewpoint beside(-80.0, 20.0);
  beside.follows_burr = true;
  beside.zoom = 0.5;
  renderer.set_viewpoint(beside);
  renderer.set_size(kStripWide, kStripTall);
  renderer.set_hud({.title = false, .figures = false, .arrows = true});
  std::string strip;
  for (std::size_t n = 1; n <= kStrip; ++n) {
    const std::size_t row = (rows.size() - 1) * n / (kStrip + 1);
    const FrameState state = film.seek_row(row, renderer);
    renderer.set_section(Section{1, state.world_from_tool.position.y()});
    strip += picture(renderer.draw(state), formatted("%.2f s, %.2f N", rows[row].time_s,
                                                     norm(rows[row].contact_force_N)));
  }
  renderer.set_section({});
  renderer.set_size(kWide, kTall);
  renderer.set_hud(kNoHud);
  return strip;
}

struct Pictures {
  std::array<std::string, kSides.size()> before, after;
  std::string way;
  std::string cut_open;  // empty where nothing was cut
  FrameState end;
};

/// Brings the film to its end.
Pictures draw_pictures(RecordedFilm& film, const RenderSettings& settings) {
  const std::size_t last = film.rows().size() - 1;
  Renderer renderer(settings, film.bodies(), film.burr().mesh_tool, film.burr().head_length_m);
  renderer.set_hud(kNoHud);
  Pictures pictures;
  draw_sides(film, 0, "before", renderer, pictures.before);
  pictures.way = draw_way(film, renderer);
  pictures.end = draw_sides(film, last, "after", renderer, pictures.after);
  if (const auto section = section_of_cut(film, film.edits_before(last))) {
    renderer.set_section(section);
    renderer.set_viewpoint(Viewpoint(-90.0, 15.0));
    pictures.cut_open =
        picture(renderer.draw(pictures.end),
                formatted("cut open at y = %.2f mm, from buccal", section->at_m / kMillimetre));
  }
  return pictures;
}

/// The pulp's wall over the run: of the warmest place, then of the coldest.
std::string pulp_curves(const PulpHeat& pulp, std::span<const TickRecord> rows) {
  const auto at = [&](const TickRecord& row) -> const PulpHeat::Point* {
    const auto next =
        std::ranges::lower_bound(pulp.curve, row.time_s, {}, &PulpHeat::Point::time_s);
    return next == pulp.curve.end() ? nullptr : &*next;
  };
  const auto part = [&](double PulpHeat::Point::*rise) {
    return [&at, rise](const TickRecord& row) {
      const PulpHeat::Point* const point = at(row);
      return point ? point->*rise : std::numeric_limits<double>::quiet_NaN();
    };
  };
  return curve("Pulp's wall against the start, warmest", "K", "#b3261e", rows,
               part(&PulpHeat::Point::warmest_K)) +
         curve("Pulp's wall against the start, coldest", "K", "#2062b2", rows,
               part(&PulpHeat::Point::coldest_K));
}

/// The tooth cut open while it was cut last, coloured by its temperature; and the pulp's.
std::string heat_part(const RecordingReader& reader, const std::string& recording,
                      RenderSettings settings) {
  RecordedFilm film(reader, recording);
  const std::vector<TickRecord>& rows = film.rows();
  RecordedHeat heat(reader, film.scene(), film.start(), "--review");
  const std::span<const Edit> edits = film.edits_before(rows.size() - 1);
  settings.section = section_of_cut(film, edits);
  std::string html;
  if (settings.section) {
    Renderer renderer(settings, film.bodies(), film.burr().mesh_tool, film.burr().head_length_m);
    renderer.set_hud(kNoHud);
    renderer.set_viewpoint(Viewpoint(-90.0, 15.0));
    const std::size_t row = std::min(
        rows.size() - 1, static_cast<std::size_t>(std::ranges::lower_bound(rows, edits.back().tick,
                                                                           {}, &TickRecord::tick) -
                                                  rows.begin()));
    heat.advance(rows[row].time_s);
    const FrameState state = film.seek_row(row, renderer);
    renderer.colour_by_values(0, temperature_scale(*film.scene().heat),
                              temperatures(heat.tooth(), film.model(), settings.section));
    html += "<div class=\"two\">" +
            picture(renderer.draw(state),
                    formatted("temperature at %.2f s, cut open at y = %.2f mm", rows[row].time_s,
                              settings.section->at_m / kMillimetre)) +
            "</div>\n";
  }
  heat.advance_to_end();
  if (const auto& pulp = heat.tooth().result().pulp) {
    html += "<table>\n" +
            row_of("Pulp's wall, greatest rise",
                   formatted("%+.2f K at %.2f s", pulp->greatest_rise_K, pulp->greatest_rise_s)) +
            row_of(formatted("More than %.1f K", kPulpLimit_K),
                   formatted("%.2f s", pulp->over_limit_s)) +
            row_of("At the end", formatted("%+.2f K", pulp->end_change_K())) + "</table>\n" +
            pulp_curves(*pulp, rows);
  }
  return html;
}

std::vector<std::uint8_t> bytes_of_file(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A video of the run with its sound, in a file that the page holds.
std::string video_part(const RecordingReader& reader, const std::string& recording,
                       const std::string& page, RenderSettings settings) {
  constexpr double kFps = 15.0;
  RecordedFilm film(reader, recording);
  settings.hud = true;
  WholeFile sound(page + ".wav"), video(page + ".mp4");  // beside the page, and never finished
  const double begin_s = film.rows().front().time_s, end_s = film.rows().back().time_s;
  write_recorded_sound(reader, film.scene(), begin_s, end_s + 1.0 / kFps, "--sound", sound);
  Renderer renderer(settings, film.bodies(), film.burr().mesh_tool, film.burr().head_length_m);
  VideoWriter writer(video.beside(), kWide, kTall, kFps, sound.beside());
  for (double frame = 0.0; begin_s + frame / kFps <= end_s; ++frame) {
    writer.add(renderer.draw(film.seek_row(film.row_at(begin_s + frame / kFps), renderer)));
  }
  writer.close();
  return "<video controls width=\"" + std::to_string(kWide) + "\" src=\"data:video/mp4;base64," +
         base64(bytes_of_file(video.beside())) + "\"></video>\n";
}

/// Least tooth over the pulp after each row, mm; empty where there is none to be spared.
std::vector<double> walls_over_pulp_mm(const RecordedFilm& film) {
  PreparationProgress progress(film.start(), film.scene().tissues);
  if (!film.scene().cutting || !progress.has_pulp()) return {};
  std::vector<double> walls_mm;
  walls_mm.reserve(film.rows().size());
  const std::span<const Edit> edits = film.edits_before(film.rows().size() - 1);
  auto edit = edits.begin();
  for (const TickRecord& row : film.rows()) {
    for (; edit != edits.end() && edit->tick <= row.tick; ++edit) progress.add(*edit);
    walls_mm.push_back(progress.wall_over_pulp_m().value_or(std::nan("")) / kMillimetre);
  }
  return walls_mm;
}

/// Of what a scene has besides: the spindle's speed as it sags, the tooth over the pulp.
std::string optional_curves(const RecordingReader& reader, const RecordedFilm& film) {
  const std::vector<TickRecord>& rows = film.rows();
  const auto of_rows = [&](const std::vector<double>& values) {
    return [&rows, &values](const TickRecord& row) {
      return values[static_cast<std::size_t>(&row - rows.data())];
    };
  };
  std::string svg;
  if (film.scene().spindle) {
    std::vector<double> speeds_krpm(rows.size(), std::nan(""));
    const std::vector<CuttingRecord> cutting = reader.cutting();
    for (std::size_t row = 0; row < std::min(rows.size(), cutting.size()); ++row) {
      speeds_krpm[row] = 1e-3 * cutting[row].spindle_rad_per_s / kRevolutionPerMinute;
    }
    svg += curve("Speed of the spindle", "1,000 rpm", "#6b4aa0", rows, of_rows(speeds_krpm));
  }
  if (const std::vector<double> walls_mm = walls_over_pulp_mm(film); !walls_mm.empty()) {
    svg += curve("Tooth over the pulp", "mm", "#96223c", rows, of_rows(walls_mm));
  }
  return svg;
}

std::string curves(const RecordedFilm& film) {
  const std::vector<TickRecord>& rows = film.rows();
  const double voxel_mm3 = std::pow(film.model().grid.voxel_m / kMillimetre, 3);
  double removed = 0.0;
  return curve("Force", "N", "#2062b2", rows,
               [](const TickRecord& row) { return norm(row.force_N); }) +
         curve("Torque", "mN m", "#c45e12", rows,
               [](const TickRecord& row) { return 1e3 * norm(row.torque_Nm); }) +
         curve("In contact", "voxels", "#6b4aa0", rows,
               [](const TickRecord& row) { return static_cast<double>(row.contacts); }) +
         curve("Cut", "mm\xC2\xB3", "#8a6d1c", rows,
               [&](const TickRecord& row) {
                 removed += static_cast<double>(row.removed) * voxel_mm3;
                 return removed;
               }) +
         curve("Compute time of a tick", "\xC2\xB5s", "#1c8054", rows,
               [](const TickRecord& row) { return static_cast<double>(row.step_us); });
}

}  // namespace

void write_review_page(const RecordingReader& reader, const std::string& recording,
                       const std::string& file, ReviewVideo video) {
  const std::string three = three_js();
  RecordedFilm film(reader, recording);
  RenderSettings settings = film.scene().render.value_or(RenderSettings{});
  settings.width = kWide;
  settings.height = kTall;
  settings.section.reset();
  const std::optional<AssessmentSettings> wanted = assessment_of(film.scene().text, recording);
  const std::optional<Assessment> assessment =
      wanted ? assessment_if_cut(reader, recording, *wanted) : std::nullopt;
  const std::string& title = film.scene().title;
  std::ostringstream page;
  page << "<h1>" << for_html(title) << "</h1>\n";
  if (!reader.missing().empty()) page << "<p>" << for_html(reader.missing()) << "</p>\n";
  page << viewer_html();
  const Pictures pictures = draw_pictures(film, settings);
  page << "<div class=\"columns\">\n";
  if (assessment) {
    page << "<div><h2>Assessment</h2>\n" << assessment_table(*assessment) << "</div>\n";
  }
  page << "<div><h2>Outcome</h2>\n"
       << outcome_section(reader, film, pictures.end) << "</div></div>\n";
  page << "<h2>Curves</h2>\n" << curves(film) << optional_curves(reader, film);
  if (video == ReviewVideo::kWithSound) {
    page << "<h2>How it looked and sounded</h2>\n" << video_part(reader, recording, file, settings);
  }
  page << "<h2>The way there, cut open at the burr</h2>\n<div class=\"four\">\n"
       << pictures.way << "</div>\n";
  if (!pictures.cut_open.empty()) {
    page << "<h2>What was cut</h2>\n<div class=\"two\">\n" << pictures.cut_open << "</div>\n";
  }
  if (film.scene().heat) {
    page << "<h2>How warm it became</h2>\n" << heat_part(reader, recording, settings);
  }
  page << "<h2>Before and after</h2>\n<div class=\"two\">\n";
  for (std::size_t side = 0; side < kSides.size(); ++side) {
    page << pictures.before[side] << pictures.after[side];
  }
  page << "</div>\n" << figures_section(reader, film);
  const nlohmann::ordered_json attempt =
      page_attempt(reader, recording, assessment ? &*assessment : nullptr,
                   wanted.value_or(AssessmentSettings{}));
  write_whole_file(file, page_html(title, page.str(), {{"attempts", {attempt}}}, three));
}

}  // namespace sulcus
