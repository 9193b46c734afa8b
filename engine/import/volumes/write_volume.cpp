#include "engine/import/volumes/write_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <vector>

#include <Eigen/Geometry>
#include <tbb/parallel_for.h>

#include "engine/core/ascii.hpp"
#include "engine/core/error.hpp"
#include "engine/import/volumes/itk_volume_writer.hpp"
#include "engine/import/volumes/volume_checks.hpp"

namespace sulcus {
namespace {

std::uint8_t value_of(const VoxelModel& model, const Cell& c, VolumeContent content) {
  if (content == VolumeContent::kFills) return model.level(c);
  const bool labelled = content == VolumeContent::kLabels && model.tissues;
  return static_cast<std::uint8_t>(labelled ? 1 + model.tissue(c) : 1);
}

std::vector<std::uint8_t> voxels_of(const VoxelModel& model, VolumeContent content) {
  const VoxelGrid& grid = model.grid;
  std::vector<std::uint8_t> voxels(grid.cell_count(), 0);
  for (std::uint32_t leaf = 0; leaf < grid.leaf_count(); ++leaf) {
    const LeafBits& bits = model.leaves[leaf];
    if (bits == LeafBits{}) continue;
    const Cell origin = grid.leaf_origin(leaf);
    for_each_voxel(bits, [&](int place) {
      const Cell c = origin + cell_in_leaf(place);
      voxels[grid.linear(c)] = value_of(model, c, content);
    });
  }
  return voxels;
}

/// `space_from_lattice`: columns are the steps along the axes, which are not 0.
void place(const Eigen::Affine3d& space_from_lattice, const Eigen::Vector3i& sizes,
           ItkMask& volume) {
  for (int d = 0; d < 3; ++d) {
    const Eigen::Vector3d step = space_from_lattice.linear().col(d);
    volume.sizes[d] = sizes[d];
    volume.spacing_m[d] = step.norm();
    volume.origin_m[d] = space_from_lattice.translation()[d];
    for (int row = 0; row < 3; ++row) volume.axes[d][row] = step[row] / step.norm();
  }
}

Eigen::Affine3d world_from_index(const VoxelGrid& grid) {
  return Eigen::Scaling(grid.voxel_m) * Eigen::Translation3d(-grid.origin_index());
}

/// Refuses a lattice that the format cannot hold: NIfTI's rotation and MetaImage's know right
/// angles only (other programs make them so when they read), NIfTI-1's sizes are of 16 bits.
void check_holds(const std::string& path, const Eigen::Affine3d& space_from_lattice,
                 const Eigen::Vector3i& sizes) {
  const std::string name = lower_case(path);
  if (name.ends_with(".nrrd")) return;
  if (name.ends_with(".nii.gz") && sizes.maxCoeff() > std::numeric_limits<std::int16_t>::max()) {
    throw InputError(path, "sizes", std::to_string(sizes.maxCoeff()) + " voxels along an axis",
                     ".nrrd or .mha for more than 32767");
  }
  const Eigen::Matrix3d steps = space_from_lattice.linear();
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    const double cosine = steps.col(a).normalized().dot(steps.col(b).normalized());
    // By how much of a voxel the last one would lie beside its place.
    constexpr double kSeen = 0.05;
    if (std::abs(cosine) * std::max(sizes[a], sizes[b]) < kSeen) continue;
    std::ostringstream found;
    found.precision(4);
    found << "axes at " << std::acos(cosine) * 180.0 / std::numbers::pi << " degrees to each other";
    throw InputError(path, "geometry", found.str(),
                     ".nrrd, which holds them, or --geometry file, of axes at right angles");
  }
}

/// Fills one voxel of the input's lattice from the grid's voxels in it.
class Resampler {
 public:
  Resampler(const VoxelModel& model, VolumeContent content, const InputGeometry& input)
      : model_(model), content_(content) {
    const Eigen::Affine3d world_from_lattice =
        input.file_from_world.inverse() * input.file_from_lattice();
    index_from_lattice_ = world_from_index(model.grid).inverse() * world_from_lattice;
    // Along an axis, an odd number: no voxel is half solid, which would be for one side only. For a
    // mean as many in each of the grid's voxels.
    constexpr double kMostSamples = 9.0;
    const double odd = content == VolumeContent::kFills ? 0.0 : 1.0;
    for (int d = 0; d < 3; ++d) {
      const double voxels = input.spacing_m[d] / model.grid.voxel_m;
      samples_[d] = static_cast<int>(
          std::clamp(2.0 * std::ceil(voxels - 1e-9) - odd, 1.0, kMostSamples + 1.0 - odd));
    }
  }

