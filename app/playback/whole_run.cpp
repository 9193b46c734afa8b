#include "app/playback/whole_run.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <tuple>
#include <utility>

#include "app/playback/recorded_run.hpp"
#include "engine/core/error.hpp"

namespace sulcus {

namespace {

using Burrs = std::vector<BurrSettings>;

void add_burr(const BurrSettings& burr, Burrs& burrs) {
  const auto what = [](const BurrSettings& b) {
    return std::tie(b.shape, b.file, b.diameter_m, b.length_m, b.material, b.grit);
  };
  if (std::ranges::none_of(burrs, [&](const auto& b) { return what(b) == what(burr); })) {
    burrs.push_back(burr);
  }
}

/// The one that was gone on from; none where it is not there, or another.
std::optional<RecordingReader> recording_before(const EarlierRun& earlier,
                                                const std::string& recording) {
  const std::filesystem::path named(earlier.recording);
  const std::filesystem::path beside =
      std::filesystem::path(recording).parent_path() / named.filename();
  for (const std::filesystem::path& file : {named, beside}) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) continue;
    if (std::filesystem::equivalent(file, recording, error)) continue;
    try {
      RecordingReader reader(file.string());
      if (reader.header().scene_sha256 == earlier.scene_sha256) return reader;
    } catch (const InputError&) {  // no recording any more
    }
  }
  return {};
}

/// Adds the rows before tick `end`; false where they are not all there.
bool add_rows(const RecordingReader& reader, std::uint64_t end, std::vector<TickRecord>& rows,
              Burrs& burrs) {
  std::vector<TickRecord> own = reader.ticks();
  if (own.empty() || own.front().tick >= end) return false;  // also where they go round in a ring
  if (const auto earlier = reader.earlier()) {
    const auto before = recording_before(*earlier, reader.path());
    if (!before || !add_rows(*before, own.front().tick, rows, burrs)) return false;
    if (rows.size() != earlier->measures.ticks) return false;
  } else if (!reader.header().parent.empty()) {
    return false;  // of before recordings held what came before them
  }
  const Scene scene = recorded_scene(reader, reader.path());
  add_burr(scene.burr, burrs);
  std::erase_if(own, [end](const TickRecord& row) { return row.tick >= end; });
  rows.insert(rows.end(), own.begin(), own.end());
  return true;
}

}  // namespace

std::optional<WholeRun> whole_run(const RecordingReader& reader) {
  WholeRun whole;
  Burrs burrs;
  if (!add_rows(reader, ~std::uint64_t{0}, whole.rows, burrs)) return {};
  whole.burrs = burrs.size();
  return whole;
}

}  // namespace sulcus
