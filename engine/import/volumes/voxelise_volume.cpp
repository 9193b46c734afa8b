#include "engine/import/volumes/voxelise_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <tbb/parallel_for.h>

#include "engine/core/error.hpp"
#include "engine/import/leaf_contents.hpp"
#include "engine/import/meshes/solid_components.hpp"
#include "engine/import/placement.hpp"
#include "engine/import/volumes/grey_fills.hpp"
#include "engine/import/volumes/lattice.hpp"
#include "engine/import/volumes/tissue_values.hpp"

namespace sulcus {
namespace {

// Points around the solid's box that are cut out of the file with it: the stencils at its surface
// reach 3 beyond it.
constexpr int kMargin = 4;

/// The part of a file around its solid, in "cut" index space: (0, 0, 0) is its first point.
struct SolidCut {
  Lattice<float> grey;  // dropped components, and what lies beyond the file: air
  Lattice<std::uint8_t> solid;
  float level = 0.0f;     // solid at or above
  Eigen::Vector3i first;  // its first point in the file
};

std::string plain(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

[[noreturn]] void throw_no_solid(const MedicalVolume& volume, const WorkpieceSettings& settings,
                                 const VolumeImportReport& report) {
  throw InputError(volume.file, settings.solid_above ? "solid_above" : "data",
                   "grey values from " + plain(report.least) + " to " + plain(report.greatest),
                   settings.solid_above ? "some at or above " + plain(*settings.solid_above)
                                        : std::string("a mask with some above 0"));
}

/// What the dropped parts are filled with: the mean of all that is not solid.
float air_value(const MedicalVolume& volume, float level) {
  double sum = 0.0;
  std::uint64_t count = 0;
  for (const float v : volume.values) {
    if (v < level) {
      sum += v;
      ++count;
    }
  }
  // A file without any air: its faces are the surface.
  return count > 0 ? static_cast<float>(sum / static_cast<double>(count)) : level - 1.0f;
}

SolidCut cut_solid(const MedicalVolume& volume, const WorkpieceSettings& settings,
                   VolumeImportReport& report) {
  const bool mask = !settings.solid_above;
  const auto [least, greatest] = std::ranges::minmax_element(volume.values);
  report.least = *least;
  report.greatest = *greatest;
  const float level = mask ? 0.0f : static_cast<float>(*settings.solid_above);
  const SolidComponents components = find_components(volume.values, volume.sizes, level, mask);
  if (components.runs.empty()) throw_no_solid(volume, settings, report);

  const std::uint32_t largest = components.largest();
  const auto kept = [&](const SolidRun& run) { return mask || run.component == largest; };
  Eigen::Vector3i low = volume.sizes, high = Eigen::Vector3i::Zero();
  for (const SolidRun& run : components.runs) {
    const auto length = static_cast<std::uint64_t>(run.end - run.begin);
    (kept(run) ? report.solid_voxels : report.dropped_voxels) += length;
    if (!kept(run)) continue;
    low = low.cwiseMin(Eigen::Vector3i(run.begin, run.j, run.k));
    high = high.cwiseMax(Eigen::Vector3i(run.end, run.j + 1, run.k + 1));
  }
  report.dropped_components = mask ? 0 : static_cast<std::uint32_t>(components.voxels.size() - 1);

  const Eigen::Vector3i first = low - Eigen::Vector3i::Constant(kMargin);
  const Eigen::Vector3i sizes = high - low + Eigen::Vector3i::Constant(2 * kMargin);
  SolidCut cut;
  cut.level = mask ? 0.5f : level;
  cut.first = first;
  cut.grey = Lattice<float>(sizes, mask ? 0.0f : air_value(volume, level));
  cut.solid = Lattice<std::uint8_t>(sizes, 0);
  if (!mask) {
    const Eigen::Vector3i from = first.cwiseMax(0);
    const Eigen::Vector3i to = (first + sizes).cwiseMin(volume.sizes);
    const float air = cut.grey.values.front();
    for (int k = from.z(); k < to.z(); ++k) {
      for (int j = from.y(); j < to.y(); ++j) {
        const float* row = &volume.values[volume.index(0, j, k)];
        float* out = &cut.grey.at(0, j - first.y(), k - first.z());
        // What is solid comes from its run below, so that dropped components stay air.
        for (int i = from.x(); i < to.x(); ++i) out[i - first.x()] = row[i] < level ? row[i] : air;
      }
    }
  }
  for (const SolidRun& run : components.runs) {
    if (!kept(run)) continue;
    const float* row = &volume.values[volume.index(run.begin, run.j, run.k)];
    const std::size_t to =
        cut.grey.index(run.begin - first.x(), run.j - first.y(), run.k - first.z());
    for (int i = 0; i < run.end - run.begin; ++i) {
      cut.grey.values[to + static_cast<std::size_t>(i)] = row[i];
      cut.solid.values[to + static_cast<std::size_t>(i)] = 1;
    }
  }
  return cut;
}

/// Calls `visit(p_cut)` for every crossing of the surface between two neighbouring points, placed
/// linearly between them (a mask's: in the middle).
template <class Visit>
void for_each_crossing(const SolidCut& cut, bool mask, Visit visit) {
  const Eigen::Vector3i n = cut.solid.sizes;
  const std::array<std::ptrdiff_t, 3> stride = {1, n.x(),
                                                static_cast<std::ptrdiff_t>(n.x()) * n.y()};
  for_each_cell(Cell::Ones(), n - Cell::Ones(), [&](const Cell& point) {
    const auto v = static_cast<std::ptrdiff_t>(cut.solid.index(point.x(), point.y(), point.z()));
    if (cut.solid.values[v] == 0) return;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int sign : {-1, 1}) {
        const std::ptrdiff_t w = v + sign * stride[axis];
        if (cut.solid.values[w] != 0) continue;
        const double in = cut.grey.values[v], out = cut.grey.values[w];
        const double t = mask ? 0.5 : (in - cut.level) / (in - out);
        Eigen::Vector3d p_cut = point.cast<double>();
        p_cut[axis] += sign * t;
        visit(p_cut);
      }
    }
  });
}

/// p_cut = linear * p_index + offset.
struct CutFromIndex {
  Eigen::Matrix3d linear;
  Eigen::Vector3d offset;
};

/// Whether the file's lattice is the grid's own, up to an order and a sense of the axes; then the
/// offset is rounded to whole voxels.
bool snap_to_lattice(CutFromIndex& map) {
  constexpr double kTolerance = 1e-5;  // over 1024 voxels a hundredth of one
  const Eigen::Matrix3d whole = map.linear.array().round();
  if ((map.linear - whole).cwiseAbs().maxCoeff() > kTolerance) return false;
  if (std::abs(std::abs(whole.determinant()) - 1.0) > 0.5) return false;
  map.linear = whole;
  // Halves, which an odd number of voxels in an even grid makes, all go down whatever their last
  // bit.
  map.offset = (map.offset.array() + 0.5 - kTolerance).floor();
  return true;
}

class TissueSorter {
 public:
  explicit TissueSorter(std::span<const TissueSettings> tissues) {
    std::optional<std::uint8_t> rest;
    for (std::size_t t = 0; t < tissues.size(); ++t) {
      const auto label = static_cast<std::uint8_t>(t);
      if (tissues[t].label) {
        named_.push_back({static_cast<float>(*tissues[t].label), label});
      } else if (tissues[t].above) {
        steps_.push_back({static_cast<float>(*tissues[t].above), label});
      } else if (!rest) {
        rest = label;
      }
    }
    std::ranges::stable_sort(steps_, {}, &Step::above);
    lowest_ = rest ? *rest : steps_.empty() ? std::uint8_t{0} : steps_.front().label;
  }
  /// Whether two values bracket nothing: what lies between names other tissues.
  bool names() const { return !named_.empty(); }
  std::uint8_t label(float value) const {
    for (const Step& name : named_) {
      if (value == name.above) return name.label;
    }
    std::uint8_t label = lowest_;
    for (const Step& step : steps_) {
      if (value >= step.above) label = step.label;
    }
    return label;
  }

