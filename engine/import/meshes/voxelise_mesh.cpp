#include "engine/import/meshes/voxelise_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iomanip>
#include <memory>
#include <sstream>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <tbb/parallel_for.h>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/import/leaf_contents.hpp"
#include "engine/import/meshes/mesh_coverage.hpp"
#include "engine/import/meshes/mesh_shells.hpp"
#include "engine/import/meshes/mesh_size.hpp"
#include "engine/import/meshes/ray_votes.hpp"
#include "engine/import/meshes/winding_number.hpp"
#include "engine/import/placement.hpp"

namespace sulcus {
namespace {

void extend(Eigen::AlignedBox3d& box_file, const TriangleMesh& mesh) {
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) box_file.extend(mesh.positions[v].cast<double>());
  }
}

std::vector<Eigen::Vector3d> positions_in_index(const TriangleMesh& mesh, const VoxelGrid& grid,
                                                const Eigen::Affine3d& world_from_file) {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(mesh.positions.size());
  for (const Eigen::Vector3f& p : mesh.positions) {
    positions.push_back(grid.index_from_world(world_from_file * p.cast<double>()));
  }
  return positions;
}

bool reaches_beyond(const VoxelGrid& grid, const TriangleMesh& mesh,
                    const std::vector<Eigen::Vector3d>& positions_index) {
  constexpr double kSlack = 1e-3;  // voxels; file coordinates are floats
  const Eigen::Array3d low = Eigen::Array3d::Constant(-0.5 - kSlack);
  const Eigen::Array3d high = grid.cells.cast<double>().array() - 0.5 + kSlack;
  return std::ranges::any_of(mesh.triangles, [&](const auto& t) {
    return std::ranges::any_of(t, [&](std::uint32_t v) {
      const Eigen::Array3d p = positions_index[v].array();
      return (p < low).any() || (p > high).any();
    });
  });
}

/// Leaves that a triangle's box overlaps.
std::vector<std::uint8_t> touched_leaves(const VoxelGrid& grid, const TriangleMesh& mesh,
                                         const std::vector<Eigen::Vector3d>& positions_index) {
  std::vector<std::uint8_t> touched(grid.leaf_count(), 0);
  const Eigen::Array3d last = (grid.leaf_dims() - Eigen::Vector3i::Ones()).cast<double>().array();
  for (const auto& t : mesh.triangles) {
    Eigen::AlignedBox3d box;
    for (const std::uint32_t v : t) box.extend(positions_index[v]);
    // A centre on a face of the box belongs to it: half a voxel wider.
    const Eigen::Array3d low = ((box.min().array() - 0.5) / kLeafEdge).floor();
    const Eigen::Array3d high = ((box.max().array() + 0.5) / kLeafEdge).floor();
    if ((high < 0.0).any() || (low > last).any()) continue;
    const Eigen::Array3i from = low.max(0.0).cast<int>(), to = high.min(last).cast<int>();
    for_each_cell(from.matrix(), (to + 1).matrix(),
                  [&](const Cell& at) { touched[grid.leaf_of(at * kLeafEdge)] = 1; });
  }
  return touched;
}

/// Voxels of a leaf on lines that are sound.
LeafBits sound_voxels(const VoxelGrid& grid, const RayVotes& votes, const Cell& origin) {
  LeafBits sound;
  sound.words.fill(~std::uint64_t{0});
  if (votes.all_sound) return sound;
  for (int place = 0; place < 512; ++place) {
    const Cell c = origin + cell_in_leaf(place);
    if (votes.unsound[RayVotes::line(grid, votes.axis, c)] != 0) sound.reset(place);
  }
  return sound;
}

/// Decides what it can of a leaf by the lines; the rest comes back in `open`.
LeafBits count_votes(const VoxelGrid& grid, const std::array<RayVotes, 3>& votes,
                     std::uint32_t leaf, LeafBits& open) {
  const Cell origin = grid.leaf_origin(leaf);
  const std::array<LeafBits, 3> sound = {sound_voxels(grid, votes[0], origin),
                                         sound_voxels(grid, votes[1], origin),
                                         sound_voxels(grid, votes[2], origin)};
  LeafBits solid;
  for (int k = 0; k < kLeafEdge; ++k) {
    std::uint64_t yes = 0, no = 0;
    for (int a = 0; a < 3; ++a) {
      yes |= votes[a].solid[leaf].words[k] & sound[a].words[k];
      no |= ~votes[a].solid[leaf].words[k] & sound[a].words[k];
    }
    const std::uint64_t x = sound[0].words[k], y = sound[1].words[k], z = sound[2].words[k];
    const std::uint64_t two_sound = (x & y) | (y & z) | (z & x);
    solid.words[k] = yes & ~no & two_sound;
    open.words[k] = ~two_sound | (yes & no);
  }
  return solid;
}

class OpenVoxels {
 public:
  OpenVoxels(const VoxelGrid& grid, const TriangleMesh& mesh,
             const std::vector<Eigen::Vector3d>& positions_index, const WindingNumber& winding)
      : grid_(grid), winding_(winding), touched_(touched_leaves(grid, mesh, positions_index)) {}

