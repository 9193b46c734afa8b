#include "app/live/live_part.hpp"

#include <stdexcept>
#include <utility>

#include "app/playback/continued_run.hpp"
#include "app/playback/recorded_run.hpp"
#include "engine/core/error.hpp"

namespace sulcus {

LivePart part_after(const std::string& recording, const GoOn& from, const std::string& folder) {
  RecordedRun run = open_recorded_run(recording);
  const std::size_t row = row_at(run.rows, from.at_s);
  LivePart part;
  ContinuedRun continued = continue_run(run, row, from.overrides);
  part.simulation = std::move(continued.simulation);
  part.session.earlier = std::move(continued.earlier);
  part.session.parent = std::move(continued.parent);
  part.session.goal = run.reader.goal();
  part.session.input = run.reader.input();
  part.start = pose_of(run.rows[row].device_position_m, run.rows[row].device_orientation);
  part.folder.emplace(ResultsPlace{{}, folder});
  return part;
}

LivePart part_after(const std::string& recording, const GoOn& from, const std::string& folder,
                    std::string& refused) {
  try {
    return part_after(recording, from, folder);
  } catch (const InputError& error) {
    refused = error.what();
    GoOn same_burr = from;
    std::erase_if(same_burr.overrides, is_other_burr);
    try {
      return part_after(recording, same_burr, folder);
    } catch (const InputError& why) {  // of no input: the run is on
      throw std::runtime_error(why.what());
    }
  }
}

}  // namespace sulcus