 private:
  struct Step {
    float above;
    std::uint8_t label;
  };
  std::vector<Step> steps_;  // rising
  std::vector<Step> named_;  // of a label map: the value itself
  std::uint8_t lowest_ = 0;
};

/// Where a point lies among the lattice's: the 4 x 4 x 4 points around it and their weights.
struct Stencil {
  Eigen::Vector3i base;  // of the second of four
  Eigen::Vector3f t;     // fractions

  explicit Stencil(const Eigen::Vector3d& p_cut) {
    const Eigen::Vector3d floor = p_cut.array().floor();
    base = floor.cast<int>();
    t = (p_cut - floor).cast<float>();
  }
};

class Sampler {
 public:
  Sampler(const SolidCut& cut, const Lattice<float>* tissue, Interpolation kind, bool mask,
          const CutFromIndex& map, const TissueSorter* sorter)
      : cut_(cut), tissue_(tissue), kind_(kind), mask_(mask), map_(map), sorter_(sorter) {}

  /// Solid bits of a leaf, and its tissues into `labels` (null: none wanted).
  void sample_leaf(const Cell& origin, std::uint32_t leaf, LeafBits& bits,
                   TissueMap* labels) const {
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * (kLeafEdge - 1));
    const Eigen::Vector3d centre = map_.linear * (origin.cast<double>() + half) + map_.offset;
    const Eigen::Vector3d reach = map_.linear.cwiseAbs() * half;
    const Eigen::Vector3i low = (centre - reach).array().floor().cast<int>().matrix();
    const Eigen::Vector3i high = (centre + reach).array().floor().cast<int>().matrix();
    const Eigen::Vector3i sizes = cut_.grey.sizes;
    const Eigen::Vector3i last = sizes - Eigen::Vector3i::Ones();
    if ((high.array() < 1).any() || (low.array() > last.array() - 2).any()) return;

