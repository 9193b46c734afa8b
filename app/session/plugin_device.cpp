#include "app/session/plugin_device.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "app/session/plugin_library.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/error.hpp"
#include "engine/core/realtime.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

namespace {

using Message = std::array<char, 512>;

/// What a plug-in wrote, as one line that ends within its room.
std::string line_of(const char* text, std::size_t room) {
  std::string line(text, std::find(text, text + room, '\0'));
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  }
  return line;
}

SulcusPose written(const Pose& pose) noexcept {
  const Eigen::Quaterniond& q = pose.orientation;
  return {{pose.position.x(), pose.position.y(), pose.position.z()}, {q.w(), q.x(), q.y(), q.z()}};
}

/// Whether it can be a pose: all finite, not out of the world, and turned by a rotation.
bool is_pose(const SulcusPose& pose) noexcept {
  double squared = 0.0;
  for (const double part : pose.orientation) squared += part * part;
  const bool near = std::ranges::all_of(
      pose.position_m, [](double x) { return std::abs(x) <= PluginDevice::kFarthest_m; });
  return near && squared > 0.98 && squared < 1.02;  // as floats have it, or better
}

std::string text_of(const SulcusPose& pose) {
  const double *p = pose.position_m, *q = pose.orientation;
  return formatted("position (%.4g %.4g %.4g) m, w x y z (%.4g %.4g %.4g %.4g)", p[0], p[1], p[2],
                   q[0], q[1], q[2], q[3]);
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void check_limits(const SulcusDeviceLimits& limits, const std::string& title) {
  const auto check = [&](const char* name, double value, double least, double most) {
    if (value >= least && value <= most) return;
    throw InputError(title, "its limits", formatted("%s = %g", name, value),
                     formatted("%g to %g", least, most));
  };
  check("force_N", limits.force_N, 1e-3, 1e3);
  check("torque_Nm", limits.torque_Nm, 0.0, 100.0);
  check("stiffness_N_per_m", limits.stiffness_N_per_m, 1.0, 1e6);
  check("resolution_m", limits.resolution_m, 0.0, 1e-2);
}

}  // namespace

void PluginDevice::at_trajectory(const SulcusDeviceHost* host, double time_s,
                                 SulcusPose* pose) noexcept {
  const Trajectory& path = *static_cast<const Host*>(host)->path;
  *pose = written(path.pose_at(time_s > 0.0 ? time_s : 0.0));  // not a number: the start
}

PluginDevice::PluginDevice(const Scene& scene, const Trajectory& trajectory,
                           const std::vector<std::string>& folders, bool at_real_pace)
    : asked_(scene.device.value().plugin.value()),
      at_real_pace_(at_real_pace),
      plugin_(load_plugin(asked_.name, folders, scene.file)),
      host_(std::make_unique<Host>()),
      placed_(asked_.placement, trajectory.pose_at(0.0).position),
      has_controls_(plugin_.version >= 2 && plugin_.controls != nullptr),
      spare_burrs_(scene.burrs.empty() ? 0 : scene.burrs.size() - 1) {
  title_ = "device plug-in '" + asked_.name + "'";
  if ((plugin_.flags & SULCUS_DEVICE_REAL_TIME) != 0 && !at_real_pace) {
    throw InputError(scene.file, "--pace fast", title_ + ", which lives in real time",
                     "--pace real");
  }
  steps_.dt_s = 1.0 / scene.haptics.rate_hz;
  host_->struct_size = sizeof(SulcusDeviceHost);
  host_->rate_hz = scene.haptics.rate_hz;
  host_->reference_m = scene.burr.reference_m;
  host_->start = written(trajectory.pose_at(0.0));
  host_->settings = asked_.settings.c_str();
  host_->trajectory = at_trajectory;
  host_->path = &trajectory;
  limits_ = {sizeof(SulcusDeviceLimits), 0, kNan, kNan, kNan, kNan};
  Message why{};
  const int code = plugin_.open(host_.get(), &limits_, &device_, why.data(), why.size());
  if (code != SULCUS_DEVICE_OK) {
    const std::string said = line_of(why.data(), why.size());
    throw InputError(title_, "open",
                     said.empty() ? "error " + std::to_string(code) + ", and no word on it" : said,
                     "a device that can be opened");
  }
  open_ = true;
  try {
    check_limits(limits_, title_);
  } catch (...) {
    close();
    throw;
  }
}

PluginDevice::~PluginDevice() { close(); }

std::string PluginDevice::own_name() const {
  constexpr std::size_t kLongest = 200;
  return plugin_.name ? line_of(plugin_.name, strnlen(plugin_.name, kLongest)) : "no name";
}

