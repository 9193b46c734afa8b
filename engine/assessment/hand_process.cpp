#include "engine/assessment/hand_process.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "engine/core/units.hpp"

namespace sulcus {

namespace {

constexpr double kSameStroke_s = 0.05, kShortest_s = 0.05;
constexpr double kPause_s = 1.0;
constexpr double kSlice_s = 0.1;        // of removal
constexpr double kSmoothOver_s = 0.01;  // beyond the hand's band; steadies the third derivative

struct Stroke {
  std::size_t first = 0, last = 0;  // in contact, both of them
};

double seconds(std::uint64_t from, std::uint64_t to, double rate_hz) {
  return static_cast<double>(to - from) / rate_hz;
}

std::vector<Stroke> strokes_of(std::span<const HandTick> ticks, double rate_hz) {
  std::vector<Stroke> strokes;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if (!ticks[i].in_contact) continue;
    if (!strokes.empty() &&
        seconds(ticks[strokes.back().last].tick, ticks[i].tick, rate_hz) <= kSameStroke_s) {
      strokes.back().last = i;
    } else {
      strokes.push_back({i, i});
    }
  }
  std::erase_if(strokes, [&](const Stroke& stroke) {
    return seconds(ticks[stroke.first].tick, ticks[stroke.last].tick + 1, rate_hz) < kShortest_s;
  });
  return strokes;
}

double path_m(std::span<const HandTick> ticks) {
  double sum = 0.0;
  for (std::size_t i = 1; i < ticks.size(); ++i)
    sum += (ticks[i].tip_m - ticks[i - 1].tip_m).norm();
  return sum;
}

/// The value that a part of them does not exceed.
double quantile(std::vector<double>& values, double part) {
  const auto at = values.begin() + std::lround(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// -ln(D^3 / v_peak^2 * integral of |jerk|^2), by differences of means over kSmoothOver_s. None of
/// a stroke that is too short for it, that stays where it is, or that is straight and even: of that
/// the third differences are how the places were rounded.
std::optional<double> log_jerk(std::span<const HandTick> stroke, double rate_hz) {
  const auto per = std::max<std::size_t>(1, static_cast<std::size_t>(kSmoothOver_s * rate_hz));
  const std::size_t count = stroke.size() / per;
  if (count < 8) return {};
  const double h = static_cast<double>(per) / rate_hz;
  std::vector<Eigen::Vector3d> places(count, Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < per; ++j) places[i] += stroke[i * per + j].tip_m;
    places[i] /= static_cast<double>(per);
  }
  double fastest = 0.0, jerk_squared = 0.0, furthest_m = 0.0, greatest_third_m = 0.0;
  for (std::size_t i = 1; i < count; ++i) {
    fastest = std::max(fastest, (places[i] - places[i - 1]).norm() / h);
    furthest_m = std::max(furthest_m, places[i].cwiseAbs().maxCoeff());
  }
  for (std::size_t i = 3; i < count; ++i) {
    const Eigen::Vector3d third =
        places[i] - 3.0 * places[i - 1] + 3.0 * places[i - 2] - places[i - 3];
    const double stands_for = i == 3 || i + 1 == count ? 2.5 : 1.0;  // intervals, to the ends
    greatest_third_m = std::max(greatest_third_m, third.norm());
    jerk_squared += stands_for * third.squaredNorm() / (h * h * h * h * h);  // (third / h^3)^2 h
  }
  const double lasts = h * static_cast<double>(count);
  // Of sums of `per` rounded places, eight of which make a difference, with room for how they were
  // come by. The slowest hand is far above it.
  constexpr double kRoundings = 1024.0;
  const double rounding_m = kRoundings * std::numeric_limits<double>::epsilon() * furthest_m;
  if (fastest == 0.0 || greatest_third_m <= rounding_m) return {};
  return -std::log(lasts * lasts * lasts / (fastest * fastest) * jerk_squared);
}

void add_strokes(std::span<const HandTick> ticks, double rate_hz, HandProcess& result) {
  const std::vector<Stroke> strokes = strokes_of(ticks, rate_hz);
  result.strokes = strokes.size();
  if (strokes.empty()) return;
  double smooth = 0.0;
  std::size_t of = 0;
  for (const Stroke& stroke : strokes) {
    const auto part = ticks.subspan(stroke.first, stroke.last - stroke.first + 1);
    result.stroke_s += seconds(part.front().tick, part.back().tick + 1, rate_hz);
    result.stroke_mm += path_m(part) / kMillimetre;
    if (const auto jerk = log_jerk(part, rate_hz)) smooth += *jerk, ++of;
  }
  const auto count = static_cast<double>(strokes.size());
  result.stroke_s /= count;
  result.stroke_mm /= count;
  result.strokes_per_s = count / seconds(ticks[strokes.front().first].tick,
                                         ticks[strokes.back().last].tick + 1, rate_hz);
  if (of > 0) result.smoothness = smooth / static_cast<double>(of);
}

void add_pauses(std::span<const HandTick> ticks, double rate_hz, HandProcess& result) {
  std::optional<std::uint64_t> last;
  for (const HandTick& tick : ticks) {
    if (!tick.in_contact) continue;
    if (last) {
      const double without_s = seconds(*last, tick.tick, rate_hz);
      if (without_s >= kPause_s) {
        ++result.pauses;
        result.longest_pause_s = std::max(result.longest_pause_s, without_s);
      }
    }
    last = tick.tick;
  }
}

}  // namespace

HandProcess hand_process(std::span<const HandTick> ticks, double rate_hz, double over_N,
                         const Eigen::Vector3d& insertion) {
  HandProcess result;
  result.path_mm = path_m(ticks) / kMillimetre;
  add_strokes(ticks, rate_hz, result);
  add_pauses(ticks, rate_hz, result);
  std::vector<double> forces;
  double angles = 0.0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const HandTick& tick = ticks[i];
    if (!tick.in_contact) continue;
    forces.push_back(tick.force_N);
    if (tick.force_N > over_N) result.over_force_s += 1.0 / rate_hz;
    if (!result.greatest_force_N || tick.force_N > result.greatest_force_N->value) {
      result.greatest_force_N = {tick.force_N, i};
    }
    const double angle = burr_angle_deg(tick.axis, insertion);
    angles += angle;
    if (!result.greatest_burr_angle_deg || angle > result.greatest_burr_angle_deg->value) {
      result.greatest_burr_angle_deg = {angle, i};
    }
  }
  if (forces.empty()) return result;
  result.burr_angle_deg = angles / static_cast<double>(forces.size());
  result.median_force_N = quantile(forces, 0.5);
  result.p95_force_N = quantile(forces, 0.95);
  return result;
}

double burr_angle_deg(const Eigen::Vector3d& axis, const Eigen::Vector3d& insertion) {
  return std::atan2(axis.cross(insertion).norm(), axis.dot(insertion)) / kDegree;
}

double removal_rate(std::span<const HandRemoval> removals, std::size_t tissue, double rate_hz) {
  double volume = 0.0;
  std::size_t slices = 0;
  const auto slice_of = [&](const HandRemoval& removal) {
    return static_cast<std::uint64_t>(static_cast<double>(removal.tick) / (rate_hz * kSlice_s));
  };
  for (std::size_t i = 0, end = 0; i < removals.size(); i = end) {
    std::map<std::size_t, double> went;
    for (; end < removals.size() && slice_of(removals[end]) == slice_of(removals[i]); ++end) {
      went[removals[end].tissue] += removals[end].mm3;
    }
    const auto most = std::ranges::max_element(
        went, [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most->first == tissue) ++slices;
    if (const auto own = went.find(tissue); own != went.end()) volume += own->second;
  }
  return slices > 0 ? volume / (static_cast<double>(slices) * kSlice_s) : 0.0;
}

}  // namespace sulcus
