#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/report/results_folder.hpp"
#include "app/session/session.hpp"
#include "app/session/simulation.hpp"
#include "engine/core/pose.hpp"

namespace sulcus {

/// A run that its device or a window ends ends after this at the latest.
inline constexpr double kLongestLiveRun_s = 24.0 * 3600.0;

/// A run under a hand is a part, and another for each time that time was taken back or the burr was
/// changed: each with a folder and a recording of its own, the next one going on from the one
/// before.
struct LivePart {
  std::unique_ptr<Simulation> simulation;
  Pose start;  // of the device
  SessionOptions session;
  std::vector<PartUse> loading;
  std::optional<ResultsFolder> folder;

  std::string recording() const { return folder.value().path() + "/recording.h5"; }
};

/// What was asked for when a part ended.
struct GoOn {
  double at_s = std::numeric_limits<double>::infinity();  // of its time; beyond it: from its end
  std::vector<std::string> overrides;                     // as of --set
};

/// The part that goes on from a recording, in `folder`. InputError as continue_run.
LivePart part_after(const std::string& recording, const GoOn& from, const std::string& folder);

/// The same; where what is asked for of the burr cannot be, with the one before, and `refused` says
/// why. @throws std::runtime_error where that cannot be either.
LivePart part_after(const std::string& recording, const GoOn& from, const std::string& folder,
                    std::string& refused);

}  // namespace sulcus