  /// Adds the open voxels of a leaf that are inside to `solid`.
  void decide(std::uint32_t leaf, const LeafBits& open, LeafBits& solid) const {
    const Cell origin = grid_.leaf_origin(leaf);
    // With no triangle in the leaf the number changes smoothly across it: where its corners and
    // its middle are clear and agree, so does the rest. Worth it from more voxels than that.
    if (touched_[leaf] == 0 && count_voxels(open) > 9) {
      if (const int all = clear_side(origin); all >= 0) {
        if (all == 1) solid |= open;
        return;
      }
    }
    for_each_voxel(open, [&](int place) {
      if (winding(origin + cell_in_leaf(place)) > 0.5) solid.set(place);
    });
  }

 private:
  double winding(const Cell& c) const { return std::abs(winding_.at(c.cast<double>())); }

  /// 1: all inside, 0: all outside, -1: not clear.
  int clear_side(const Cell& origin) const {
    constexpr double kClear = 0.25;
    int inside = 0;
    for (int probe = 0; probe < 9; ++probe) {
      const Cell c = probe < 8 ? Cell(origin + 7 * Cell(probe & 1, probe >> 1 & 1, probe >> 2))
                               : Cell(origin + Cell(4, 4, 4));
      const double w = winding(c);
      if (std::abs(w - 0.5) < kClear) return -1;
      inside += w > 0.5 ? 1 : 0;
    }
    return inside == 9 ? 1 : inside == 0 ? 0 : -1;
  }

  const VoxelGrid& grid_;
  const WindingNumber& winding_;
  std::vector<std::uint8_t> touched_;
};

/// Fills a mesh into the leaves of an empty model; `file` for messages. `centres`: takes the voxels
/// whose centre is inside, where fractions are wanted and others are solid as well.
void fill(const TriangleMesh& mesh, const Eigen::Affine3d& world_from_file, const std::string& file,
          const WorkpieceSettings& settings, VoxelModel& model,
          ZeroedArray<LeafBits>* centres = nullptr) {
  const VoxelGrid& grid = model.grid;
  const std::vector<Eigen::Vector3d> positions_index =
      positions_in_index(mesh, grid, world_from_file);
  check_shells(mesh, grid, positions_index, file);
  const std::array<RayVotes, 3> votes = {cast_rays(grid, 0, positions_index, mesh.triangles),
                                         cast_rays(grid, 1, positions_index, mesh.triangles),
                                         cast_rays(grid, 2, positions_index, mesh.triangles)};
  const WindingNumber winding(positions_index, mesh.triangles);
  const OpenVoxels open_voxels(grid, mesh, positions_index, winding);
  model.leaves.resize(grid.leaf_count());
  model.clipped = reaches_beyond(grid, mesh, positions_index);
  tbb::parallel_for(std::uint32_t{0}, grid.leaf_count(), [&](std::uint32_t leaf) {
    LeafBits open;
    LeafBits solid = count_votes(grid, votes, leaf, open);
    if (open != LeafBits{}) open_voxels.decide(leaf, open, solid);
    if (any(solid)) model.leaves[leaf] = solid;
  });
  if (settings.surface == SurfaceKind::kFractions) {
    if (centres) *centres = model.leaves;
    std::vector<LeafLevels> pages = mesh_coverage(model, positions_index, mesh.triangles, winding);
    for (const LeafLevels& page : pages) model.leaves[page.leaf] = filled_voxels(page.levels);
    model.fills.emplace(grid.leaf_count(), std::move(pages));
  }
  if (model.solid_count() == 0) {
    Eigen::AlignedBox3d box_file;
    extend(box_file, mesh);
    std::ostringstream found;
    found << std::setprecision(3) << "a mesh " << box_file.sizes().maxCoeff() / kMillimetre
          << " mm long with no voxel of the grid inside";
    const std::string doubt = doubt_size(box_file.sizes().maxCoeff(), settings.unit);
    throw InputError(file, "", found.str(),
                     "a closed one, in mm, that reaches into the grid" +
                         (doubt.empty() ? "" : "; it is " + doubt));
  }
}

/// Adds what one mesh encloses to the solid and gives it its label, over those from before.
void add_tissue(const VoxelModel& part, std::uint8_t label, VoxelModel& model, TissueMap& tissues) {
  model.clipped |= part.clipped;
  tbb::parallel_for(std::uint32_t{0}, model.grid.leaf_count(), [&](std::uint32_t leaf) {
    if (!any(part.leaves[leaf])) return;
    LabelBlock labels = labels_of(tissues, leaf);
    for_each_voxel(part.leaves[leaf], [&](int place) { labels[place] = label; });
    model.leaves[leaf] |= part.leaves[leaf];
    tissues.set_block(leaf, labels, model.leaves[leaf]);
  });
}

