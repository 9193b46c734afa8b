#include "engine/assessment/cut_walls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>

#include "engine/core/units.hpp"

namespace sulcus {

namespace {

constexpr double kHalfWidth_mm = 0.4;
constexpr double kApart_mm = 0.25;
constexpr double kLeastHeight_mm = 0.25;
constexpr double kOneSurface_mm = 0.15, kStep_mm = 0.25, kTall_mm = 0.6;
constexpr std::size_t kLeastSamples = 12;
constexpr double kAlike = 0.5;  // cosine: normals of one wall
constexpr std::size_t kSectors = 24;

using Row = Eigen::Matrix<double, 6, 1>;

/// Samples by the square of kHalfWidth_mm that they stand in, whatever their height.
class Columns {
 public:
  explicit Columns(const std::vector<WallSample>& samples) : samples_(samples) {
    for (std::size_t i = 0; i < samples.size(); ++i) at_[square(samples[i].at_mm)].push_back(i);
  }
  template <class Visit>
  void near(const Eigen::Vector3d& p_mm, const Visit& visit) const {
    const auto [x, y] = square(p_mm);
    for (std::int64_t dy = -1; dy <= 1; ++dy) {
      for (std::int64_t dx = -1; dx <= 1; ++dx) {
        const auto found = at_.find({x + dx, y + dy});
        if (found == at_.end()) continue;
        for (const std::size_t i : found->second) visit(samples_[i]);
      }
    }
  }

 private:
  static std::pair<std::int64_t, std::int64_t> square(const Eigen::Vector3d& p_mm) {
    return {std::llround(std::floor(p_mm.x() / kHalfWidth_mm)),
            std::llround(std::floor(p_mm.y() / kHalfWidth_mm))};
  }
  const std::vector<WallSample>& samples_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::size_t>> at_;
};

Eigen::Vector2d sideways(const WallSample& sample) { return sample.normal.head<2>().normalized(); }

class PatchFit {
 public:
  PatchFit(const Columns& columns, const WallSample& seed) {
    facing_ = sideways(seed);
    facing_ = mean_facing(columns, seed);
    const Eigen::Vector2d along(-facing_.y(), facing_.x());
    columns.near(seed.at_mm, [&](const WallSample& sample) {
      const Eigen::Vector2d from = (sample.at_mm - seed.at_mm).head<2>();
      if (!is_of_wall(sample, from) || std::abs(along.dot(from)) > kHalfWidth_mm) return;
      members_.push_back({along.dot(from), facing_.dot(from), sample.at_mm.z(), sample.area_mm2});
    });
  }

  bool fit(const WallSample& seed, WallPatch& patch) {
    if (!keep_the_seeds_surface(seed) || members_.size() < kLeastSamples) return false;
    const auto [low, high] = std::ranges::minmax(members_, {}, &Member::z);
    if (high.z - low.z < kLeastHeight_mm) return false;
    const double middle = 0.5 * (low.z + high.z);
    const Row fitted = fit_of(members_, middle, 6);
    double off = 0.0, area = 0.0;
    for (const Member& m : members_) {
      off += m.area * std::abs(m.w - fitted.dot(row_of(m, middle)));
      area += m.area;
    }
    const Eigen::Vector2d at = seed.at_mm.head<2>() + fitted[0] * facing_;
    patch = {.at_mm = {at.x(), at.y(), middle},
             .facing = facing_,
             .taper_deg = std::atan(-fitted[2]) / kDegree,
             .roughness_um = 1e3 * off / area,
             .area_mm2 = area};
    return true;
  }

 private:
  struct Member {
    double t, w, z, area;
  };
  static Row row_of(const Member& m, double middle) {
    const double z = m.z - middle;
    return Row(1.0, m.t, z, m.t * m.t, m.t * z, m.t * m.t * z);
  }
  /// Least squares over area; of the terms only the first so many.
  static Row fit_of(const std::vector<Member>& members, double middle, int terms) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Row right = Row::Zero();
    double area = 0.0;
    for (const Member& m : members) {
      const Row row = row_of(m, middle);
      normal += m.area * row * row.transpose();
      right += m.area * m.w * row;
      area += m.area;
    }
    // So little that it only decides what the samples leave open.
    normal.diagonal().array() += 1e-9 * area;
    Row fitted = Row::Zero();
    fitted.head(terms) = normal.topLeftCorner(terms, terms).ldlt().solve(right.head(terms));
    return fitted;
  }
  /// Leaves out what stands before or behind the wall of the seed, such as that of a pit or a step
  /// below it: from what is as high as the seed, up and down as far as the same surface goes on.
  bool keep_the_seeds_surface(const WallSample& seed) {
    const std::vector<Member> all = std::move(members_);
    const double level = seed.at_mm.z();
    members_.clear();
    std::ranges::copy_if(all, std::back_inserter(members_), [&](const Member& m) {
      return std::abs(m.z - level) < kStep_mm && std::abs(m.w) < kOneSurface_mm;
    });
    double low = level, high = level;
    while (!members_.empty()) {
      const auto [lowest, highest] = std::ranges::minmax(members_, {}, &Member::z);
      if (lowest.z >= low && highest.z <= high) return true;
      low = std::min(low, lowest.z);
      high = std::max(high, highest.z);
      const Row fitted = fit_of(members_, level, high - low < kTall_mm ? 4 : 6);
      members_.clear();
      std::ranges::copy_if(all, std::back_inserter(members_), [&](const Member& m) {
        return m.z > low - kStep_mm && m.z < high + kStep_mm &&
               std::abs(m.w - fitted.dot(row_of(m, level))) < kOneSurface_mm;
      });
    }
    return false;
  }
  /// Not on the other side of a thin wall, nor round a corner.
  bool is_of_wall(const WallSample& sample, const Eigen::Vector2d& from) const {
    return sideways(sample).dot(facing_) > kAlike && from.norm() < 1.5 * kHalfWidth_mm;
  }
  Eigen::Vector2d mean_facing(const Columns& columns, const WallSample& seed) const {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    columns.near(seed.at_mm, [&](const WallSample& sample) {
      const Eigen::Vector2d from = (sample.at_mm - seed.at_mm).head<2>();
      if (is_of_wall(sample, from)) sum += sample.area_mm2 * sideways(sample);
    });
    return sum.norm() > 0.0 ? Eigen::Vector2d(sum.normalized()) : facing_;
  }