  /// Of the lattice, what the grid's box reaches: [low, high).
  void reach(const Eigen::Vector3i& sizes, Eigen::Vector3i& low, Eigen::Vector3i& high) const {
    const Eigen::Affine3d lattice_from_index = index_from_lattice_.inverse();
    const Eigen::AlignedBox3d grid(
        Eigen::Vector3d::Constant(-0.5),
        model_.grid.cells.cast<double>() - Eigen::Vector3d::Constant(0.5));
    Eigen::AlignedBox3d box;
    for (int c = 0; c < 8; ++c) {
      box.extend(lattice_from_index * grid.corner(static_cast<Eigen::AlignedBox3d::CornerType>(c)));
    }
    const Eigen::Array3d end = sizes.cast<double>().array();
    low = (box.min().array() - 1.0).max(0.0).min(end).floor().matrix().cast<int>();
    high = (box.max().array() + 2.0).max(0.0).min(end).floor().matrix().cast<int>();
  }

  std::uint8_t value(int i, int j, int k) const {
    std::array<std::uint16_t, 256> counts{};
    int solid = 0, levels = 0;
    for (int c = 0; c < samples_.z(); ++c) {
      for (int b = 0; b < samples_.y(); ++b) {
        for (int a = 0; a < samples_.x(); ++a) {
          const Eigen::Vector3d p_lattice(at(i, a, samples_.x()), at(j, b, samples_.y()),
                                          at(k, c, samples_.z()));
          const Eigen::Vector3d p_index = index_from_lattice_ * p_lattice;
          const Cell cell = (p_index.array() + 0.5).floor().matrix().cast<int>();
          if (!model_.solid(cell)) continue;
          const std::uint8_t sample = value_of(model_, cell, content_);
          ++solid;
          ++counts[sample];
          levels += sample;
        }
      }
    }
    if (content_ == VolumeContent::kFills) {
      const int samples = samples_.prod();
      return static_cast<std::uint8_t>((2 * levels + samples) / (2 * samples));  // rounded
    }
    if (solid == 0 || 2 * solid < samples_.prod()) return 0;
    return static_cast<std::uint8_t>(std::ranges::max_element(counts) - counts.begin());
  }

 private:
  /// The middle of part `s` of `n` of a voxel.
  static double at(int voxel, int s, int n) { return voxel - 0.5 + (s + 0.5) / n; }

  const VoxelModel& model_;
  VolumeContent content_;
  Eigen::Affine3d index_from_lattice_;
  Eigen::Vector3i samples_;
};

}  // namespace

void check_volume_name(const std::string& path) {
  const std::string name = lower_case(path);
  if (name.ends_with(".nrrd") || name.ends_with(".mha") || name.ends_with(".nii.gz")) return;
  throw InputError(path, "", "a name of no volume that is written", ".nrrd, .mha or .nii.gz");
}

void write_volume(const std::string& path, const VoxelModel& model, VolumeContent content) {
  InputGeometry scene;
  write_volume_in_file_space(path, model, content, scene);
}

void write_volume_in_file_space(const std::string& path, const VoxelModel& model,
                                VolumeContent content, const InputGeometry& input) {
  check_volume_name(path);
  const Eigen::Affine3d file_from_index = input.file_from_world * world_from_index(model.grid);
  check_holds(path, file_from_index, model.grid.cells);
  ItkMask volume;
  place(file_from_index, model.grid.cells, volume);
  volume.voxels = voxels_of(model, content);
  write_volume_with_itk(path, volume);
}

void write_volume_on_input(const std::string& path, const VoxelModel& model, VolumeContent content,
                           const InputGeometry& input, const InputLimits& limits) {
  check_volume_name(path);
  if (!input.has_lattice()) {
    throw InputError(path, "", "a workpiece from a mesh", "one from a volume, which has a lattice");
  }
  const Eigen::Vector3i n = input.sizes;
  const std::array<std::int64_t, 3> sizes{n.x(), n.y(), n.z()};
  check_holds(path, input.file_from_lattice(), n);
  ItkMask volume;
  place(input.file_from_lattice(), n, volume);
  volume.voxels.assign(checked_voxel_count(path, "sizes", sizes, limits), 0);
  const Resampler resampler(model, content, input);
  Eigen::Vector3i low, high;
  resampler.reach(n, low, high);
  tbb::parallel_for(low.z(), std::max(low.z(), high.z()), [&](int k) {
    for (int j = low.y(); j < high.y(); ++j) {
      const std::size_t row = static_cast<std::size_t>(n.x()) *
                              (static_cast<std::size_t>(j) +
                               static_cast<std::size_t>(n.y()) * static_cast<std::size_t>(k));
      for (int i = low.x(); i < high.x(); ++i) {
        volume.voxels[row + static_cast<std::size_t>(i)] = resampler.value(i, j, k);
      }
    }
  });
  write_volume_with_itk(path, volume);
}

}  // namespace sulcus
