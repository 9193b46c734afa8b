#include "app/playback/continued_run.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "app/playback/recorded_state.hpp"
#include "engine/cache/load_cache.hpp"
#include "engine/core/error.hpp"
#include "engine/core/realtime.hpp"
#include "engine/import/load_burr.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/volume/packed_model.hpp"
#include "haptics/saved_state.hpp"

namespace sulcus {

namespace {

/// The recording holds the bodies, and the poses of the tool are played back.
void check_overrides(const std::vector<std::string>& overrides) {
  for (const std::string& text : overrides) {
    const std::string key = text.substr(0, text.find('='));
    const std::string table = key.substr(0, key.find('.'));
    if (table == "workpiece" || table == "trajectory" || table == "goal" || table == "body" ||
        key == "haptics.rate_hz") {
      throw InputError("", "--set " + key, "a key that is fixed by the recording",
                       "one of how it is felt, cut or drawn");
    }
  }
}

/// Whole tables may be given, with any of these in them.
void check_fixed(const Scene& scene, const Scene& recorded) {
  const auto fail = [](const char* key) {
    throw InputError("", std::string("--set ") + key, "a key that is fixed by the recording",
                     "one of how it is felt, cut or drawn");
  };
  if (scene.haptics.rate_hz != recorded.haptics.rate_hz) fail("haptics.rate_hz");
  // Voxels have the numbers of the tissues.
  if (!std::ranges::equal(scene.tissues, recorded.tissues, {}, &TissueSettings::name,
                          &TissueSettings::name)) {
    fail("tissue");
  }
}

/// What is left of a body, as a replay of the new recording will read it: without the tissues of
/// what is gone.
VoxelModel as_recorded(const Workpiece& body) { return unpack(pack(body.model())); }

/// The one that the overrides name, or the recorded one.
Burr burr_of(const RecordedRun& run, const Scene& scene,
             const std::vector<std::string>& overrides) {
  if (std::ranges::none_of(overrides, is_other_burr)) return recorded_burr(run.reader, scene);
  LoadCache cache = LoadCache::of_user();
  return load_burr(scene, &cache);
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
  const std::vector<Edit> edits = recorded_edits(run.reader, row);
  earlier->edits.insert(earlier->edits.end(), edits.begin(), edits.end());
  const std::vector<PortRecord> port = run.reader.port(0, row + 1);
  for (std::size_t i = 0; i <= row; ++i) {
    earlier->measures.add(run.rows[i], i < port.size() ? &port[i] : nullptr);
  }
  return earlier;
}

}  // namespace

bool is_other_burr(const std::string& override_text) {
  const std::string key = override_text.substr(0, override_text.find('='));
  return (key == "burr" || key.starts_with("burr.")) && key != "burr.speed_rpm" &&
         key != "burr.tangential_ratio";
}

ContinuedRun continue_run(RecordedRun& run, std::size_t row,
                          const std::vector<std::string>& overrides) {
  check_overrides(overrides);
  const RecordingHeader& header = run.reader.header();
  ContinuedRun continued;
  continued.earlier = earlier_of(run, row);
  continued.parent = std::filesystem::path(run.path).filename().string() + ", after tick " +
                     std::to_string(run.rows[row].tick) + ", scene_sha256 " + header.scene_sha256;
  const Scene scene = parse_scene(header.scene_toml, run.path, overrides);
  check_fixed(scene, parse_scene(header.scene_toml, run.path));
  Burr burr = burr_of(run, scene, overrides);
  RecordedState state(run);
  state.seek_row(row);
  const Simulation& then = state.simulation();
  std::vector<VoxelModel> bodies;
  for (const Body& body : then.state().others()) bodies.push_back(as_recorded(body.solid));
  if (std::ranges::any_of(overrides, is_other_burr)) {
    check_start(scene, then.workpiece().model(), bodies, burr,
                pose_of(run.rows[row].tool_position_m, run.rows[row].tool_orientation));
  }
  std::vector<std::byte> bytes;
  save_state(then.state(), bytes);
  continued.simulation =
      std::make_unique<Simulation>(scene, as_recorded(then.workpiece()), std::move(bodies),
                                   std::move(burr), StageClock(steady_ns));
  if (!continued.simulation->load_state(bytes)) {
    throw std::logic_error("a state that was just saved");
  }
  return continued;
}

}  // namespace sulcus