  Eigen::Vector2d facing_;
  std::vector<Member> members_;
};

std::size_t sector_of(const Eigen::Vector2d& facing) {
  const double turn = std::atan2(facing.y(), facing.x()) / (2.0 * std::numbers::pi) + 1.0;
  return static_cast<std::size_t>(std::lround(turn * kSectors)) % kSectors;
}

/// A patch that fits so much worse than the others lies over an edge, where it has no taper.
double ragged_above_um(const std::vector<WallPatch>& patches) {
  if (patches.empty()) return 0.0;
  std::vector<double> roughness;
  roughness.reserve(patches.size());
  for (const WallPatch& patch : patches) roughness.push_back(patch.roughness_um);
  const auto middle = roughness.begin() + static_cast<std::ptrdiff_t>(roughness.size() / 2);
  std::nth_element(roughness.begin(), middle, roughness.end());
  return std::max(3.0 * *middle, 20.0);
}

}  // namespace

std::vector<WallPatch> wall_patches(const std::vector<WallSample>& samples) {
  const Columns columns(samples);
  std::vector<WallPatch> patches;
  // One seed to a square and sector, so that both walls of a slot have theirs.
  std::map<std::array<std::int64_t, 3>, std::size_t> seeds;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3d& p = samples[i].at_mm;
    const auto sector = static_cast<std::int64_t>(sector_of(sideways(samples[i])) / 6);
    seeds.try_emplace({std::llround(std::floor(p.x() / kApart_mm)),
                       std::llround(std::floor(p.y() / kApart_mm)), sector},
                      i);
  }
  for (const auto& [square, i] : seeds) {
    WallPatch patch{};
    if (PatchFit(columns, samples[i]).fit(samples[i], patch)) patches.push_back(patch);
  }
  return patches;
}

Convergence convergence_of(const std::vector<WallPatch>& patches) {
  std::array<double, kSectors> area{}, taper{};
  const double ragged_um = ragged_above_um(patches);
  for (const WallPatch& patch : patches) {
    if (patch.roughness_um > ragged_um) continue;
    const std::size_t sector = sector_of(patch.facing);
    area[sector] += patch.area_mm2;
    taper[sector] += patch.area_mm2 * patch.taper_deg;
  }
  double weights = 0.0, sum = 0.0;
  for (std::size_t s = 0; s < kSectors / 2; ++s) {
    const std::size_t other = s + kSectors / 2;
    const double weight = std::min(area[s], area[other]);
    if (weight == 0.0) continue;
    weights += weight;
    sum += weight * (taper[s] / area[s] + taper[other] / area[other]);
  }
  Convergence result;
  if (weights == 0.0) return result;
  result.mean_deg = sum / weights;
  const double wanted = 0.5 * result.mean_deg;
  result.worst = &*std::ranges::max_element(patches, {}, [&](const WallPatch& p) {
    return p.roughness_um > ragged_um ? -1.0 : std::abs(p.taper_deg - wanted);
  });
  return result;
}

WallTaper taper_facing(const std::vector<WallPatch>& patches, const Eigen::Vector2d& direction) {
  const double ragged_um = ragged_above_um(patches);
  std::vector<const WallPatch*> facing;
  double area = 0.0, sum = 0.0;
  for (const WallPatch& patch : patches) {
    if (patch.roughness_um > ragged_um) continue;
    if (patch.facing.dot(direction) <= std::numbers::sqrt2 / 2.0) continue;
    facing.push_back(&patch);
    area += patch.area_mm2;
    sum += patch.area_mm2 * patch.taper_deg;
  }
  WallTaper result;
  if (facing.empty()) return result;
  result.mean_deg = sum / area;
  result.worst = *std::ranges::max_element(facing, {}, [&](const WallPatch* patch) {
    return std::abs(patch->taper_deg - result.mean_deg);
  });
  return result;
}

}  // namespace sulcus
