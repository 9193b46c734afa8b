#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace sulcus {

/// What results are of. Those of one kind may lie beside those of another in one folder: each has a
/// mark of its own, and leaves the other's alone.
enum class ResultsKind : std::uint8_t { kRun, kAssessment };

/// Where results go, and what may be replaced there.
struct ResultsPlace {
  std::string given;      // of -o; empty: not given
  std::string otherwise;  // where they go then, or beside it: NAME, NAME-2, NAME-3, ...
  bool force = false;     // --force: another run that is in the folder of -o is replaced
  /// What its results follow from to the bit (run_key.hpp); empty: it is like no other (a hand's,
  /// one that goes on from another), and replaces nothing.
  std::string key = {};
  bool adds = false;  // what is written comes beside what the same run has left there
  ResultsKind kind = ResultsKind::kRun;
};

/// A folder of results: of one run, and of one process while it writes. Nothing of another run is
/// written over, and nothing of a user's own that lies there is touched. What is said of a run
/// holds of an assessment likewise:
///
///   holds no run                       it is taken
///   the same run, by its key           replaced whole, once the new results are there
///   another run, or it is being        the next free name; of -o InputError, but with --force the
///   written to                         run there is replaced like the same one
///
/// It is marked by a hidden file, locked for as long as this lives. What replaces another is
/// written into a hidden folder in it first, so that a run that is killed costs nothing that was
/// there.
class ResultsFolder {
 public:
  /// Makes the folder. InputError where the one of -o may not be taken, where the folder cannot be
  /// written, or where what bears the name of a result in it cannot be replaced; std::runtime_error
  /// where the disk is full.
  explicit ResultsFolder(const ResultsPlace& place);
  /// Unlocks it. What was not finished stays where it was written.
  ~ResultsFolder();
  ResultsFolder(ResultsFolder&&) noexcept;
  ResultsFolder& operator=(ResultsFolder&&) noexcept;

  /// Where to write.
  const std::string& at() const { return at_; }
  /// Puts what was written where it belongs. `whole`: nothing of the run is missing; else it does
  /// not replace what was there, and goes to the next free name. std::runtime_error where that
  /// cannot be done: what was there is then as it was.
  void finish(bool whole);
  /// Where the results are, after `finish`.
  const std::string& path() const { return path_; }

 private:
  class Mark;
  bool take(const std::string& folder, const ResultsPlace& place);
  void begin_beside();

  std::string path_, at_, key_;
  ResultsKind kind_;
  std::unique_ptr<Mark> mark_;
};

}  // namespace sulcus
