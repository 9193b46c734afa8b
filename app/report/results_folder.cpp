#include "app/report/results_folder.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <regex>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "app/report/output_file.hpp"
#include "engine/core/error.hpp"

namespace sulcus {

namespace fs = std::filesystem;

namespace {

constexpr const char* kMarkName = ".sulcus-run";        // its text: the key of the run
constexpr const char* kUnfinishedName = ".unfinished";  // what is to replace the results
constexpr std::array kResultNames{"summary.json", "forces.png",        "log.txt",
                                  "recording.h5", "recording.h5.part", "scene.toml"};

[[noreturn]] void refuse_folder(const std::string& folder) {
  throw InputError(folder, "", "no folder that can be written", "one for the results, -o DIR");
}

/// The files of a run's results that lie in a folder; not what a user has put there.
std::vector<fs::path> results_in(const std::string& folder) {
  std::vector<fs::path> found;
  std::error_code ignored;
  for (const char* name : kResultNames) {
    const fs::path file = fs::path(folder) / name;
    if (fs::is_regular_file(file, ignored)) found.push_back(file);
  }
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
  return found;
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
  explicit Mark(const std::string& folder)
      : file_(::open((folder + "/" + kMarkName).c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW,
                     0666)) {
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

ResultsFolder::ResultsFolder(const ResultsPlace& place) : key_(place.key) {
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
  make_output_folder("-o", folder);
  std::error_code error;
  const auto is_anothers = [&] {
    if (!given) return true;
    throw InputError(folder, "-o", "another run", "another folder, or --force to replace it");
  };
  const bool force = given && place.force;
  // What bears no mark is not marked by us either.
  const bool is_marked = fs::exists(fs::path(folder) / kMarkName, error);
  if (!is_marked && !force && !results_in(folder).empty() && is_anothers()) return false;
  auto mark = std::make_unique<Mark>(folder);
  if (!mark->is_ours()) {
    if (!given) return false;
    throw InputError(folder, "-o", "a folder that another process writes into", "another one");
  }
  const bool holds_a_run = !results_in(folder).empty();
  const bool same = !key_.empty() && mark->key() == key_;
  if (holds_a_run && !same && !force && is_anothers()) return false;
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
  at_ = path_ + "/" + kUnfinishedName;
  std::error_code error;
  // A run that was killed left it: what is in the folder already goes, what is not is kept.
  if (fs::exists(at_, error)) {
    const std::string before = Mark(at_).key();
    const bool is_there_whole = !before.empty() && before == mark_->key();
    if (is_there_whole || !fs::exists(at_ + "/recording.h5", error)) {
      fs::remove_all(at_, error);
    } else {
      fs::rename(at_, next_free_name(path_), error);
    }
  }
  if (error) refuse_folder(path_);
  make_output_folder("-o", at_);
  Mark(at_).set_key(key_);
}

void ResultsFolder::finish(bool whole) {
  if (at_ == path_) return;
  if (!whole) {
    const std::string name = next_free_name(path_);
    fs::rename(at_, name);
    path_ = at_ = name;
    return;
  }
  const std::vector<fs::path> before = results_in(path_);
  std::vector<fs::path> now;
  fs::remove(fs::path(at_) / kMarkName);
  for (const auto& entry : fs::recursive_directory_iterator(at_)) {
    const fs::path to = fs::path(path_) / entry.path().lexically_relative(at_);
    if (entry.is_directory()) {
      fs::create_directories(to);
    } else {
      now.push_back(to);
    }
  }
  for (const fs::path& to : now) {
    fs::rename(fs::path(at_) / to.lexically_relative(path_), to);
  }
  // Its pictures show the same run, unless it was another.
  const bool same = mark_->key() == key_;
  for (const fs::path& file : before) {
    const bool is_drawn = file.parent_path().filename() == "render";
    if (std::ranges::find(now, file) == now.end() && !(same && is_drawn)) {
      fs::remove(file);
    }
  }
  fs::remove_all(at_);
  mark_->set_key(key_);
  at_ = path_;
}

}  // namespace sulcus
