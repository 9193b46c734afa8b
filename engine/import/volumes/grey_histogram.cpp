#include "engine/import/volumes/grey_histogram.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace sulcus {
namespace {

/// Bins from `low` up; the ends take what lies beyond.
GreyHistogram counted(std::span<const float> values, double low, double width, std::size_t bins) {
  GreyHistogram histogram{low, width, std::vector<std::uint64_t>(bins, 0)};
  const double last = static_cast<double>(bins - 1);
  for (const float v : values) {
    const double bin = std::clamp(std::floor((static_cast<double>(v) - low) / width), 0.0, last);
    ++histogram.counts[static_cast<std::size_t>(bin)];
  }
  return histogram;
}

}  // namespace

std::uint64_t GreyHistogram::total() const {
  std::uint64_t sum = 0;
  for (const std::uint64_t n : counts) sum += n;
  return sum;
}

double GreyHistogram::quantile(double part) const {
  const double wanted = part * static_cast<double>(total());
  double below = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto here = static_cast<double>(counts[i]);
    if (below + here >= wanted && here > 0.0) {
      return edge(i) + width * std::clamp((wanted - below) / here, 0.0, 1.0);
    }
    below += here;
  }
  return edge(counts.size());
}

double GreyHistogram::variance_within(std::span<const double> thresholds) const {
  double within = 0.0, weight = 0.0, sum = 0.0, squares = 0.0;
  std::size_t next = 0;
  const auto close = [&] {
    if (weight > 0.0) within += squares - sum * sum / weight;
    weight = sum = squares = 0.0;
  };
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double value = edge(i) + 0.5 * width;
    while (next < thresholds.size() && value >= thresholds[next]) {
      close();
      ++next;
    }
    const auto n = static_cast<double>(counts[i]);
    weight += n;
    sum += n * value;
    squares += n * value * value;
  }
  close();
  return within / std::max(1.0, static_cast<double>(total()));
}

bool has_three_classes(const GreyHistogram& histogram, std::span<const double> two,
                       std::span<const double> three) {
  constexpr double kLeftOfOneSplit = 0.36;
  return two.size() == 1 && three.size() == 2 &&
         histogram.variance_within(three) < kLeftOfOneSplit * histogram.variance_within(two);
}

GreyHistogram grey_histogram(std::span<const float> values, int bins) {
  if (values.empty()) return {};
  double least = std::numeric_limits<double>::infinity(), most = -least;
  bool whole = true;
  for (const float v : values) {
    least = std::min(least, static_cast<double>(v));
    most = std::max(most, static_cast<double>(v));
    whole = whole && v == std::floor(v);
  }
  const auto n = static_cast<std::size_t>(bins);
  if (!(most > least)) return counted(values, least - 0.5, 1.0, 1);
  constexpr double kBeyond = 1.0 / 2000.0;
  constexpr std::size_t kFine = 65536;
  const GreyHistogram fine = counted(values, least, (most - least) / (kFine - 1), kFine);
  double low = fine.quantile(kBeyond), high = fine.quantile(1.0 - kBeyond);
  if (!(high - low > 4.0 * fine.width)) {  // nearly all of one value: the rest tells it apart
    low = least;
    high = most;
  }
  if (!whole) return counted(values, low, (high - low) / static_cast<double>(n), n);
  low = std::floor(low);
  const double width = std::max(1.0, std::ceil((std::ceil(high) - low + 1.0) / bins));
  const auto needed = static_cast<std::size_t>(std::ceil((std::ceil(high) - low + 1.0) / width));
  return counted(values, low - 0.5, width, needed);
}

std::vector<LabelCount> label_counts(std::span<const float> values, const int (&sizes)[3],
                                     std::size_t most) {
  std::map<int, LabelCount> counts;
  std::size_t at = 0;
  for (int k = 0; k < sizes[2]; ++k) {
    for (int j = 0; j < sizes[1]; ++j) {
      LabelCount* label = nullptr;  // of the voxel before: values come in runs
      for (int i = 0; i < sizes[0]; ++i, ++at) {
        const float v = values[at];
        if (!label || static_cast<float>(label->value) != v) {
          if (v != std::floor(v) || std::abs(v) > 1e6f) return {};
          const int value = static_cast<int>(v);
          label = &counts.try_emplace(value, LabelCount{value, 0, {i, j, k}, {i, j, k}, {}})
                       .first->second;
          if (counts.size() > most) return {};
        }
        ++label->voxels;
        const int p[3] = {i, j, k};
        for (int d = 0; d < 3; ++d) {
          label->low[d] = std::min(label->low[d], p[d]);
          label->high[d] = std::max(label->high[d], p[d]);
          label->middle[d] += p[d];  // a sum, until all are known
        }
      }
    }
  }
  std::vector<LabelCount> all;
  all.reserve(counts.size());
  for (auto& [value, count] : counts) {
    for (double& middle : count.middle) middle /= static_cast<double>(count.voxels);
    all.push_back(count);
  }
  return all;
}

}  // namespace sulcus
