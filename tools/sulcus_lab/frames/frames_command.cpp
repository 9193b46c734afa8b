#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "app/commands/number_within.hpp"
#include "app/session/frame_history.hpp"
#include "app/session/live_film.hpp"
#include "app/session/session.hpp"
#include "engine/core/realtime.hpp"
#include "engine/graphics/egl_context.hpp"
#include "engine/graphics/gl_scene.hpp"
#include "engine/import/build_workpiece.hpp"
#include "engine/import/load_burr.hpp"
#include "engine/outcome/preparation_progress.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/trajectory.hpp"
#include "haptics/device/device.hpp"
#include "tools/sulcus_lab/commands.hpp"
#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/statistics.hpp"

namespace sulcus::lab {

namespace {

struct FramesOptions {
  std::string folder = "out/lab/frames";
  std::string scene = SULCUS_SCENES "/cut_sulcus.toml";
  double seconds = 8.0;
  std::array<int, 2> size{1280, 720};  // of a picture, pixels
};

enum class Drawing { kNone, kResting, kTurning };

struct Frames {
  std::vector<float> frame_ms;  // each picture, from the one before it
  std::vector<float> seen_ms;  // from a tick to the end of the first picture that shows it, longest
  double tick_p50_us = 0.0, tick_p99_us = 0.0;
};

/// Draws what a run tells, as fast as it goes, until it ends: as a window does, without its screen.
void draw(const Simulation& simulation, std::vector<RenderedBody> bodies,
          const FramesOptions& options, Drawing how, Feed& feed, Frames& frames) {
  leave_realtime_core();
  const Scene& scene = simulation.scene();
  RenderSettings settings = scene.render.value_or(RenderSettings{});
  settings.width = options.size[0];
  settings.height = options.size[1];
  LiveFilm film(feed, scene, bodies.front().model);
  const EglContext context;
  GlScene drawing(settings, std::move(bodies), simulation.burr().mesh_tool,
                  simulation.burr().head_length_m);
  drawing.set_hurried(true);
  drawing.set_handpiece(false);
  double azimuth_deg = 0.0;
  std::uint64_t last_ns = 0, shown_before = 0;
  while (!feed.ended) {
    while (film.take()) {
    }
    if (film.empty()) continue;
    if (how == Drawing::kTurning) {
      drawing.set_detail(Detail::kCoarse);
      drawing.set_viewpoint(Viewpoint(azimuth_deg += 2.0, 35.0));
    }
    const FrameState state = film.bring(drawing, LiveFilm::Pieces::kThatAreThere);
    const auto shown = state.tick;
    drawing.draw(state);
    drawing.frame().finish();
    const std::uint64_t now_ns = steady_ns();
    if (last_ns > 0) frames.frame_ms.push_back(1e-6f * static_cast<float>(now_ns - last_ns));
    last_ns = now_ns;
    // The oldest tick that a picture is the first to show: the one after the picture before it.
    std::uint64_t newest = shown;
    while (const auto report = film.take()) newest = report->record.tick;
    if (shown > shown_before) {
      frames.seen_ms.push_back(static_cast<float>(newest - shown_before - 1) * 1e3f /
                               static_cast<float>(scene.haptics.rate_hz));
    }
    shown_before = shown;
  }
}

Frames measure(const Scene& scene, const FramesOptions& options, Drawing how) {
  LoadCache cache = LoadCache::of_user();
  const Trajectory trajectory = make_trajectory(scene.trajectory);
  Simulation simulation(scene, build_workpiece(scene, &cache), build_bodies(scene, &cache),
                        load_burr(scene, &cache));
  ScriptedDevice device(trajectory, scene.haptics.rate_hz);
  Frames frames;
  SessionOptions session;
  session.folder = options.folder;
  session.pace = Pace::kReal;
  session.render = false;
  session.ticks = static_cast<std::uint64_t>(options.seconds * scene.haptics.rate_hz);
  if (how != Drawing::kNone) {
    // Copied before the haptic thread writes them.
    session.watch = [&, bodies = rendered_bodies(simulation)](Feed& feed) {
      draw(simulation, bodies, options, how, feed, frames);
    };
  }
  const SessionResult result = run_session(simulation, device, session);
  if (result.failure) std::rethrow_exception(result.failure);
  frames.tick_p50_us = result.statistics.tick_us.quantile(0.5);
  frames.tick_p99_us = result.statistics.tick_us.quantile(0.99);
  return frames;
}

/// What it costs, a picture at 30 a second, to know what the preparation has come to: the wall over
/// the pulp among it, or, where the pulp goes by another name, without.
struct ProgressCost {
  std::vector<float> with_us, without_us;  // by picture
};

ProgressCost measure_progress(const Scene& scene, double seconds) {
  LoadCache cache = LoadCache::of_user();
  const VoxelModel start = build_workpiece(scene, &cache);
  std::vector<TissueSettings> no_pulp = scene.tissues;
  for (TissueSettings& tissue : no_pulp) {
    if (tissue.name == "pulp") tissue.name = "core";
  }
  PreparationProgress with(start, scene.tissues), without(start, no_pulp);
  const Trajectory trajectory = make_trajectory(scene.trajectory);
  Simulation simulation(scene, start, build_bodies(scene, &cache), load_burr(scene, &cache));
  ScriptedDevice device(trajectory, scene.haptics.rate_hz);
  const auto ticks = static_cast<std::size_t>(seconds * scene.haptics.rate_hz);
  const auto frame_ticks = static_cast<std::size_t>(scene.haptics.rate_hz / 30.0);
  std::vector<Edit> edits;
  ProgressCost cost;
  const auto add_to = [&](PreparationProgress& progress, std::vector<float>& us) {
    const std::uint64_t begin_ns = steady_ns();
    for (const Edit& edit : edits) progress.add(edit);
    us.push_back(1e-3f * static_cast<float>(steady_ns() - begin_ns));
  };
  for (std::size_t tick = 1; tick <= ticks; ++tick) {
    simulation.step(device);
    edits.insert(edits.end(), simulation.edits().begin(), simulation.edits().end());
    if (tick % frame_ticks != 0) continue;
    add_to(with, cost.with_us);
    add_to(without, cost.without_us);
    edits.clear();
  }
  return cost;
}

void frames(const FramesOptions& options) {
  const Scene scene = load_scene(options.scene);
  Results results(options.folder);
  CsvFile csv(results.table("frames.csv"),
              "drawn,frames_per_s,frame_ms_p50,frame_ms_p99,seen_ms_p50,seen_ms_p99,"
              "tick_us_p50,tick_us_p99,tick_p99_to_undrawn");
  std::printf("%-8s %8s %12s %12s %12s %12s %10s %10s %8s\n", "drawn", "frames/s", "frame ms p50",
              "p99", "seen ms p50", "p99", "tick us", "p99", "ratio");
  double undrawn_us = 0.0;
  // Undrawn first and last: what other work on the machine made of it meanwhile shows.
  for (const auto& [name, how] : {std::pair{"none", Drawing::kNone},
                                  {"resting", Drawing::kResting},
                                  {"turning", Drawing::kTurning},
                                  {"none", Drawing::kNone}}) {
    const Frames measured = measure(scene, options, how);
    if (undrawn_us == 0.0) undrawn_us = measured.tick_p99_us;
    double total_ms = 0.0;
    for (const float ms : measured.frame_ms) total_ms += static_cast<double>(ms);
    const double rate =
        total_ms > 0.0 ? 1e3 * static_cast<double>(measured.frame_ms.size()) / total_ms : 0.0;
    const double ratio = measured.tick_p99_us / undrawn_us;
    std::ostringstream line;
    line << name << ',' << rate << ',' << quantile(measured.frame_ms, 0.5) << ','
         << quantile(measured.frame_ms, 0.99) << ',' << quantile(measured.seen_ms, 0.5) << ','
         << quantile(measured.seen_ms, 0.99) << ',' << measured.tick_p50_us << ','
         << measured.tick_p99_us << ',' << ratio;
    csv.write(line.str());
    std::printf("%-8s %8.1f %12.1f %12.1f %12.1f %12.1f %10.1f %10.1f %8.2f\n", name, rate,
                quantile(measured.frame_ms, 0.5), quantile(measured.frame_ms, 0.99),
                quantile(measured.seen_ms, 0.5), quantile(measured.seen_ms, 0.99),
                measured.tick_p50_us, measured.tick_p99_us, ratio);
    std::fflush(stdout);
  }
  const ProgressCost cost = measure_progress(scene, options.seconds);
  std::printf(
      "What the preparation has come to, us a picture at 30 a second: %.1f in the mean, at most "
      "%.1f; %.1f in the mean without the wall over the pulp\n",
      mean(cost.with_us), quantile(cost.with_us, 1.0), mean(cost.without_us));
}

}  // namespace

void add_frames_command(CLI::App& program) {
  auto options = std::make_shared<FramesOptions>();
  CLI::App* command = program.add_subcommand(
      "frames", "How fluently a run at real pace is drawn, and what that costs its ticks");
  command->add_option("--scene", options->scene, "Scene (cut_sulcus)");
  command->add_option("--seconds", options->seconds, "Of each run (8)")
      ->check(number_within(0.5, 1000.0));
  command->add_option("--size", options->size, "WxH of a picture (1280x720)")
      ->delimiter('x')
      ->check(CLI::Range(64, 8192));
  command->add_option("-o", options->folder, "Folder for the results (out/lab/frames)");
  command->footer(
      "Writes into the folder:\n"
      "  frames.csv   drawn,frames_per_s,frame_ms_p50,frame_ms_p99,seen_ms_p50,seen_ms_p99,\n"
      "               tick_us_p50,tick_us_p99,tick_p99_to_undrawn");
  command->callback([options] { frames(*options); });
}

}  // namespace sulcus::lab
