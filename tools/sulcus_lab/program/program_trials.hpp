#pragma once

#include <string>
#include <utility>
#include <vector>

namespace sulcus::lab {

/// One build of Sulcus, and where its trials may write.
struct ProgramBuild {
  std::string folder;   // of the build: `sulcus` and `sulcus-lab` lie in it
  std::string scratch;  // empty at first
};

/// What a trial has measured once: names with their units, in the same order every time.
using ProgramFigures = std::vector<std::pair<std::string, double>>;

struct ProgramTrial {
  const char* name;
  const char* measures;
  ProgramFigures (*run)(const ProgramBuild& build);
  bool takes_minutes = false;
};

/// The trials by name. Each runs the programs of a build as processes of their own and throws
/// std::runtime_error where one of them fails.
const std::vector<ProgramTrial>& program_trials();

}  // namespace sulcus::lab
