#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sulcus::lab {

/// One line of recordings.csv.
struct TrialRow {
  std::string trial, quantity;
  double value = 0.0;
  std::optional<double> most;  // none: reported only
  bool pass() const { return !most || value <= *most; }
};

/// What the trials are made with.
struct TrialSetting {
  std::string program;  // sulcus
  std::string folder;   // for their files
  int kills = 200;
  int flips = 1000;
  int cut_bytes = 65536;  // off the end, one by one
  int ticks = 2000;       // of the cut that is gone back through
};

/// Runs killed with SIGKILL at random moments, every other one at real pace: whether the file
/// opens, is as far as it goes what an undisturbed run gives, and can be repaired; and how much of
/// the clock is missing, from the last time the file was written to the kill.
std::vector<TrialRow> trial_of_kills(const TrialSetting& setting);
/// A recording cut short by every number of bytes, closed and killed.
std::vector<TrialRow> trial_of_cuts(const TrialSetting& setting);
/// One bit of it turned round, at random.
std::vector<TrialRow> trial_of_flips(const TrialSetting& setting);
/// Every tick of a cut, from the last to the first: the hashes of the way on and those recorded.
std::vector<TrialRow> trial_of_going_back(const TrialSetting& setting);
/// How long a random time of a recording takes to be reached once it is open. `scene`: its file.
std::vector<TrialRow> trial_of_reach(const TrialSetting& setting, const std::string& scene);

/// A scene cut all over for so long, as fast as it goes: to and fro, deeper every time. Its memory
/// is looked at every second; what it has after a minute is what it may have.
std::vector<TrialRow> trial_of_soak(const TrialSetting& setting, const std::string& scene,
                                    double minutes);

}  // namespace sulcus::lab