/// Where the fill of a voxel's neighbours rises to, in index space.
Eigen::Vector3i rise_of_levels(const VoxelModel& model, const Cell& c) {
  Eigen::Vector3i rise = Eigen::Vector3i::Zero();
  for_each_cell(Cell::Constant(-1), Cell::Constant(2),
                [&](const Cell& to) { rise += int{model.level(c + to)} * to; });
  return rise;
}

/// Of a voxel that two parts fill in part: where their surfaces face each other they fill it side
/// by side, else the one within the other.
FillLevel level_of_both(const VoxelModel& a, const VoxelModel& b, const Cell& c) {
  const int one = a.level(c), other = b.level(c);
  if (std::max(one, other) == kFullLevel || std::min(one, other) == 0 ||
      rise_of_levels(a, c).dot(rise_of_levels(b, c)) >= 0) {
    return static_cast<FillLevel>(std::max(one, other));
  }
  return static_cast<FillLevel>(std::min<int>(one + other, kFullLevel));
}

/// The same of fractions. `part_centres`, `centres`: the voxels whose centre is inside.
void add_filled_tissue(const VoxelModel& part, const ZeroedArray<LeafBits>& part_centres,
                       std::uint8_t label, VoxelModel& model, ZeroedArray<LeafBits>& centres,
                       TissueMap& tissues) {
  const VoxelGrid& grid = model.grid;
  // Apart from the model, whose neighbouring leaves are still asked for.
  std::vector<std::unique_ptr<LevelBlock>> joined(grid.leaf_count());
  tbb::parallel_for(std::uint32_t{0}, grid.leaf_count(), [&](std::uint32_t leaf) {
    const bool paged = part.fills->page(leaf) || model.fills->page(leaf);
    if (!paged && !any(part.leaves[leaf])) return;
    LabelBlock labels = labels_of(tissues, leaf);
    for_each_voxel(part_centres[leaf], [&](int place) { labels[place] = label; });
    LeafBits solid = model.leaves[leaf];
    solid |= part.leaves[leaf];
    if (paged) {
      joined[leaf] = std::make_unique<LevelBlock>();
      for_each_voxel(solid, [&](int place) {
        const Cell c = grid.leaf_origin(leaf) + cell_in_leaf(place);
        (*joined[leaf])[place] = level_of_both(model, part, c);
        const bool beneath = part.level(c) >= std::max(model.level(c), FillLevel{1});
        if (beneath && !centres[leaf].has(place)) labels[place] = label;
      });
    }
    tissues.set_block(leaf, labels, solid);
  });
  model.clipped |= part.clipped;
  std::vector<LeafLevels> pages;
  for (std::uint32_t leaf = 0; leaf < grid.leaf_count(); ++leaf) {
    model.leaves[leaf] |= part.leaves[leaf];
    centres[leaf] |= part_centres[leaf];
    if (!joined[leaf]) continue;
    const auto in_part = [](FillLevel level) { return level % kFullLevel != 0; };
    if (std::ranges::any_of(*joined[leaf], in_part)) pages.push_back({leaf, *joined[leaf]});
  }
  model.fills.emplace(grid.leaf_count(), std::move(pages));
}

}  // namespace

VoxelModel voxelise_mesh(const TriangleMesh& mesh, const VoxelGrid& grid,
                         const WorkpieceSettings& settings) {
  Eigen::AlignedBox3d box_file;
  extend(box_file, mesh);
  VoxelModel model;
  model.grid = grid;
  fill(mesh, placement(box_file.center(), settings), settings.file, settings, model);
  return model;
}

Eigen::Affine3d world_from_surfaces(std::span<const TissueSurface> surfaces,
                                    const WorkpieceSettings& settings) {
  Eigen::AlignedBox3d box_file;
  for (const TissueSurface& surface : surfaces) extend(box_file, surface.mesh);
  return placement(box_file.center(), settings);
}

VoxelModel voxelise_surfaces(std::span<const TissueSurface> surfaces, const VoxelGrid& grid,
                             const WorkpieceSettings& settings) {
  if (surfaces.size() == 1) return voxelise_mesh(surfaces.front().mesh, grid, settings);
  const Eigen::Affine3d world_from_file = world_from_surfaces(surfaces, settings);
  VoxelModel model;
  model.grid = grid;
  model.leaves.resize(grid.leaf_count());
  ZeroedArray<LeafBits> centres;
  if (settings.surface == SurfaceKind::kFractions) {
    model.fills.emplace(grid.leaf_count(), std::vector<LeafLevels>{});
    centres.resize(grid.leaf_count());
  }
  const auto tissues = std::make_shared<TissueMap>(grid.leaf_count());
  for (const TissueSurface& surface : surfaces) {
    VoxelModel part;
    part.grid = grid;
    ZeroedArray<LeafBits> part_centres;
    fill(surface.mesh, world_from_file, surface.file, settings, part, &part_centres);
    if (model.fills) {
      add_filled_tissue(part, part_centres, surface.label, model, centres, *tissues);
    } else {
      add_tissue(part, surface.label, model, *tissues);
    }
  }
  model.tissues = tissues;
  return model;
}

}  // namespace sulcus
