#include "tools/sulcus_lab/recordings/recording_trials.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/playback/recorded_state.hpp"
#include "engine/core/error.hpp"
#include "engine/core/realtime.hpp"
#include "engine/core/stop.hpp"
#include "tools/sulcus_lab/statistics.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): not in every header

namespace sulcus::lab {

namespace {

namespace fs = std::filesystem;
using WallClock = std::chrono::system_clock;  // that of the file's times

/// A block that is cut; by its speed as long as wanted.
constexpr const char* kCutScene = R"(
[workpiece]
shape = "box"
voxel_mm = 0.05
cells = [64, 64, 64]
[workpiece.box]
size_mm = [2, 2, 2]
[burr]
diameter_mm = 0.8
speed_rpm = 100000
field = [48, 192, 48]
[trajectory]
points_mm = [[-0.6, 0, 1.0], [-0.6, 0, 0.92], [0.6, 0, 0.92]]
[cutting]
[record]
)";
constexpr double kWay_mm = 1.28;

/// A run as a process of its own.
class ProgramRun {
 public:
  ProgramRun(const TrialSetting& setting, const std::vector<std::string>& arguments) {
    std::vector<std::string> words{setting.program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> pointers;
    pointers.reserve(words.size() + 1);
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    for (const int stream : {1, 2}) {
      posix_spawn_file_actions_addopen(&files, stream, "/dev/null", O_WRONLY, 0);
    }
    const int failed =
        posix_spawn(&child_, setting.program.c_str(), &files, nullptr, pointers.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    if (failed != 0) throw std::runtime_error(setting.program + ": " + std::strerror(failed));
    kill_when_stopped(child_);
  }
  ~ProgramRun() { wait(); }
  ProgramRun(const ProgramRun&) = delete;
  ProgramRun& operator=(const ProgramRun&) = delete;

  void kill() const { ::kill(child_, SIGKILL); }
  void interrupt() const { ::kill(child_, SIGINT); }
  bool is_running() const {
    siginfo_t info{};
    waitid(P_PID, static_cast<id_t>(child_), &info, WEXITED | WNOHANG | WNOWAIT);
    return info.si_pid == 0;
  }
  double resident_MiB() const {
    std::ifstream statm("/proc/" + std::to_string(child_) + "/statm");
    double all = 0.0, resident = 0.0;
    statm >> all >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
  }
  /// Its exit status; below 0: a signal.
  int wait() {
    if (child_ <= 0) return status_;
    siginfo_t info{};
    waitid(P_PID, static_cast<id_t>(child_), &info, WEXITED | WNOWAIT);
    leave_when_stopped(child_);
    int ended = 0;
    if (waitpid(child_, &ended, 0) == child_) {
      status_ = WIFEXITED(ended) ? WEXITSTATUS(ended) : -WTERMSIG(ended);
    }
    child_ = 0;
    return status_;
  }

 private:
  pid_t child_ = 0;
  int status_ = 0;
};

/// Records a cut of so many ticks; returns the recording.
std::string record(const TrialSetting& setting, int ticks, const std::string& name) {
  const std::string folder = setting.folder + "/" + name;
  const std::string scene = setting.folder + "/" + name + ".toml";
  std::ofstream(scene) << kCutScene;
  std::ostringstream speed;
  speed << "trajectory.speed_mm_per_s=" << 1000.0 * kWay_mm / ticks;
  ProgramRun run(setting, {"run", scene, "--set", speed.str(), "-o", folder, "--force"});
  if (run.wait() != 0) throw std::runtime_error(scene + ": could not be run");
  return folder + "/recording.h5";
}

bool same_result(TickRecord a, TickRecord b) {
  for (TickRecord* row : {&a, &b}) {
    row->step_us = row->late_us = 0.0f;
    row->check = 0;
  }
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// What a whole recording holds, to hold a damaged one against.
struct Truth {
  explicit Truth(const std::string& file) : Truth(RecordingReader(file)) {}
  explicit Truth(const RecordingReader& reader)
      : rows(reader.ticks()), edits(reader.edits()), hashes(reader.state_hashes()) {}

  /// Whether all that a reader gives is a beginning of it.
  bool begins_with(const RecordingReader& reader) const {
    const std::vector<TickRecord> found = reader.ticks();
    if (found.size() > rows.size() ||
        !std::equal(found.begin(), found.end(), rows.begin(), same_result)) {
      return false;
    }
    const std::vector<Edit> voxels = reader.edits();
    if (voxels.size() > edits.size() ||
        !std::equal(voxels.begin(), voxels.end(), edits.begin(), [](const Edit& a, const Edit& b) {
          return a.tick == b.tick && a.voxel == b.voxel && a.body == b.body && a.cause == b.cause;
        })) {
      return false;
    }
    const auto& some = reader.state_hashes();
    return some.size() <= hashes.size() &&
           std::equal(some.begin(), some.end(), hashes.begin(),
                      [](const StateHash& a, const StateHash& b) {
                        return a.tick == b.tick && a.volume == b.volume && a.state == b.state;
                      });
  }

  std::vector<TickRecord> rows;
  std::vector<Edit> edits;
  std::vector<StateHash> hashes;
};

/// Of damaged files.
struct Damaged {
  int whole = 0, shorter = 0, refused = 0, wrong = 0;

  void read(const std::string& file, const Truth& truth) {
    try {
      const RecordingReader reader(file);
      wrong += !truth.begins_with(reader);
      (void)reader.workpiece();
      for (const KeyframeInfo& info : reader.keyframes()) (void)reader.keyframe(info);
      ++(reader.tick_count() == truth.rows.size() ? whole : shorter);
    } catch (const InputError& error) {
      refused += std::string(error.what()).find('\n') == std::string::npos;
      wrong += std::string(error.what()).find('\n') != std::string::npos;
    }
  }
  std::vector<TrialRow> rows(const std::string& trial) const {
    return {{trial, "files", whole + shorter + refused},
            {trial, "read in whole", whole},
            {trial, "shorter", shorter},
            {trial, "refused with a line", refused},
            {trial, "wrong", wrong, 0.0}};
  }
};

std::vector<char> bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void write_bytes(const std::string& file, const std::vector<char>& bytes) {
  std::ofstream(file, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// From the last time a file was written.
double milliseconds_since_written(const std::string& file, WallClock::time_point now) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) throw std::runtime_error(file + ": is not there");
  const auto written = WallClock::time_point(std::chrono::duration_cast<WallClock::duration>(
      std::chrono::seconds(status.st_mtim.tv_sec) +
      std::chrono::nanoseconds(status.st_mtim.tv_nsec)));
  return std::chrono::duration<double, std::milli>(now - written).count();
}

/// Of a run at real pace: how much of its time up to now is in no row. It has begun when its file
/// was there, or a little later; periods that it missed are not its recorder's.
double milliseconds_without_rows(const RecordingReader& reader, double lasted_ms) {
  const double period_ms = 1e3 / reader.header().rate_hz;
  double recorded_ms = 0.0;
  for (const TickRecord& row : reader.ticks()) {
    recorded_ms +=
        period_ms * (1.0 + std::floor(1e-3 * static_cast<double>(row.late_us) / period_ms));
  }
  return lasted_ms - recorded_ms;
}

/// Starts a run and kills it some time after its recording has appeared.
struct Killed {
  bool ended = false;  // before that
  double lasted_ms = 0.0, since_written_ms = 0.0;
};
Killed run_and_kill(const TrialSetting& setting, const std::string& scene, int ticks, bool real,
                    const std::string& folder, std::chrono::microseconds after) {
  const std::string file = folder + "/recording.h5";
  fs::remove_all(folder);
  std::ostringstream speed;
  speed << "trajectory.speed_mm_per_s=" << 1000.0 * kWay_mm / ticks;
  ProgramRun run(setting, {"run", scene, "--pace", real ? "real" : "fast", "--set", speed.str(),
                           "-o", folder});
  while (!fs::exists(file) && run.is_running()) {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  const std::uint64_t begin = steady_ns();
  std::this_thread::sleep_for(after);
  run.kill();
  const WallClock::time_point now = WallClock::now();
  Killed killed;
  killed.lasted_ms = 1e-6 * static_cast<double>(steady_ns() - begin);
  killed.ended = run.wait() != -SIGKILL;
  if (!killed.ended) killed.since_written_ms = milliseconds_since_written(file, now);
  return killed;
}

}  // namespace

std::vector<TrialRow> trial_of_kills(const TrialSetting& setting) {
  constexpr int kTicks = 6000;
  constexpr double kMostMissing_ms = 100.0;
  const std::string whole = record(setting, kTicks, "undisturbed");
  const Truth truth(whole);
  const std::string scene = setting.folder + "/undisturbed.toml";
  std::mt19937 random(1);
  int killed = 0, ended = 0, not_opened = 0, wrong = 0, not_repaired = 0, with_rows = 0;
  std::vector<float> since_written_ms, missing_ms;  // the latter at real pace
  for (int trial = 0; trial < setting.kills; ++trial) {
    const bool real = trial % 2 == 0;
    const std::string folder = setting.folder + "/killed";
    const std::string file = folder + "/recording.h5";
    const Killed kill =
        run_and_kill(setting, scene, kTicks, real, folder,
                     std::chrono::microseconds(random() % (real ? 1'200'000u : 250'000u)));
    if (kill.ended) {
      ++ended;
      continue;
    }
    ++killed;
    since_written_ms.push_back(static_cast<float>(kill.since_written_ms));
    const std::string repaired = setting.folder + "/repaired.h5";
    fs::remove(repaired);
    try {
      const RecordingReader reader(file);
      wrong += !truth.begins_with(reader);
      with_rows += reader.tick_count() > 0;
      if (real) {
        missing_ms.push_back(
            static_cast<float>(std::max(0.0, milliseconds_without_rows(reader, kill.lasted_ms))));
      }
      ProgramRun repair(setting, {"repair", file, "-o", repaired});
      const bool done = repair.wait() == 0 && opens_without_swmr(repaired) &&
                        RecordingReader(repaired).missing().empty() &&
                        RecordingReader(repaired).tick_count() == reader.tick_count();
      not_repaired += !done;
    } catch (const InputError&) {
      ++not_opened;
    }
  }
  const auto late = std::ranges::count_if(
      missing_ms, [](float ms) { return static_cast<double>(ms) > kMostMissing_ms; });
  return {{"kills", "killed", killed},
          {"kills", "ended before", ended},
          {"kills", "with rows", with_rows},
          {"kills", "not opened", not_opened, 0.0},
          {"kills", "other than undisturbed", wrong, 0.0},
          {"kills", "not repaired", not_repaired, 0.0},
          {"kills", "since_written_ms median", quantile(since_written_ms, 0.5)},
          {"kills", "since_written_ms largest", quantile(since_written_ms, 1.0)},
          {"kills", "missing over 100 ms", late},
          {"kills", "missing_ms median", quantile(missing_ms, 0.5)},
          {"kills", "missing_ms largest", quantile(missing_ms, 1.0), kMostMissing_ms}};
}

namespace {

/// A recording of some 150 ticks, closed, and one whose writer was killed, with what they hold.
struct Sample {
  std::string name, file;
  Truth truth;
};
std::vector<Sample> samples(const TrialSetting& setting, const std::string& name) {
  constexpr int kTicks = 150;
  std::vector<Sample> both;
  const std::string whole = record(setting, kTicks, name);
  both.push_back({name + " of a closed one", whole, Truth(whole)});
  const std::string folder = setting.folder + "/" + name + "_killed";
  for (int attempt = 0; attempt < 50; ++attempt) {
    const Killed kill = run_and_kill(setting, setting.folder + "/" + name + ".toml", 20 * kTicks,
                                     true, folder, std::chrono::milliseconds(150));
    const std::string file = folder + "/recording.h5";
    if (kill.ended || RecordingReader(file).tick_count() == 0) continue;
    both.push_back({name + " of a killed one", file, Truth(file)});
    return both;
  }
  throw std::runtime_error(folder + ": no run could be killed while it recorded");
}

/// Damages each sample that many times, from its bytes into a file, as long as `damage` can, and
/// reads what there is then.
template <class Damage>
std::vector<TrialRow> trial_of_damage(const TrialSetting& setting, const std::string& name,
                                      int times, const Damage& damage) {
  std::vector<TrialRow> rows;
  for (const Sample& sample : samples(setting, name)) {
    std::vector<char> bytes = bytes_of(sample.file);
    const std::string file = setting.folder + "/" + name + ".h5";
    Damaged damaged;
    for (int time = 0; time < times && damage(file, bytes, time); ++time) {
      damaged.read(file, sample.truth);
    }
    for (TrialRow& row : damaged.rows(sample.name)) rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::vector<TrialRow> trial_of_cuts(const TrialSetting& setting) {
  const auto cut = [](const std::string& file, const std::vector<char>& bytes, int time) {
    if (time == 0) write_bytes(file, bytes);
    const auto cut_bytes = static_cast<std::size_t>(time) + 1;
    if (cut_bytes <= bytes.size()) fs::resize_file(file, bytes.size() - cut_bytes);
    return cut_bytes <= bytes.size();
  };
  return trial_of_damage(setting, "cuts", setting.cut_bytes, cut);
}

std::vector<TrialRow> trial_of_flips(const TrialSetting& setting) {
  std::mt19937 random;
  const auto flip = [&](const std::string& file, std::vector<char>& bytes, int time) {
    if (time == 0) random.seed(2);
    const std::size_t at = random() % bytes.size();
    const char bit = static_cast<char>(1 << random() % 8);
    bytes[at] ^= bit;
    write_bytes(file, bytes);
    bytes[at] ^= bit;
    return true;
  };
  return trial_of_damage(setting, "flips", setting.flips, flip);
}

std::vector<TrialRow> trial_of_going_back(const TrialSetting& setting) {
  RecordedRun run = open_recorded_run(record(setting, setting.ticks, "back"));
  RecordedState state(run);
  const auto hashes = [&] {
    return std::pair(state.simulation().workpiece().hash(), state.simulation().state().hash());
  };
  std::vector<std::pair<std::uint64_t, std::uint64_t>> on;
  while (state.next_row() < run.rows.size()) {
    state.step();
    on.push_back(hashes());
  }
  int other_than_recorded = 0, other_than_on = 0;
  for (const StateHash& hash : run.reader.state_hashes()) {
    other_than_recorded += on[hash.tick] != std::pair(hash.volume, hash.state);
  }
  for (std::size_t row = on.size(); row-- > 0;) {
    state.seek_row(row);
    other_than_on += hashes() != on[row];
  }
  return {{"back", "ticks", on.size()},
          {"back", "removed voxels", run.reader.edit_count()},
          {"back", "hashes recorded", run.reader.state_hashes().size()},
          {"back", "other than recorded", other_than_recorded, 0.0},
          {"back", "other than on the way on", other_than_on, 0.0}};
}

std::vector<TrialRow> trial_of_reach(const TrialSetting& setting, const std::string& scene) {
  constexpr double kMost_ms = 200.0;
  const std::string folder = setting.folder + "/reach";
  ProgramRun recorded(setting, {"run", scene, "--no-render", "-o", folder, "--force"});
  if (recorded.wait() != 0) throw std::runtime_error(scene + ": could not be run");
  const std::string file = folder + "/recording.h5";
  const std::uint64_t begin = steady_ns();
  RecordedRun run = open_recorded_run(file);
  RecordedState state(run);
  const double open_ms = 1e-6 * static_cast<double>(steady_ns() - begin);
  std::mt19937 random(3);
  std::vector<float> reach_ms;
  for (int trial = 0; trial < 200; ++trial) {
    const std::uint64_t before = steady_ns();
    state.seek_row(random() % run.rows.size());
    reach_ms.push_back(1e-6f * static_cast<float>(steady_ns() - before));
  }
  return {{"reach", "ticks", run.rows.size()},
          {"reach", "file_MB", 1e-6 * static_cast<double>(fs::file_size(file))},
          {"reach", "open_ms", open_ms},
          {"reach", "seek_ms median", quantile(reach_ms, 0.5)},
          {"reach", "seek_ms p99", quantile(reach_ms, 0.99)},
          {"reach", "seek_ms largest", quantile(reach_ms, 1.0), kMost_ms}};
}

namespace {

/// Poses over the middle of a crown, 8 mm up and then 10 um deeper each time: 130 million ticks at
/// 1 kHz.
void write_soak_poses(const std::string& file) {
  std::ofstream out(file);
  out.precision(12);
  out << "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
  double time_s = 0.0;
  const double half = std::sqrt(0.5);
  constexpr double kSpeed_mm_per_s = 0.42;
  const auto add = [&](double x, double y, double z, double way_mm) {
    time_s += way_mm / kSpeed_mm_per_s;
    out << time_s << ',' << x << ',' << y << ',' << z << ',' << half << ',' << half << ",0,0\n";
  };
  add(-4.0, -2.0, 12.0, 0.0);
  for (int pass = 0; pass < 300; ++pass) {
    const double z = 8.6 - 0.01 * pass;
    for (int row = 0; row <= 20; ++row) {
      const double y = -2.0 + 0.2 * row, side = row % 2 == 0 ? 1.0 : -1.0;
      add(-4.0 * side, y, z, 0.2);
      add(4.0 * side, y, z, 8.0);
    }
    add(4.0, 2.0, 12.0, 4.0);
    add(-4.0, -2.0, 12.0, 9.0);
  }
}

}  // namespace

std::vector<TrialRow> trial_of_soak(const TrialSetting& setting, const std::string& scene,
                                    double minutes) {
  constexpr double kMostGrowth = 1.02;
  const std::string folder = setting.folder + "/soak", poses = setting.folder + "/soak.csv";
  write_soak_poses(poses);
  ProgramRun run(setting, {"run", scene, "--no-render", "--set", "trajectory.file=" + poses,
                           "--set", "burr.diameter_mm=3", "-o", folder, "--force"});
  const std::uint64_t begin = steady_ns();
  const auto minutes_now = [&] { return 1e-9 / 60.0 * static_cast<double>(steady_ns() - begin); };
  double first_MiB = 0.0, half_MiB = 0.0, most_MiB = 0.0;
  while (minutes_now() < minutes && run.is_running()) {
    std::this_thread::sleep_for(std::chrono::seconds(1));
    const double now_MiB = run.resident_MiB();
    if (minutes_now() < std::min(1.0, 0.2 * minutes)) first_MiB = std::max(first_MiB, now_MiB);
    if (minutes_now() < 0.5 * minutes) half_MiB = std::max(half_MiB, now_MiB);
    most_MiB = std::max(most_MiB, now_MiB);
  }
  const double lasted = minutes_now();
  run.interrupt();
  const int status = run.wait();
  const RecordingReader reader(folder + "/recording.h5");
  std::uint64_t faults = 0;
  constexpr std::size_t kRows = 65536;
  for (std::size_t first = 0; first < reader.tick_count(); first += kRows) {
    for (const TickRecord& row : reader.ticks(first, kRows)) faults |= row.faults;
  }
  return {{"soak", "minutes", lasted},
          {"soak", "ticks", reader.tick_count()},
          {"soak", "removed voxels", reader.edit_count()},
          {"soak", "exit status beside that of SIGINT", status - 128 - SIGINT, 0.0},
          {"soak", "fault bits", faults, 0.0},
          {"soak", "resident_MiB after a minute", first_MiB},
          {"soak", "resident_MiB after half of it", half_MiB},
          {"soak", "resident_MiB largest", most_MiB, kMostGrowth * first_MiB}};
}

}  // namespace sulcus::lab
