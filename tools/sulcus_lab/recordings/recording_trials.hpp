#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sulcus::lab {

/// One line of recordings.csv.
struct TrialRow {
  template <class Value>
  TrialRow(std::string trial_name, std::string quantity_name, Value value_of,
           std::optional<double> most_of = {})
      : trial(std::move(trial_name)),
        quantity(std::move(quantity_name)),
        value(static_cast<double>(value_of)),
        most(most_of) {}

  std::string trial, quantity;
  double value;
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
/// opens, is as far as it goes what an undisturbed run gives, and can be repaired; and how much
/// time is missing: at real pace what no row is of, at any since the file was last written.
std::vector<TrialRow> trial_of_kills(const TrialSetting& setting);
/// Recordings cut short by every number of bytes: one that was closed, and one of a killed run.
std::vector<TrialRow> trial_of_cuts(const TrialSetting& setting);
/// One bit of them turned round, at random.
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
