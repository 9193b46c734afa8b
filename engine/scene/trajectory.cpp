#include "engine/scene/trajectory.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

namespace {

constexpr std::size_t kMaxLineBytes = 4096;
// Differences of what lies within these are good numbers. A clock may count since 1970.
constexpr double kFarthest_mm = 1e6, kLatest_s = 1e11, kLongest_s = 1e6;
constexpr const char* kCsvHeader = "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz";

TimedPose parse_row(const std::string& file, std::size_t line_number, const std::string& line) {
  const std::string place = "line " + std::to_string(line_number);
  std::array<double, 8> value{};
  const char* at = line.data();
  const char* end = line.data() + line.size();
  for (std::size_t field = 0; field < value.size(); ++field) {
    const auto [next, error] = std::from_chars(at, end, value[field]);
    const bool last = field + 1 == value.size();
    if (error != std::errc{} || !std::isfinite(value[field]) ||
        (last ? next != end : next == end) || (!last && *next != ',')) {
      throw InputError(file, place, "'" + line.substr(0, 80) + "'",
                       std::string("8 finite numbers ") + kCsvHeader);
    }
    at = next + 1;
  }
  const auto refuse_beyond = [&](std::size_t field, const char* name, double most) {
    if (std::abs(value[field]) <= most) return;
    std::ostringstream found, expected;
    found << name << " = " << value[field];
    expected << -most << " to " << most;
    throw InputError(file, place, found.str(), expected.str());
  };
  refuse_beyond(0, "t_s", kLatest_s);
  refuse_beyond(1, "x_mm", kFarthest_mm);
  refuse_beyond(2, "y_mm", kFarthest_mm);
  refuse_beyond(3, "z_mm", kFarthest_mm);
  TimedPose pose;
  pose.time_s = value[0];
  pose.world_from_tool.position = Eigen::Vector3d(value[1], value[2], value[3]) * kMillimetre;
  Eigen::Quaterniond q(value[4], value[5], value[6], value[7]);
  if (std::abs(q.squaredNorm() - 1.0) > 0.02) {
    throw InputError(file, place, "a quaternion of length " + std::to_string(q.norm()),
                     "a unit quaternion qw,qx,qy,qz (1 % off at most)");
  }
  pose.world_from_tool.orientation = q.normalized();
  return pose;
}

/// Goes through the lines of a file, without their ends.
class Lines {
 public:
  explicit Lines(const std::string& file) : file_(file), in_(file) {
    std::error_code error;
    if (!in_ || std::filesystem::is_directory(file, error)) {
      throw InputError(file, "", "no readable file", "a table of poses");
    }
  }

  /// False behind the last one.
  bool next() {
    in_.getline(line_.data(), static_cast<std::streamsize>(line_.size()));
    ++number_;
    const bool whole = in_.good() || in_.eof();
    if (in_.eof() && in_.gcount() == 0) return false;
    if (!whole) {
      throw InputError(file_, place(),
                       "a line of more than " + std::to_string(kMaxLineBytes) + " bytes",
                       kCsvHeader);
    }
    text_ = std::string(line_.data(), static_cast<std::size_t>(in_.gcount()) - (in_.eof() ? 0 : 1));
    if (text_.ends_with('\r')) text_.pop_back();
    return true;
  }
  const std::string& text() const { return text_; }
  std::size_t number() const { return number_; }
  std::string place() const { return "line " + std::to_string(number_); }