void PluginDevice::close() noexcept {
  if (std::exchange(open_, false)) watched("close", [&] { plugin_.close(device_); });
}

std::vector<std::string> PluginDevice::limits_as_overrides() const {
  const auto set = [](const char* key, double value) {
    return formatted("device.%s=%.17g", key, value);
  };
  const auto least = [](double own, const std::optional<double>& asked) {
    return asked ? std::min(own, *asked) : own;
  };
  const double scale = asked_.placement.scale;  // felt so many times as stiff
  return {
      set("force_limit_N", least(limits_.force_N, asked_.force_limit_N)),
      set("torque_limit_mNm", 1e3 * least(limits_.torque_Nm, asked_.torque_limit_Nm)),
      set("stiffness_N_per_mm", least(limits_.stiffness_N_per_m / scale, asked_.stiffness_N_per_m) /
                                    kNewtonPerMillimetre),
      set("resolution_mm",
          std::max(scale * limits_.resolution_m, asked_.resolution_m.value_or(0.0)) / kMillimetre)};
}

void PluginDevice::begin(std::function<bool(const Pose&)> is_free) {
  is_free_ = std::move(is_free);
  watcher_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

/// Counts its own wakes, not the time: a program that was stopped as a whole hangs nowhere.
void PluginDevice::watch(const std::stop_token& stop) const {
  constexpr int kWakes_per_s = 10;
  std::mutex mutex;
  std::condition_variable_any woken;
  std::unique_lock lock(mutex);
  std::uint64_t seen = 0;
  for (int wakes = 0; wakes < kHanging_s * kWakes_per_s;) {
    woken.wait_for(lock, stop, std::chrono::milliseconds(1000 / kWakes_per_s),
                   [] { return false; });
    if (stop.stop_requested()) return;
    const std::uint64_t calls = calls_;
    wakes = call_.load() && calls == seen ? wakes + 1 : 0;
    seen = calls;
  }
  const char* const call = call_;
  say_error(
      "sulcus: %s has not returned from %s for %d s; the program ends, with what was "
      "recorded up to then on disk\n",
      title_.c_str(), call ? call : "a call", kHanging_s);
  // Its thread cannot be ended, and what it holds cannot be closed.
  std::_Exit(1);
}

/// A call that ends the program where it does not return, once begin() has been called.
template <class Call>
void PluginDevice::watched(const char* name, const Call& call) noexcept {
  calls_.fetch_add(1, std::memory_order_relaxed);
  call_.store(name, std::memory_order_relaxed);
  call();
  call_.store(nullptr, std::memory_order_relaxed);
}

/// A call within a tick. Sets took_ns_.
template <class Call>
int PluginDevice::timed(const char* name, const Call& call) noexcept {
  int code = SULCUS_DEVICE_OK;
  watched(name, [&] {
    const std::uint64_t begin_ns = steady_ns();
    code = call();
    took_ns_ = steady_ns() - begin_ns;
  });
  longest_ns_ = std::max(longest_ns_, took_ns_);
  return code;
}

void PluginDevice::fail(End end, int code) noexcept {
  end_ = end;
  end_tick_ = tick_;
  end_code_ = code;
}

void PluginDevice::go_on(std::function<bool(const Pose&)> is_free) {
  is_free_ = std::move(is_free);
  is_held_ = false;
  fade_.reset();
  written_ = {};
}

/// Pedal and burr, as far as they can be; returns whether the clutch is held.
bool PluginDevice::read_controls(std::uint64_t tick) noexcept {
  if (!has_controls_) return false;
  SulcusControls asked{sizeof(SulcusControls), SULCUS_BURR_AS_IT_IS, 1.0, 0, 0};
  timed("controls", [&] {
    plugin_.controls(device_, tick, &asked);
    return SULCUS_DEVICE_OK;
  });
  pedal_ = asked.pedal > 0.0 ? std::min(asked.pedal, 1.0) : 0.0;  // not a number: it stands
  burr_ = asked.burr;
  if (burr_ != SULCUS_BURR_AS_IT_IS && burr_ > spare_burrs_ && no_such_burr_ == 0) {
    no_such_burr_ = burr_;
  }
  return asked.clutch != 0;
}

std::optional<Pose> PluginDevice::pose(std::uint64_t tick) noexcept {
  tick_ = tick;
  if (is_gone()) return {};
  SulcusPose read{{kNan, kNan, kNan}, {kNan, kNan, kNan, kNan}};  // if it writes none
  const int code = timed("read", [&] { return plugin_.read(device_, tick, &read); });
  if (code == SULCUS_DEVICE_NO_POSE) {
    ++silent_ticks_;
    return {};
  }
  if (code != SULCUS_DEVICE_OK) {
    fail(code == SULCUS_DEVICE_OVER && plugin_.version >= 2 ? End::kOver : End::kGone, code);
    return {};
  }
  if (at_real_pace_ && took_ns_ > kSlowest_ns) {
    ++slow_ticks_;
    return {};
  }
  Pose pose = pose_of(read.position_m, read.orientation);
  if (!is_pose(read)) {
    fail(End::kNoPose, code);
    end_pose_ = read;
    pose.position.setConstant(kNan);
    return pose;
  }
  pose.orientation.normalize();
  if (recentre_.exchange(false)) placed_.recentre();
  const bool clutch = read_controls(tick) || clutch_;
  pose = placed_.to_scene(pose, clutch);
  if (!is_held_) is_held_ = is_free_(pose);
  if (!is_held_) {
    ++inside_ticks_;
    return {};
  }
  // The hand has let go of the tool: as without a pose the tool stands, cuts nothing and pushes no
  // more.
  if (clutch) return {};
  return pose;
}

void PluginDevice::apply(const Wrench& wrench) noexcept {
  constexpr double kRounding = 1.0 + 1e-6;
  const double force_step_N = (wrench.force_N - written_.force_N).norm();
  const double torque_step_Nm = (wrench.torque_Nm - written_.torque_Nm).norm();
  const bool cut_off = force_step_N > kRounding * steps_.force_step_N ||
                       torque_step_Nm > kRounding * steps_.torque_step_Nm;
  if (cut_off && !fade_) fade_.emplace(written_, steps_);
  write(fade_ ? fade_->next() : wrench, Write::kTick);
}

bool PluginDevice::fade() noexcept {
  if (!fade_) fade_.emplace(written_, steps_);
  ++tick_;
  const Wrench next = fade_->next();
  if (end_ == End::kGone || fade_->is_over()) return false;
  write(next, Write::kTick);
  return true;
}

void PluginDevice::release() noexcept { write({}, Write::kLast); }

void PluginDevice::write(const Wrench& wrench, Write which) noexcept {
  if (end_ == End::kGone) return;
  const Wrench own = placed_.to_device(wrench);
  const Eigen::Vector3d &f = own.force_N, &t = own.torque_Nm;
  const SulcusWrench sent{{f.x(), f.y(), f.z()}, {t.x(), t.y(), t.z()}};
  written_ = wrench;
  const int code =
      timed("write", [&] { return plugin_.write(device_, tick_, &sent, which == Write::kLast); });
  const bool answered = end_ == End::kNone || end_ == End::kNoPose;
  if (code != SULCUS_DEVICE_OK && answered) fail(End::kGone, code);
}

std::vector<std::string> PluginDevice::end() {
  Message said{};
  watched("message", [&] { plugin_.message(device_, said.data(), said.size()); });
  const std::string word = line_of(said.data(), said.size());
  close();
  watcher_ = {};
  const auto in_ticks = [](std::uint64_t ticks) {
    return " in " + std::to_string(ticks) + " ticks";
  };
  if (end_ == End::kGone || end_ == End::kNoPose) {
    std::string line = title_;
    line += end_ == End::kGone ? " is gone" : " gave what is no pose";
    line += " at tick " + std::to_string(end_tick_);
    line += end_ == End::kGone ? " (code " + std::to_string(end_code_) + ")"
                               : ": " + text_of(end_pose_);
    if (!word.empty()) line += ": " + word;
    throw std::runtime_error(line + "; the force was taken off, and the run ended");
  }
  std::vector<std::string> lines;
  if (silent_ticks_ > 0) lines.push_back(title_ + " gave no pose" + in_ticks(silent_ticks_));
  if (slow_ticks_ > 0) {
    lines.push_back(title_ + " took longer than 20 ms to read" + in_ticks(slow_ticks_) +
                    ", which counts as no pose");
  }
  if (inside_ticks_ > 0) {
    lines.push_back(title_ + " began with the burr's head inside a tooth" +
                    in_ticks(inside_ticks_) + ", which counts as no pose");
  }
  if (no_such_burr_ > 0) {
    lines.push_back(title_ + " asked for burr " + std::to_string(no_such_burr_) +
                    ", where the scene has " + std::to_string(spare_burrs_) + " [[spare_burr]]");
  }
  if (!word.empty()) lines.push_back(title_ + ": " + word);
  return lines;
}

}  // namespace sulcus
