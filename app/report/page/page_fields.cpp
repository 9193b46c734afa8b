#include "app/report/page/page_fields.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <tbb/parallel_for.h>

#include "engine/outcome/voxel_distance.hpp"
#include "engine/volume/voxel_values.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus {

namespace {

constexpr double kMostSamples = 250000.0;

std::uint8_t byte_of(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

/// The lattice of the samples, and what is found for each while they are made.
struct Lattice {
  const VoxelModel& start;
  const Cell first;
  const int step;
  const Eigen::Vector3i samples;
  std::vector<char> known{};  // whether a sample is of a voxel that was solid

  std::size_t size() const { return static_cast<std::size_t>(samples.prod()); }
  std::size_t place(const Cell& at) const {
    return static_cast<std::size_t>(at.x() + samples.x() * (at.y() + samples.y() * at.z()));
  }
  Cell at(std::size_t n) const {
    const int i = static_cast<int>(n);
    return {i % samples.x(), i / samples.x() % samples.y(), i / samples.x() / samples.y()};
  }
  Cell voxel(std::size_t n) const { return first + step * at(n); }
};

Lattice lattice_over(const VoxelModel& start, const Eigen::AlignedBox3i& box) {
  const Eigen::Vector3d cells = (box.max() - box.min() + Cell::Ones()).cast<double>();
  int step = 1;
  const auto samples = [&](int by) { return (cells / by).array().ceil().cast<int>() + 1; };
  while (samples(step).cast<double>().prod() > kMostSamples) ++step;
  Lattice lattice{start, box.min(), step, samples(step)};
  lattice.known.resize(lattice.size());
  for (std::size_t n = 0; n < lattice.size(); ++n) {
    lattice.known[n] = start.solid(lattice.voxel(n)) ? 1 : 0;
  }
  return lattice;
}

/// Of the solid samples, to the nearest voxel of a set, from centre to centre, voxels; 1e9 where
/// there is none.
std::vector<double> distances_to(const Lattice& lattice, const VoxelSet& set) {
  const VoxelGrid& grid = lattice.start.grid;
  VoxelSet from(grid);
  std::vector<double> distances(lattice.size(), 1e9);
  for (std::size_t n = 0; n < lattice.size(); ++n) {
    if (lattice.known[n]) from.insert(lattice.voxel(n));
  }
  const std::vector<std::uint32_t> squared = squared_distances(from, set);
  if (squared.empty()) return distances;
  auto next = squared.begin();
  for (const std::uint32_t leaf : from.leaves()) {
    for_each_voxel(from.voxels(leaf), [&](int at) {
      const Cell c = (grid.leaf_origin(leaf) + cell_in_leaf(at) - lattice.first) / lattice.step;
      distances[lattice.place(c)] = std::sqrt(static_cast<double>(*next++));
    });
  }
  return distances;
}

/// Where a sample was not solid: the mean of those beside it that are known, outward from those.
void spread(const Lattice& lattice, std::vector<Eigen::Vector4d>& values) {
  static const std::array<Cell, 6> kSides{Cell(1, 0, 0),  Cell(-1, 0, 0), Cell(0, 1, 0),
                                          Cell(0, -1, 0), Cell(0, 0, 1),  Cell(0, 0, -1)};
  std::vector<char> known = lattice.known;
  for (int pass = 0; pass < 4; ++pass) {
    const std::vector<char> before = known;
    for (std::size_t n = 0; n < lattice.size(); ++n) {
      if (before[n]) continue;
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      int count = 0;
      for (const Cell& side : kSides) {
        const Cell at = lattice.at(n) + side;
        if ((at.array() < 0).any() || (at.array() >= lattice.samples.array()).any()) continue;
        if (!before[lattice.place(at)]) continue;
        sum += values[lattice.place(at)];
        ++count;
      }
      if (count == 0) continue;
      values[n] = sum / count;
      known[n] = 1;
    }
  }
}

/// Of each solid sample, how far it lies from the goal's wall, m, beyond it above 0.
std::vector<double> from_goal(const Lattice& lattice, const VoxelSet& target) {
  VoxelSet outside(target.grid());
  const VoxelModel& start = lattice.start;
  for (std::uint32_t leaf = 0; leaf < start.leaves.size(); ++leaf) {
    const LeafBits rest = without(start.leaves[leaf], target.voxels(leaf));
    if (any(rest)) outside.insert(leaf, rest);
  }
  const std::vector<double> to_target = distances_to(lattice, target);
  const std::vector<double> to_outside = distances_to(lattice, outside);
  std::vector<double> from_m(lattice.size());
  for (std::size_t n = 0; n < from_m.size(); ++n) {
    if (!lattice.known[n]) continue;
    // The wall lies between the voxels, half of one from the centres beside it.
    const double voxels =
        target.contains(lattice.voxel(n)) ? 0.5 - to_outside[n] : to_target[n] - 0.5;
    from_m[n] = voxels * start.grid.voxel_m;
  }
  return from_m;
}

std::vector<double> depth_to_surface(const Lattice& lattice) {
  const VoxelModel& start = lattice.start;
  VoxelSet surface(start.grid);
  for (std::uint32_t leaf = 0; leaf < start.leaves.size(); ++leaf) {
    if (!any(start.leaves[leaf])) continue;
    const LeafBits shown = surface_of_leaf(start, leaf);
    if (any(shown)) surface.insert(leaf, shown);
  }
  std::vector<double> depth_m = distances_to(lattice, surface);
  for (double& d : depth_m) d = (d + 0.5) * start.grid.voxel_m;
  return depth_m;
}

/// Up to the last of the tooth over each sample.
std::vector<double> depth_along(const Lattice& lattice, const Eigen::Vector3d& insertion) {
  const VoxelModel& start = lattice.start;
  std::vector<double> depth_m(lattice.size(), 0.0);
  tbb::parallel_for(std::size_t{0}, lattice.size(), [&](std::size_t n) {
    if (!lattice.known[n]) return;
    const Eigen::Vector3d from = lattice.voxel(n).cast<double>();
    int last = 0;
    for (int t = 1;; ++t) {
      const Cell c = (from + t * insertion).array().round().cast<int>();
      if (!start.grid.contains(c)) break;
      if (start.solid(c)) last = t;
    }
    depth_m[n] = (last + 0.5) * start.grid.voxel_m;
  });
  return depth_m;
}

/// Of each voxel that went, its turn among all of them, 0 to 1.
VoxelValues turns(const VoxelGrid& grid, const FieldSettings& settings) {
  const auto counts = [&](const Edit& edit) {
    return edit.body == settings.body && edit.is_gone();
  };
  const auto all = static_cast<double>(std::ranges::count_if(settings.edits, counts));
  VoxelValues turn_of(grid);
  double turn = 0.0;
  for (const Edit& edit : settings.edits) {
    if (!counts(edit)) continue;
    turn_of[grid.cell_of_linear(edit.voxel)] = static_cast<float>((turn += 1.0) / all);
  }
  return turn_of;
}

void add_turns(const Lattice& lattice, const VoxelValues& turn_of, PageFields& fields) {
  tbb::parallel_for(std::size_t{0}, lattice.size(), [&](std::size_t n) {
    const Cell middle = lattice.voxel(n);
    double sum = 0.0;
    int count = 0;
    for_each_cell(middle - Cell::Ones(), middle + Cell::Constant(2), [&](const Cell& c) {
      const float turn = turn_of.at(c);
      if (std::isnan(turn)) return;
      sum += static_cast<double>(turn);
      ++count;
    });
    fields.cut_depth[n][0] = byte_of(255.0 * sum / 27.0);
    fields.cut_depth[n][1] = byte_of(255.0 * count / 27.0);
  });
}

/// Colour, and distance from the goal, of each sample.
void add_tissues(const Lattice& lattice, const FieldSettings& settings, PageFields& fields) {
  std::vector<double> goal_m;
  if (settings.target) goal_m = from_goal(lattice, *settings.target);
  std::vector<Eigen::Vector4d> values(lattice.size(), Eigen::Vector4d::Zero());
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (!lattice.known[n]) continue;
    const std::size_t label = lattice.start.tissue(lattice.voxel(n));
    const auto& colour = settings.looks[std::min(label, settings.looks.size() - 1)].colour;
    for (int k = 0; k < 3; ++k) values[n][k] = screen_byte(static_cast<double>(colour[k]));
    values[n][3] =
        goal_m.empty() ? 0.0 : std::clamp(128.0 + goal_m[n] / PageFields::kGoalStep_m, 1.0, 255.0);
  }
  spread(lattice, values);
  for (std::size_t n = 0; n < values.size(); ++n) {
    for (std::size_t k = 0; k < 4; ++k) {
      fields.tissue_goal[n][k] = byte_of(values[n][static_cast<Eigen::Index>(k)]);
    }
  }
}

void add_depth(const Lattice& lattice, const FieldSettings& settings, PageFields& fields) {
  const std::vector<double> depth_m = settings.kind == AssessedKind::kCrown
                                          ? depth_to_surface(lattice)
                                          : depth_along(lattice, settings.insertion);
  std::vector<Eigen::Vector4d> values(lattice.size(), Eigen::Vector4d::Zero());
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (lattice.known[n]) values[n][0] = depth_m[n] / PageFields::kDepthStep_m;
  }
  spread(lattice, values);
  for (std::size_t n = 0; n < values.size(); ++n) fields.cut_depth[n][2] = byte_of(values[n][0]);
}

}  // namespace

std::uint8_t screen_byte(double linear) {
  const double v = std::clamp(linear, 0.0, 1.0);
  return byte_of(255.0 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055));
}

PageFields page_fields(const VoxelModel& start, const Eigen::AlignedBox3i& box,
                       const FieldSettings& settings) {
  const Lattice lattice = lattice_over(start, box);
  PageFields fields{.first = lattice.first, .step = lattice.step, .samples = lattice.samples};
  fields.tissue_goal.resize(lattice.size());
  fields.cut_depth.resize(lattice.size());
  add_tissues(lattice, settings, fields);
  add_turns(lattice, turns(start.grid, settings), fields);
  add_depth(lattice, settings, fields);
  return fields;
}

}  // namespace sulcus
