#include "app/report/page/page_solid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <unordered_set>
#include <utility>

#include "engine/surface/surface_mesh.hpp"

namespace sulcus {

namespace {

// How far from a voxel that changes anything of a surface can look otherwise, voxels: the passes of
// closed_surface, those of the normals, and the cell of a vertex.
constexpr int kReach = 8 + 3 + 2;
// Beyond that, how much of the model is kept to be meshed: as far again, so that the cap over it
// reaches nothing that is shown.
constexpr int kKept = kReach + 2;

Eigen::AlignedBox3i box_of_edits(const VoxelGrid& grid, std::span<const Edit> edits,
                                 std::size_t body, const VoxelSet* also) {
  Eigen::AlignedBox3i box;
  for (const Edit& edit : edits) {
    if (edit.body == body) box.extend(grid.cell_of_linear(edit.voxel));
  }
  if (also) {
    for (const std::uint32_t leaf : also->leaves()) {
      box.extend(grid.leaf_origin(leaf));
      box.extend(Cell(grid.leaf_origin(leaf) + Cell::Constant(kLeafEdge - 1)));
    }
  }
  if (box.isEmpty()) return box;
  const Cell low = box.min() - Cell::Constant(kReach);
  const Cell high = box.max() + Cell::Constant(kReach + 1);
  return {low, high};
}

std::uint32_t leaves_of_edits(const VoxelGrid& grid, std::span<const Edit> edits,
                              std::size_t body) {
  std::unordered_set<std::uint32_t> leaves;
  for (const Edit& edit : edits) {
    if (edit.body == body) leaves.insert(grid.leaf_of(grid.cell_of_linear(edit.voxel)));
  }
  return static_cast<std::uint32_t>(leaves.size());
}

/// Of a model what lies in the leaves about a box: the same grid, so that a vertex that is the same
/// has the same bits.
VoxelModel about_box(const VoxelModel& model, const Eigen::AlignedBox3i& box) {
  VoxelModel about;
  about.grid = model.grid;
  about.leaves.resize(model.leaves.size());
  const Cell low = box.min() - Cell::Constant(kKept), high = box.max() + Cell::Constant(kKept);
  std::vector<LeafLevels> pages;
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    const Cell at = model.grid.leaf_origin(leaf);
    if ((at.array() + kLeafEdge <= low.array()).any() || (at.array() >= high.array()).any()) {
      continue;
    }
    about.leaves[leaf] = model.leaves[leaf];
    if (!model.fills) continue;
    if (const FillLevel* const levels = model.fills->page(leaf)) {
      pages.push_back({.leaf = leaf});
      std::copy_n(levels, pages.back().levels.size(), pages.back().levels.begin());
    }
  }
  if (model.fills) about.fills.emplace(model.grid.leaf_count(), std::move(pages));
  return about;
}

Eigen::Vector3d middle_index(const VoxelGrid& grid, const TriangleMesh& mesh, std::size_t t) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::uint32_t v : mesh.triangles[t]) sum += mesh.positions[v].cast<double>();
  return grid.index_from_world(sum / 3.0);
}

bool in_box(const Eigen::AlignedBox3i& box, const Eigen::Vector3d& p_index) {
  return !box.isEmpty() && (p_index.array() >= box.min().cast<double>().array()).all() &&
         (p_index.array() < box.max().cast<double>().array()).all();
}

PageSurface surface_of(const TriangleMesh& mesh, const std::vector<Eigen::Vector3f>& normals,
                       const std::vector<std::size_t>& triangles) {
  const MeshPart some = part_of(mesh, triangles);
  MeshPart few = simplified(some.mesh);
  PageSurface surface;
  surface.normals.reserve(few.vertex_of.size());
  for (const std::uint32_t v : few.vertex_of) surface.normals.push_back(normals[some.vertex_of[v]]);
  surface.mesh = std::move(few.mesh);
  return surface;
}

