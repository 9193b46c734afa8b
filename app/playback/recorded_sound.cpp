#include "app/playback/recorded_sound.hpp"

#include <algorithm>
#include <cstddef>

#include "app/playback/recorded_run.hpp"
#include "engine/core/error.hpp"
#include "engine/sound/wav_file.hpp"

namespace sulcus {

namespace {

constexpr std::uint64_t kSeed = 1;

/// Specific cutting energy of what went in each tick of `ticks`, the mean over its voxels.
class Hardness {
 public:
  Hardness(const RecordingReader& reader, const Scene& scene)
      : scene_(scene), workpiece_(recorded_workpiece(reader, scene)), edits_(reader.edits()) {}

  /// Of ticks that rise from call to call; 0 where none went.
  double of_tick(std::uint64_t tick) {
    double sum = 0.0;
    std::size_t voxels = 0;
    for (; next_ < edits_.size() && edits_[next_].tick <= tick; ++next_) {
      if (edits_[next_].cause != EditCause::kCut || edits_[next_].tick < tick) continue;
      sum += scene_.tissues[tissue_of(edits_[next_])].specific_energy_J_per_m3;
      ++voxels;
    }
    return voxels > 0 ? sum / static_cast<double>(voxels) : 0.0;
  }

 private:
  std::size_t tissue_of(const Edit& edit) const {
    if (edit.body == 0) return workpiece_.tissue(workpiece_.grid.cell_of_linear(edit.voxel));
    return scene_.bodies[edit.body - std::size_t{1}].tissue.value_or(0);
  }

  const Scene& scene_;
  VoxelModel workpiece_;
  std::vector<Edit> edits_;
  std::size_t next_ = 0;
};

}  // namespace

std::vector<SoundTick> recorded_sound(const RecordingReader& reader, const Scene& scene,
                                      const std::string& option) {
  const std::vector<TickRecord> rows = reader.ticks();
  const std::vector<CuttingRecord> cutting = reader.cutting();
  if (cutting.empty()) {
    throw InputError(reader.path(), option, "a scene without [cutting], whose burr does not turn",
                     "the recording of one with it");
  }
  Hardness hardness(reader, scene);
  std::vector<SoundTick> ticks;
  ticks.reserve(cutting.size());
  for (std::size_t row = 0; row < cutting.size(); ++row) {
    SoundTick tick{rows[row].time_s, cutting[row].spindle_rad_per_s, 0.0,
                   hardness.of_tick(rows[row].tick)};
    if (row > 0) {
      const auto ticks_since = static_cast<double>(rows[row].tick - rows[row - 1].tick);
      tick.power_W =
          (cutting[row].work_J - cutting[row - 1].work_J) * reader.header().rate_hz / ticks_since;
    }
    ticks.push_back(tick);
  }
  return ticks;
}

void write_recorded_sound(const RecordingReader& reader, const Scene& scene, double begin_s,
                          double end_s, const std::string& option, const WholeFile& file) {
  const std::vector<SoundTick> ticks = recorded_sound(reader, scene, option);
  end_s = std::min(end_s, ticks.back().time_s + 1.0 / reader.header().rate_hz);
  HandpieceSound sound(ticks, begin_s, end_s, kSeed);
  write_wav(file, kSoundRate_hz, [&](std::span<float> block) { return sound.next(block); });
}

}  // namespace sulcus