    const Range range =
        range_of(cut_.grey, low - Eigen::Vector3i::Ones(), high + Eigen::Vector3i::Constant(2));
    if (range.greatest < cut_.level) return;
    const bool full = range.least >= cut_.level;
    if (full) bits.words.fill(~std::uint64_t{0});
    bool label_each = false;
    std::uint8_t uniform = 0;
    if (labels != nullptr) {
      const Range grey = range_of(*tissue_, low, high + Eigen::Vector3i::Ones());
      uniform = sorter_->label(grey.least);
      label_each =
          sorter_->names() ? grey.least < grey.greatest : uniform != sorter_->label(grey.greatest);
    }
    LabelBlock block;
    if (label_each) block.fill(0);
    if (!full || label_each) {
      for (int place = 0; place < 512; ++place) {
        const Eigen::Vector3d p_index = (origin + cell_in_leaf(place)).cast<double>();
        const Stencil at(map_.linear * p_index + map_.offset);
        if (!full) {
          if (value(at) < cut_.level) continue;
          bits.set(place);
        }
        if (label_each) block[place] = sorter_->label(tissue_value(at));
      }
    }
    if (labels == nullptr) return;
    if (label_each) {
      labels->set_block(leaf, block, bits);
    } else {
      labels->set_uniform(leaf, uniform);
    }
  }

  /// Makes a leaf's voxels those that `page` fills. Those that were not solid take their tissue
  /// from beneath the surface too.
  void fill_leaf(const LeafLevels& page, VoxelModel& model, TissueMap* labels) const {
    const LeafBits filled = filled_voxels(page.levels);
    const LeafBits added = without(filled, model.leaves[page.leaf]);
    model.leaves[page.leaf] = filled;
    if (labels == nullptr || !any(added)) return;
    LabelBlock block = labels_of(*labels, page.leaf);
    for_each_voxel(added, [&](int place) {
      const Cell c = model.grid.leaf_origin(page.leaf) + cell_in_leaf(place);
      block[place] =
          sorter_->label(tissue_value(Stencil(map_.linear * c.cast<double>() + map_.offset)));
    });
    labels->set_block(page.leaf, block, filled);
  }

 private:
  struct Range {
    float least = std::numeric_limits<float>::infinity();
    float greatest = -std::numeric_limits<float>::infinity();
  };

  static Range range_of(const Lattice<float>& values, Eigen::Vector3i low, Eigen::Vector3i high) {
    low = low.cwiseMax(0).cwiseMin(values.sizes - Eigen::Vector3i::Ones());
    high = high.cwiseMax(0).cwiseMin(values.sizes - Eigen::Vector3i::Ones());
    Range range;
    for (int k = low.z(); k <= high.z(); ++k) {
      for (int j = low.y(); j <= high.y(); ++j) {
        const float* row = &values.at(0, j, k);
        for (int i = low.x(); i <= high.x(); ++i) {
          range.least = std::min(range.least, row[i]);
          range.greatest = std::max(range.greatest, row[i]);
        }
      }
    }
    return range;
  }

