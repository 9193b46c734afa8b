#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/session/feed.hpp"
#include "app/session/run_marks.hpp"
#include "app/session/run_statistics.hpp"
#include "app/session/simulation.hpp"
#include "engine/heat/tooth_heat.hpp"
#include "engine/volume/input_geometry.hpp"
#include "haptics/loose_schedule.hpp"

namespace sulcus {

// The threads of a run
//
//                     reports, edits
//   HapticLoop ------------+---> ReportThread    statistics, marks
//   the ticks              +---> RecorderThread  recording.h5      with [record]
//       ^                  +---> RenderThread    frames/           with [render]
//       |                  +---> watch           a window          where one is open
//       |                  +---> StreamThread    OpenIGTLink       with [stream]
//       |                  +---> PiecesThread    loose pieces      with [loose_pieces]
//       |  voxels that leave         |   |
//       +----------------------------+   +---> poses, to recorder, renderer and watch
//
// Properties
//
// - Isolated: each thread has copies of the volumes that it needs. What it learns of a run it has
//   from its feed (feed.hpp) alone.
// - Deterministic: a tick reads of other threads only which voxels leave, and a fast run waits for
//   that. At real pace the tick that takes an answer is recorded, so that a replay does the same.
// - Unhindered: the haptic thread waits for nobody at real pace. Everything is made before the
// first
//   tick.
// - Contained: a thread that throws closes its feed and is reported at the end. Only where reports
// or
//   pieces fail, without which there is no result, the run ends. The force is taken away first.
// - Whole: who consumes a feed ends after all that was pushed into it.

enum class Pace : std::uint8_t { kReal, kFast };

class StreamPort;
struct SessionResult;

struct SessionOptions {
  std::string folder;  // summary.json, forces.png, log.txt, recording.h5, frames/
  Pace pace = Pace::kFast;
  std::uint64_t ticks = 0;  // at most, from where the simulation is
  bool render = true;       // draw, where the scene has [render]
  /// What the file of the scene's goal holds, on the workpiece's grid, where it names one.
  std::optional<VoxelModel> goal = {};
  /// Where the workpiece's file lies, for its recording; none of a built-in shape.
  std::optional<InputGeometry> input = {};
  /// When answers of loose pieces were taken in the recording that is run again; none: a new run.
  std::optional<std::vector<TakenAnswer>> played_back = {};
  /// Called on the thread of run_session while the run lasts, with a feed of its own; when it
  /// returns, the run ends.
  std::function<void(Feed&)> watch = {};
  /// Called when all is set up, before the first tick; may be empty.
  std::function<void()> begins = {};
  /// Called on the recorder's thread where the recording ends before the run, which goes on; must
  /// not throw, may be empty. At real pace the log says why at once.
  std::function<void()> recording_ends = {};
  /// No tick while it is true; null: never.
  const std::atomic<bool>* paused = nullptr;
  /// Where the run is sent to who connects (app/stream/stream_port.hpp), where the scene has
  /// [stream]; null: to nobody.
  std::shared_ptr<StreamPort> stream = {};
  /// Of a run that goes on from a recording: from which, and where; else empty.
  std::string parent = {};
  /// What came before the first tick, of a run that goes on from a recording; null else.
  std::shared_ptr<const EarlierRun> earlier = {};
  /// Makes the text of summary.json when all else has ended: the recording keeps it. Null: it has
  /// none.
  std::function<std::string(const SessionResult&)> summarise = {};
};

/// A part of the program that ran, as the summary lists it.
struct PartUse {
  std::string name;
  double seconds = 0.0;  // to set it up, or of its own work
  std::size_t bytes = 0;
  std::optional<bool> cached = {};  // of what may come from the load cache: whether it did
};

/// What was sent while a run went on.
struct StreamResult {
  std::uint64_t clients = 0;  // that connected
  std::uint64_t samples = 0;  // for any of them
  std::uint64_t dropped = 0;  // of those, not sent: the client did not keep up, or had gone
};

struct SessionResult {
  RunStatistics statistics;
  std::optional<OutcomeResult> outcome;  // of a scene with [cutting], from the first tooth on
  std::optional<OutcomeResult> part;     // of a run that goes on from another: its own alone
  std::optional<HeatResult> heat;        // of a scene with [heat]
  std::optional<StreamResult> stream;    // where it was sent
  std::string summary;                   // as `summarise` made it
  std::vector<PartUse> parts;
  std::uint64_t missed_ticks = 0;  // whole periods that late wakes cost
  std::uint64_t dropped_rows = 0;  // not recorded: the disk did not keep up
  bool interrupted = false;
  std::vector<std::string> refused;  // by the system, at real pace
  std::vector<std::string> files;    // written, in the order to be named
  std::exception_ptr failure;        // the first of a part of it: the rest is whole
  std::uint64_t frames = 0;
  std::uint64_t pieces = 0;  // that came loose
  double wall_seconds = 0.0;
  double load_seconds = 0.0;  // from the start of the process to the first tick
};

/// Runs a simulation against a device until its ticks are over, a stop is requested
/// (engine/core/stop.hpp) or a fault ends it. Returns after everything is on disk, also where a
/// thread failed. Throws where it cannot begin.
SessionResult run_session(Simulation& simulation, Device& device, const SessionOptions& options);

}  // namespace sulcus
