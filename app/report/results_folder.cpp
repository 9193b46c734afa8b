#include "app/report/results_folder.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <regex>
#include <span>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "app/report/output_file.hpp"
#include "engine/core/error.hpp"
#include "engine/scene/assessment_table.hpp"

namespace sulcus {

namespace fs = std::filesystem;

namespace {

/// What bears which name in a folder, by ResultsKind.
struct KindNames {
  const char* another;
  const char* mark;        // its text: the key of the run
  const char* unfinished;  // what is to replace the results
  std::span<const char* const> files;
};
constexpr std::array kRunFiles{"summary.json", "forces.png",        "log.txt",
                               "recording.h5", "recording.h5.part", "scene.toml"};
constexpr std::array kAssessmentFiles{"assessment.json", "assessment.csv", "comparison.html"};
constexpr std::array<KindNames, 2> kKinds{
    {{"another run", ".sulcus-run", ".unfinished", kRunFiles},
     {"another assessment", ".sulcus-assessment", ".unfinished-assessment", kAssessmentFiles}}};

const KindNames& kind_names(ResultsKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

[[noreturn]] void refuse_folder(const std::string& folder) {
  throw InputError(folder, "", "no folder that can be written", "one for the results, -o DIR");
}

/// The files of such names that lie in a folder.
std::vector<fs::path> named_in(const fs::path& folder, ResultsKind kind) {
  std::vector<fs::path> found;
  std::error_code ignored;
  for (const char* name : kind_names(kind).files) {
    if (fs::is_regular_file(folder / name, ignored)) found.push_back(folder / name);
  }
  return found;
}

/// With the pictures and films of what was not met.
void add_assessment_in(const fs::path& folder, std::vector<fs::path>& found) {
  std::ranges::copy(named_in(folder, ResultsKind::kAssessment), std::back_inserter(found));
  std::error_code ignored;
  for (const MeasureName& measure : measure_names()) {
    for (const char* ending : {".png", ".mp4"}) {
      const fs::path file = folder / (std::string(measure.name) + ending);
      if (fs::is_regular_file(file, ignored)) found.push_back(file);
    }
  }
}

std::vector<fs::path> results_in(const std::string& folder, ResultsKind kind);

/// Of the parts that a run went on with, each in a folder of its own (app/live/live_part.hpp).
void add_parts_in(const std::string& folder, std::vector<fs::path>& found) {
  static const std::regex part("part_[1-9][0-9]*(-[1-9][0-9]*)?");
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (!fs::is_directory(entry.symlink_status(ignored)) ||
        !std::regex_match(entry.path().filename().string(), part)) {
      continue;
    }
    const std::vector<fs::path> files = results_in(entry.path().string(), ResultsKind::kRun);
    if (files.empty()) continue;
    std::ranges::copy(files, std::back_inserter(found));
    const fs::path mark = entry.path() / kind_names(ResultsKind::kRun).mark;
    if (fs::is_regular_file(mark, ignored)) found.push_back(mark);
  }
}

/// The files of results that lie in a folder; not what a user has put there.
std::vector<fs::path> results_in(const std::string& folder, ResultsKind kind) {
  std::vector<fs::path> found;
  std::error_code ignored;
  if (kind == ResultsKind::kAssessment) {
    add_assessment_in(folder, found);
    static const std::regex attempt("[1-9][0-9]*");
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      if (entry.is_directory(ignored) &&
          std::regex_match(entry.path().filename().string(), attempt)) {
        add_assessment_in(entry.path(), found);
      }
    }
    return found;
  }
  found = named_in(folder, kind);
  static const std::regex frame("[0-9]{6,}\\.png"), tooth("tooth_[0-9]+\\.[0-9]+_s\\.stl");
  // Pictures of its recording (render), which would be another's.
  static const std::regex drawn(".+_[0-9]+\\.[0-9]+s.*\\.png");
  for (const auto& [inner, name] :
       {std::pair{"frames", &frame}, std::pair{"render", &drawn}, std::pair{"", &tooth}}) {
    for (const auto& entry : fs::directory_iterator(fs::path(folder) / inner, ignored)) {
      if (entry.is_regular_file(ignored) &&
          std::regex_match(entry.path().filename().string(), *name)) {
        found.push_back(entry.path());
      }
    }
  }
  add_parts_in(folder, found);
  return found;
}

/// What bears a result's name and is no file cannot be replaced by one.
void check_names(const std::string& folder, ResultsKind kind) {
  std::error_code ignored;
  for (const char* name : kind_names(kind).files) {
    const fs::path file = fs::path(folder) / name;
    if (!fs::is_directory(fs::symlink_status(file, ignored))) continue;
    throw InputError(file.string(), "", "a folder of a result's name",
                     "a file, or another folder for the results, -o DIR");
  }
  const fs::path frames = fs::path(folder) / "frames";
  if (kind != ResultsKind::kRun || !fs::exists(frames, ignored)) return;
  if (fs::is_directory(frames, ignored)) return;
  throw InputError(frames.string(), "", "a file of the name of the pictures' folder",
                   "a folder, or another one for the results, -o DIR");
}

/// The files below a folder, by their way from it. All of them can be moved to where they belong
/// below another, whose folders are made. @throws std::runtime_error where one cannot.
std::vector<fs::path> files_to_move(const std::string& from, const std::string& to) {
  std::vector<fs::path> files, folders;
  const auto refuse = [](const fs::path& there, const char* what) {
    throw std::runtime_error(there.string() + ": cannot be replaced: " + what);
  };
  std::error_code ignored;
  for (const auto& entry : fs::recursive_directory_iterator(from)) {
    const fs::path name = entry.path().lexically_relative(from), there = fs::path(to) / name;
    if (entry.is_directory()) {
      if (fs::exists(fs::symlink_status(there, ignored)) && !fs::is_directory(there, ignored)) {
        refuse(there, "it is no folder");
      }
      folders.push_back(there);
    } else {
      if (fs::is_directory(fs::symlink_status(there, ignored))) refuse(there, "it is a folder");
      files.push_back(name);
    }
  }
  for (const fs::path& folder : folders) fs::create_directories(folder);
  return files;
}

/// A name that is not taken, beside a folder.
std::string next_free_name(const std::string& folder) {
  fs::path path = fs::absolute(folder).lexically_normal();
  if (path.filename().empty()) path = path.parent_path();  // it ended with a slash
  const bool told_whole = fs::path(folder).is_absolute();
  for (int number = 2;; ++number) {
    const fs::path name = path.string() + "-" + std::to_string(number);
    if (fs::exists(fs::symlink_status(name))) continue;
    return told_whole ? name.string() : fs::relative(name).string();
  }
}

}  // namespace