  /// Beyond the cut lies the air of its margin.
  float value(const Stencil& at) const {
    const Eigen::Vector3i n = cut_.grey.sizes;
    if ((at.base.array() < 1).any() || (at.base.array() > n.array() - 3).any()) {
      return -std::numeric_limits<float>::infinity();
    }
    const auto wx = interpolation_weights(kind_, at.t.x());
    const auto wy = interpolation_weights(kind_, at.t.y());
    const auto wz = interpolation_weights(kind_, at.t.z());
    const float* corner = &cut_.grey.at(at.base.x() - 1, at.base.y() - 1, at.base.z() - 1);
    const std::ptrdiff_t row = n.x();
    const std::ptrdiff_t slice = row * n.y();
    float sum = 0.0f;
    for (int k = 0; k < 4; ++k) {
      float plane = 0.0f;
      for (int j = 0; j < 4; ++j) {
        const float* p = corner + k * slice + j * row;
        plane += wy[j] * (wx[0] * p[0] + wx[1] * p[1] + wx[2] * p[2] + wx[3] * p[3]);
      }
      sum += wz[k] * plane;
    }
    return sum;
  }

  /// Grey value that tells the tissue of a solid point: linear between the lattice's, or, for a
  /// mask, whose values are names and not amounts, that of the nearest solid corner.
  float tissue_value(const Stencil& at) const {
    const Eigen::Vector3i last = tissue_->sizes - Eigen::Vector3i::Constant(2);
    const Eigen::Vector3i base = at.base.cwiseMax(0).cwiseMin(last);
    float sum = 0.0f, nearest = 0.0f, heaviest = -1.0f;
    for (int corner = 0; corner < 8; ++corner) {
      const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
      const float weight = (i != 0 ? at.t.x() : 1.0f - at.t.x()) *
                           (j != 0 ? at.t.y() : 1.0f - at.t.y()) *
                           (k != 0 ? at.t.z() : 1.0f - at.t.z());
      const std::size_t v = tissue_->index(base.x() + i, base.y() + j, base.z() + k);
      sum += weight * tissue_->values[v];
      if (cut_.solid.values[v] != 0 && weight > heaviest) {
        heaviest = weight;
        nearest = tissue_->values[v];
      }
    }
    return mask_ ? nearest : sum;
  }

  const SolidCut& cut_;
  const Lattice<float>* tissue_;
  Interpolation kind_;
  bool mask_;
  CutFromIndex map_;
  const TissueSorter* sorter_;
};

/// Where the cut lies in the grid: by its solid's box along the file's axes, then snapped to the
/// lattice where the two agree. Says so in `report`.
CutFromIndex place_in_grid(const MedicalVolume& volume, const SolidCut& cut,
                           const Eigen::Matrix3d& file_from_cut, const VoxelGrid& grid,
                           const WorkpieceSettings& settings, VolumeImportReport& report) {
  Eigen::AlignedBox3d box_file;
  for_each_crossing(cut, !settings.solid_above,
                    [&](const Eigen::Vector3d& p_cut) { box_file.extend(file_from_cut * p_cut); });
  const Eigen::Affine3d world_from_file = placement(box_file.center(), settings);
  const Eigen::Affine3d file_from_world = world_from_file.inverse();
  const Eigen::Matrix3d cut_from_file = file_from_cut.inverse();
  CutFromIndex map;
  map.linear = cut_from_file * file_from_world.linear() * grid.voxel_m;
  map.offset = cut_from_file * (file_from_world * grid.world_from_index(Eigen::Vector3d::Zero()));
  const CutFromIndex wanted = map;
  report.resampled = !snap_to_lattice(map);
  if (!report.resampled) {
    report.beside_m = -(map.linear.inverse() * (map.offset - wanted.offset)) * grid.voxel_m;
  }
  // By the rounded map, not by the placement that was asked for: the result lies over the file.
  Eigen::Affine3d file_from_index = Eigen::Affine3d::Identity();
  file_from_index.linear() = file_from_cut * map.linear;
  file_from_index.translation() =
      volume.origin_m + file_from_cut * (map.offset + cut.first.cast<double>());
  report.file_from_world = file_from_index * Eigen::Translation3d(grid.origin_index()) *
                           Eigen::Scaling(1.0 / grid.voxel_m);
  return map;
}