/// Label of the voxel under a triangle: the solid one nearest to a point just inside.
std::uint8_t tissue_under(const VoxelModel& model, const Eigen::Vector3d& middle,
                          const Eigen::Vector3d& normal) {
  const Eigen::Vector3d inside = middle - 0.8 * normal;
  const Cell at = inside.array().round().cast<int>();
  if (model.solid(at)) return model.tissue(at);
  double nearest = 1e9;
  std::uint8_t label = 0;
  for_each_cell(at - Cell::Ones(), at + Cell::Constant(2), [&](const Cell& c) {
    const double distance = (c.cast<double>() - inside).squaredNorm();
    if (distance >= nearest || !model.solid(c)) return;
    nearest = distance;
    label = model.tissue(c);
  });
  return label;
}

std::vector<PageSurface> still_parts(const VoxelModel& start, std::size_t tissues,
                                     const Eigen::AlignedBox3i& box) {
  const TriangleMesh mesh = closed_surface(start);
  const std::vector<Eigen::Vector3f> normals = smoothed_normals(mesh);
  std::vector<std::vector<std::size_t>> of_tissue(std::max<std::size_t>(tissues, 1));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector3d middle = middle_index(start.grid, mesh, t);
    if (in_box(box, middle)) continue;
    const Eigen::Vector3d normal = normals[mesh.triangles[t][0]].cast<double>();
    const std::size_t label = tissue_under(start, middle, normal);
    of_tissue[std::min(label, of_tissue.size() - 1)].push_back(t);
  }
  std::vector<PageSurface> parts;
  parts.reserve(of_tissue.size());
  for (const auto& triangles : of_tissue) parts.push_back(surface_of(mesh, normals, triangles));
  return parts;
}

PageSurface moving_part(const VoxelModel& model, const Eigen::AlignedBox3i& box) {
  const TriangleMesh mesh = closed_surface(about_box(model, box));
  const std::vector<Eigen::Vector3f> normals = smoothed_normals(mesh);
  std::vector<std::size_t> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (in_box(box, middle_index(model.grid, mesh, t))) triangles.push_back(t);
  }
  return surface_of(mesh, normals, triangles);
}

}  // namespace

void apply_edits(std::span<const Edit> edits, std::size_t body, VoxelModel& model) {
  for (const Edit& edit : edits) {
    if (edit.body == body) model.set_level(model.grid.cell_of_linear(edit.voxel), edit.level);
  }
}

PageSolid page_solid(const VoxelModel& start, std::size_t tissues, std::span<const Edit> edits,
                     std::size_t body, std::span<const std::size_t> ends, const VoxelSet* also) {
  PageSolid solid;
  solid.box = box_of_edits(start.grid, edits, body, also);
  solid.still = still_parts(start, tissues, solid.box);
  if (solid.box.isEmpty()) return solid;
  VoxelModel model = start;
  if (model.fills) model.fills->reserve(leaves_of_edits(model.grid, edits, body));
  std::size_t made = 0;
  bool changed = true;
  for (const std::size_t end : ends) {
    const auto next = edits.subspan(made, end - made);
    changed |= std::ranges::find(next, body, &Edit::body) != next.end();
    apply_edits(next, body, model);
    made = end;
    if (changed) solid.moving.push_back(moving_part(model, solid.box));
    solid.shown.push_back(solid.moving.size() - 1);
    changed = false;
  }
  return solid;
}

PageSurface page_surface(const VoxelSet& voxels) {
  VoxelModel model;
  model.grid = voxels.grid();
  model.leaves.resize(model.grid.leaf_count());
  for (const std::uint32_t leaf : voxels.leaves()) model.leaves[leaf] = voxels.voxels(leaf);
  const TriangleMesh mesh = closed_surface(model);
  std::vector<std::size_t> all(mesh.triangles.size());
  for (std::size_t t = 0; t < all.size(); ++t) all[t] = t;
  // What a plan's sides are like is known: no steps of voxels.
  return surface_of(mesh, smoothed_normals(mesh, 12), all);
}

}  // namespace sulcus
