#include "app/playback/continued_run.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "app/playback/recorded_state.hpp"
#include "engine/core/error.hpp"
#include "engine/core/realtime.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/volume/packed_model.hpp"
#include "haptics/saved_state.hpp"

namespace sulcus {

namespace {

/// What makes the bodies and the tool is in the recording, and the tool's way is played back.
void check_overrides(const std::vector<std::string>& overrides) {
  for (const std::string& text : overrides) {
    const std::string key = text.substr(0, text.find('='));
    const std::string table = key.substr(0, key.find('.'));
    if (table == "workpiece" || table == "trajectory" || table == "goal" ||
        key == "haptics.rate_hz") {
      throw InputError("", "--set " + key, "what the recording holds already",
                       "a key of how it is felt, cut or drawn");
    }
  }
}

/// What is left of a body, as a replay of the new recording will read it: without the tissues of
/// what is gone.
VoxelModel as_recorded(const Workpiece& body) { return unpack(pack(body.model())); }

}  // namespace

bool asks_for_a_burr(const std::string& override_text) {
  const std::string key = override_text.substr(0, override_text.find('='));
  return (key == "burr" || key.starts_with("burr.")) && key != "burr.speed_rpm" &&
         key != "burr.tangential_ratio";
}

std::unique_ptr<Simulation> simulation_after(RecordedRun& run, std::size_t row,
                                             const std::vector<std::string>& overrides,
                                             std::optional<Burr> burr) {
  check_overrides(overrides);
  if (burr.has_value() != std::ranges::any_of(overrides, asks_for_a_burr)) {
    throw std::logic_error("a burr is another one where it was asked for");
  }
  RecordedState state(run);
  state.seek_row(row);
  const Simulation& then = state.simulation();
  std::vector<VoxelModel> bodies;
  for (const Neighbour& n : then.state().neighbours) bodies.push_back(as_recorded(n.solid));
  std::vector<std::byte> bytes;
  save_state(then.state(), bytes);
  const Scene scene = parse_scene(run.reader.header().scene_toml, run.path, overrides);
  if (burr) {
    check_start(scene, then.workpiece().model(), bodies, *burr,
                pose_of(run.rows[row].tool_position_m, run.rows[row].tool_orientation));
  } else {
    burr = recorded_burr(run.reader, scene);
  }
  auto simulation = std::make_unique<Simulation>(scene, as_recorded(then.workpiece()),
                                                 make_neighbours(scene, std::move(bodies)),
                                                 std::move(*burr), StageClock(steady_ns));
  if (!simulation->load_state(bytes)) throw std::logic_error("a state that was just saved");
  return simulation;
}

std::shared_ptr<const EarlierRun> earlier_of(const RecordedRun& run, std::size_t row) {
  auto earlier = std::make_shared<EarlierRun>();
  if (run.earlier) {
    *earlier = *run.earlier;
  } else {
    earlier->start = run.reader.workpiece();
  }
  earlier->recording = run.path;
  earlier->scene_sha256 = run.reader.header().scene_sha256;
  const std::vector<Edit> edits =
      run.reader.edits(0, static_cast<std::size_t>(run.rows[row].edits_end));
  earlier->edits.insert(earlier->edits.end(), edits.begin(), edits.end());
  const std::vector<PortRecord> port = run.reader.port(0, row + 1);
  for (std::size_t i = 0; i <= row; ++i) {
    earlier->measures.add(run.rows[i], i < port.size() ? &port[i] : nullptr);
  }
  return earlier;
}

std::string parent_of(const RecordedRun& run, std::size_t row) {
  return std::filesystem::path(run.path).filename().string() + ", after tick " +
         std::to_string(run.rows[row].tick) + ", scene_sha256 " + run.reader.header().scene_sha256;
}

}  // namespace sulcus