 private:
  const std::string& file_;
  std::ifstream in_;
  std::array<char, kMaxLineBytes + 1> line_{};
  std::string text_;
  std::size_t number_ = 0;
};

std::vector<TimedPose> read_csv(const std::string& file, const InputLimits& limits) {
  Lines lines(file);
  if (!lines.next() || lines.text() != kCsvHeader) {
    throw InputError(file, "line 1", "'" + lines.text().substr(0, 80) + "'", kCsvHeader);
  }
  std::vector<TimedPose> poses;
  while (lines.next()) {
    if (lines.text().empty()) continue;
    TimedPose pose = parse_row(file, lines.number(), lines.text());
    if (!poses.empty() && pose.time_s <= poses.back().time_s) {
      throw InputError(file, lines.place(), "t_s = " + std::to_string(pose.time_s),
                       "times that rise");
    }
    if (!poses.empty() && pose.time_s - poses.front().time_s > kLongest_s) {
      throw InputError(
          file, lines.place(),
          "a pose " + std::to_string(pose.time_s - poses.front().time_s) + " s after the first",
          "at most 1000000 s");
    }
    if (poses.size() == limits.poses()) {
      throw InputError(file, lines.place(), "more rows",
                       "at most " + std::to_string(limits.poses()) + " (--limit-gib)");
    }
    poses.push_back(pose);
  }
  if (poses.empty()) throw InputError(file, "", "no poses", "at least one row");
  const double start_s = poses.front().time_s;  // a recording's clock need not start at 0
  for (TimedPose& pose : poses) pose.time_s -= start_s;
  return poses;
}

}  // namespace

std::vector<TimedPose> hold(std::vector<TimedPose> poses, double hold_s) {
  if (hold_s > 0.0) {
    poses.push_back(poses.back());
    poses.back().time_s += hold_s;
  }
  return poses;
}

Trajectory::Trajectory(std::vector<TimedPose> poses) : poses_(std::move(poses)) {}

Pose Trajectory::pose_at(double time_s) const noexcept {
  const auto after = std::upper_bound(poses_.begin(), poses_.end(), time_s,
                                      [](double t, const TimedPose& p) { return t < p.time_s; });
  if (after == poses_.begin()) return poses_.front().world_from_tool;
  if (after == poses_.end()) return poses_.back().world_from_tool;
  const TimedPose& a = *(after - 1);
  const TimedPose& b = *after;
  const double part = (time_s - a.time_s) / (b.time_s - a.time_s);
  const Pose &from = a.world_from_tool, &to = b.world_from_tool;
  Pose pose;
  pose.position = from.position + part * (to.position - from.position);
  Eigen::Quaterniond q_to = to.orientation;
  if (from.orientation.dot(q_to) < 0.0) q_to.coeffs() = -q_to.coeffs();  // the short way round
  pose.orientation.coeffs() =
      from.orientation.coeffs() + part * (q_to.coeffs() - from.orientation.coeffs());
  pose.orientation.normalize();
  return pose;
}

Eigen::Quaterniond orientation_along(const Eigen::Vector3d& axis_world) {
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitY(), axis_world);
}

Trajectory make_trajectory(const TrajectorySettings& settings, const InputLimits& limits) {
  if (!settings.file.empty()) {
    return Trajectory(hold(read_csv(settings.file, limits), settings.hold_s));
  }
  const Eigen::Quaterniond orientation = orientation_along(settings.axis);
  std::vector<TimedPose> poses;
  for (const Eigen::Vector3d& point : settings.points_m) {
    TimedPose pose{0.0, {point, orientation}};
    if (!poses.empty()) {
      const TimedPose& last = poses.back();
      const double length = (point - last.world_from_tool.position).norm();
      if (length == 0.0) continue;  // a point said twice takes no time
      pose.time_s = last.time_s + length / settings.speed_m_per_s;
    }
    poses.push_back(pose);
  }
  return Trajectory(hold(std::move(poses), settings.hold_s));
}

Trajectory scene_path(const Scene& scene, const InputLimits& limits) {
  TrajectorySettings settings = scene.trajectory;
  if (!settings.file.empty()) settings.hold_s += 1.0 / scene.haptics.rate_hz;
  return make_trajectory(settings, limits);
}

std::uint64_t ticks_in(double duration_s, double rate_hz) {
  constexpr double kRounding = 1e-6;  // of a tick
  return static_cast<std::uint64_t>(std::max(1.0, std::ceil(duration_s * rate_hz - kRounding)));
}

}  // namespace sulcus