/// Whether the solid's surface lies beyond the grid somewhere.
bool is_clipped(const SolidCut& cut, bool mask, const CutFromIndex& map, const VoxelGrid& grid) {
  bool clipped = false;
  const Eigen::Matrix3d index_from_cut = map.linear.inverse();
  const Eigen::Vector3d end_index = grid.cells.cast<double>() - Eigen::Vector3d::Constant(0.5);
  for_each_crossing(cut, mask, [&](const Eigen::Vector3d& p_cut) {
    const Eigen::Vector3d p_index = index_from_cut * (p_cut - map.offset);
    constexpr double kSlack = 1e-6;  // a solid that just fills the grid is whole
    clipped |= (p_index.array() < -0.5 - kSlack).any() ||
               (p_index.array() > end_index.array() + kSlack).any();
  });
  return clipped;
}

Interpolation interpolation_for(bool resampled, bool mask, const Eigen::Matrix3d& file_from_cut,
                                const VoxelGrid& grid) {
  if (!resampled) return Interpolation::kNearest;
  constexpr double kCoarse = 1.5;
  const double coarseness = std::cbrt(std::abs(file_from_cut.determinant())) / grid.voxel_m;
  return !mask || coarseness > kCoarse ? Interpolation::kSpline : Interpolation::kLinear;
}

}  // namespace

VoxelModel voxelise_volume(const MedicalVolume& volume, const VoxelGrid& grid,
                           const WorkpieceSettings& settings,
                           std::span<const TissueSettings> tissues, VolumeImportReport* report) {
  if (!volume.spacing_known && !settings.spacing_m) {
    throw InputError(volume.file, "spacing", "none in the file",
                     "spacing_mm beside it in the scene");
  }
  const bool mask = !settings.solid_above;
  VolumeImportReport found;
  SolidCut cut = cut_solid(volume, settings, found);

  const Eigen::Matrix3d file_from_cut =
      volume.direction * settings.spacing_m.value_or(volume.spacing_m).asDiagonal();
  const CutFromIndex map = place_in_grid(volume, cut, file_from_cut, grid, settings, found);
  const Interpolation kind = interpolation_for(found.resampled, mask, file_from_cut, grid);

  VoxelModel model;
  model.grid = grid;
  model.leaves.resize(grid.leaf_count());
  model.clipped = is_clipped(cut, mask, map, grid);

  std::shared_ptr<TissueMap> labels;
  std::optional<TissueSorter> sorter;
  Lattice<float> tissue;
  if (tissues.size() > 1) {
    labels = std::make_shared<TissueMap>(grid.leaf_count());
    sorter.emplace(tissues);
    tissue = mask ? cut.grey : tissue_values(cut.grey, cut.solid);
  }
  if (mask) {
    for (std::size_t v = 0; v < cut.grey.values.size(); ++v) {
      cut.grey.values[v] = cut.solid.values[v] != 0 ? 1.0f : 0.0f;
    }
  }

  const Sampler sampler(cut, labels ? &tissue : nullptr, kind, mask, map,
                        sorter ? &*sorter : nullptr);
  tbb::parallel_for(std::uint32_t{0}, grid.leaf_count(), [&](std::uint32_t leaf) {
    sampler.sample_leaf(grid.leaf_origin(leaf), leaf, model.leaves[leaf], labels.get());
  });
  if (settings.surface == SurfaceKind::kFractions) {
    std::vector<LeafLevels> pages;
    if (!mask) pages = grey_fills(model, {cut.grey, cut.level, map.linear, map.offset});
    tbb::parallel_for(std::size_t{0}, pages.size(),
                      [&](std::size_t n) { sampler.fill_leaf(pages[n], model, labels.get()); });
    model.fills.emplace(grid.leaf_count(), std::move(pages));
  }
  if (model.solid_count() == 0) {
    throw InputError(volume.file, "position_mm", "a solid that misses the grid",
                     "one that reaches into it");
  }
  model.tissues = std::move(labels);
  if (report != nullptr) *report = found;
  return model;
}

}  // namespace sulcus