/// The hidden file of a folder whose text is the key of the run there; locked.
class ResultsFolder::Mark {
 public:
  Mark(const std::string& folder, ResultsKind kind)
      : file_(::open((folder + "/" + kind_names(kind).mark).c_str(),
                     O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666)) {
    if (file_ < 0 && (errno == ENOSPC || errno == EDQUOT)) {
      throw std::runtime_error(folder + ": cannot be written: " + strerror(errno));
    }
    if (file_ < 0) refuse_folder(folder);
    // Where there are no locks (a network's disk) it is as if nobody else were there.
    is_ours_ = ::flock(file_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
  }
  ~Mark() { ::close(file_); }
  Mark(const Mark&) = delete;
  Mark& operator=(const Mark&) = delete;

  /// Whether no other process has it.
  bool is_ours() const { return is_ours_; }
  std::string key() const {
    std::array<char, 256> text{};
    const ssize_t bytes = ::pread(file_, text.data(), text.size(), 0);
    return {text.data(), bytes > 0 ? static_cast<std::size_t>(bytes) : 0};
  }
  /// Where there is no room for it the run is like no other, and replaces nothing later.
  void set_key(const std::string& key) {
    if (::ftruncate(file_, 0) == 0 &&
        ::pwrite(file_, key.data(), key.size(), 0) != static_cast<ssize_t>(key.size())) {
      (void)!::ftruncate(file_, 0);
    }
  }

 private:
  int file_;
  bool is_ours_ = false;
};

ResultsFolder::ResultsFolder(const ResultsPlace& place) : key_(place.key), kind_(place.kind) {
  if (!place.given.empty()) {
    take(place.given, place);
    return;
  }
  std::string name = place.otherwise;
  for (int number = 2; !take(name, place); ++number) {
    name = place.otherwise + "-" + std::to_string(number);
  }
}

ResultsFolder::~ResultsFolder() = default;
ResultsFolder::ResultsFolder(ResultsFolder&&) noexcept = default;
ResultsFolder& ResultsFolder::operator=(ResultsFolder&&) noexcept = default;

/// False where the folder is another's and another name will do.
bool ResultsFolder::take(const std::string& folder, const ResultsPlace& place) {
  const bool given = !place.given.empty();
  std::error_code error;
  if (!given && fs::exists(folder, error) && !fs::is_directory(folder, error)) return false;
  make_output_folder("-o", folder);
  const auto is_anothers = [&] {
    if (!given) return true;
    throw InputError(folder, "-o", kind_names(kind_).another,
                     "another folder, or --force to replace it");
  };
  const bool force = given && place.force;
  // What bears no mark is not marked by us either.
  const bool is_marked = fs::exists(fs::path(folder) / kind_names(kind_).mark, error);
  if (!is_marked && !force && !results_in(folder, kind_).empty() && is_anothers()) return false;
  auto mark = std::make_unique<Mark>(folder, kind_);
  if (!mark->is_ours()) {
    if (!given) return false;
    throw InputError(folder, "-o", "a folder that another process writes into", "another one");
  }
  const bool holds_a_run = !results_in(folder, kind_).empty();
  const bool same = !key_.empty() && mark->key() == key_;
  if (holds_a_run && !same && !force && is_anothers()) return false;
  check_names(folder, kind_);
  mark_ = std::move(mark);
  path_ = at_ = folder;
  if (holds_a_run && !(same && place.adds)) {
    begin_beside();
  } else {
    mark_->set_key(key_);
  }
  return true;
}

void ResultsFolder::begin_beside() {
  at_ = path_ + "/" + kind_names(kind_).unfinished;
  std::error_code error;
  // A run that was killed left it: what is in the folder already goes, what is not is kept.
  if (fs::exists(at_, error)) {
    const std::string before = Mark(at_, kind_).key();
    const bool is_there_whole = !before.empty() && before == mark_->key();
    if (is_there_whole || !fs::exists(at_ + "/recording.h5", error)) {
      fs::remove_all(at_, error);
    } else {
      fs::rename(at_, next_free_name(path_), error);
    }
  }
  if (error) refuse_folder(path_);
  make_output_folder("-o", at_);
  Mark(at_, kind_).set_key(key_);
}

void ResultsFolder::finish(bool whole) {
  if (at_ == path_) return;
  if (!whole) {
    const std::string name = next_free_name(path_);
    fs::rename(at_, name);
    path_ = at_ = name;
    return;
  }
  const std::vector<fs::path> before = results_in(path_, kind_);
  fs::remove(fs::path(at_) / kind_names(kind_).mark);
  std::vector<fs::path> now;
  const std::vector<fs::path> names = files_to_move(at_, path_);
  // Who ends in between leaves a folder that is of no run.
  const bool same = mark_->key() == key_;
  mark_->set_key("");
  for (const fs::path& name : names) {
    now.push_back(fs::path(path_) / name);
    fs::rename(fs::path(at_) / name, now.back());
  }
  // Its pictures show the same run, unless it was another.
  for (const fs::path& file : before) {
    const bool is_drawn = file.parent_path().filename() == "render";
    if (std::ranges::find(now, file) != now.end() || (same && is_drawn)) continue;
    fs::remove(file);
    // A folder within that is empty now, of an attempt or a part, was of the results, too.
    std::error_code ignored;
    for (fs::path in = file.parent_path(); in != fs::path(path_) && fs::remove(in, ignored);) {
      in = in.parent_path();
    }
  }
  fs::remove_all(at_);
  mark_->set_key(key_);
  at_ = path_;
}

}  // namespace sulcus
