#include "engine/import/meshes/mesh_shells.hpp"

#include <algorithm>
#include <cmath>
#include <compare>
#include <iomanip>
#include <numeric>
#include <span>
#include <sstream>

#include <Eigen/Geometry>
#include <tbb/parallel_sort.h>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/import/meshes/line_crossings.hpp"

namespace sulcus {
namespace {

constexpr double kNegligible = 0.01;  // of a shell's voxels
constexpr auto kUnnumbered = ~std::uint32_t{0};

/// How a shell stands to the others, in voxels.
struct ShellVoxels {
  std::size_t all = 0;
  std::size_t against = 0;     // within others that are turned against it, taken together
  std::uint32_t opponent = 0;  // one of those
};

class ShellCounter {
 public:
  ShellCounter(const TriangleMesh& mesh, const MeshShells& shells, const VoxelGrid& grid,
               const std::vector<Eigen::Vector3d>& positions_index)
      : shells_(shells),
        grid_(grid),
        crossings_(grid, kAxis, positions_index, mesh.triangles),
        winding_(shells.count, 0) {}

  /// Of all shells but those left out, on the lines that leave every shell as often as they enter
  /// it: beside a hole nothing is known of the others either.
  std::vector<ShellVoxels> count(const std::vector<bool>& left_out) {
    std::vector<ShellVoxels> voxels(shells_.count);
    for (int c = 0; c < grid_.cells[(kAxis + 2) % 3]; ++c) {
      for (int b = 0; b < grid_.cells[(kAxis + 1) % 3]; ++b) {
        count_line(crossings_.of(b, c), left_out, voxels);
      }
    }
    return voxels;
  }

 private:
  static constexpr int kAxis = 2;

  void count_line(std::span<const LineCrossing> line, const std::vector<bool>& left_out,
                  std::vector<ShellVoxels>& voxels) {
    if (line.empty()) return;
    for (const LineCrossing& x : line) winding_[shell(x)] += x.step;
    bool sound = true;
    for (const LineCrossing& x : line) sound = sound && winding_[shell(x)] == 0;
    if (!sound) {
      for (const LineCrossing& x : line) winding_[shell(x)] = 0;
      return;
    }
    held_.clear();
    int total = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      const std::uint32_t s = shell(line[i]);
      if (!left_out[s]) {
        total += line[i].step;
        step_over(s, line[i].step);
      }
      const int end = i + 1 < line.size() ? line[i + 1].first : line[i].first;
      count_voxels(static_cast<std::size_t>(end - line[i].first), total, voxels);
    }
  }

  void step_over(std::uint32_t s, int step) {
    winding_[s] += step;
    const auto place = std::ranges::find(held_, s);
    if (winding_[s] == 0) {
      held_.erase(place);
    } else if (place == held_.end()) {
      held_.push_back(s);
    }
  }

  void count_voxels(std::size_t more, int total, std::vector<ShellVoxels>& voxels) const {
    for (const std::uint32_t s : held_) {
      voxels[s].all += more;
      const int rest = total - winding_[s];
      if ((winding_[s] > 0 ? rest : -rest) >= 0) continue;
      voxels[s].against += more;
      voxels[s].opponent = *std::ranges::find_if(
          held_, [&](std::uint32_t o) { return (winding_[o] > 0) != (winding_[s] > 0); });
    }
  }

  std::uint32_t shell(const LineCrossing& x) const { return shells_.of_triangle[x.triangle]; }

  const MeshShells& shells_;
  const VoxelGrid& grid_;
  LineCrossings crossings_;
  std::vector<int> winding_;         // of each shell, along a line
  std::vector<std::uint32_t> held_;  // shells that the line is within
};

}  // namespace

MeshShells find_shells(const TriangleMesh& mesh) {
  struct Side {  // of a triangle
    std::uint32_t low, high, triangle;
    auto operator<=>(const Side&) const = default;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t e = 0; e < 3; ++e) {
      const auto [low, high] = std::minmax(mesh.triangles[t][e], mesh.triangles[t][(e + 1) % 3]);
      sides.push_back({low, high, t});
    }
  }
  tbb::parallel_sort(sides.begin(), sides.end());
  std::vector<std::uint32_t> parent(mesh.triangles.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  for (std::size_t i = 1; i < sides.size(); ++i) {
    if (sides[i].low != sides[i - 1].low || sides[i].high != sides[i - 1].high) continue;
    parent[root(sides[i].triangle)] = root(sides[i - 1].triangle);
  }
  MeshShells shells;
  std::vector<std::uint32_t> number(mesh.triangles.size(), kUnnumbered);
  shells.of_triangle.reserve(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    std::uint32_t& shell = number[root(t)];
    if (shell == kUnnumbered) shell = static_cast<std::uint32_t>(shells.count++);
    shells.of_triangle.push_back(shell);
  }
  return shells;
}

std::optional<ShellConflict> find_shell_conflict(
    const TriangleMesh& mesh, const MeshShells& shells, const VoxelGrid& grid,
    const std::vector<Eigen::Vector3d>& positions_index) {
  if (shells.count < 2) return std::nullopt;
  ShellCounter counter(mesh, shells, grid, positions_index);
  std::vector<bool> cavity(shells.count, false);
  const std::vector<ShellVoxels> among_all = counter.count(cavity);
  if (std::ranges::none_of(among_all, [](const auto& v) { return v.against > 0; })) {
    return std::nullopt;
  }
  for (std::size_t s = 0; s < shells.count; ++s) {
    const double out = static_cast<double>(among_all[s].all - among_all[s].against);
    cavity[s] = out <= kNegligible * static_cast<double>(among_all[s].all);
  }
  const std::vector<ShellVoxels> among_solids = counter.count(cavity);
  std::optional<ShellConflict> worst;
  for (std::uint32_t s = 0; s < shells.count; ++s) {
    const ShellVoxels& v = among_solids[s];
    if (static_cast<double>(v.against) <= kNegligible * static_cast<double>(v.all)) continue;
    if (worst && worst->overlap >= v.against) continue;
    const std::size_t other = among_solids[v.opponent].all;
    const bool smaller = v.all < other || (v.all == other && s > v.opponent);
    worst = ShellConflict{smaller ? s : v.opponent, smaller ? v.opponent : s, v.against};
  }
  return worst;
}

std::string describe(const ShellConflict& conflict, const TriangleMesh& mesh,
                     const MeshShells& shells, double voxel_m) {
  Eigen::AlignedBox3f box;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (shells.of_triangle[t] != conflict.inside_out) continue;
    for (const std::uint32_t v : mesh.triangles[t]) box.extend(mesh.positions[v]);
  }
  const Eigen::Vector3d middle_mm = box.center().cast<double>() / kMillimetre;
  const double overlap_mm3 =
      static_cast<double>(conflict.overlap) * std::pow(voxel_m / kMillimetre, 3.0);
  std::ostringstream text;
  text << std::setprecision(4) << "shell " << conflict.inside_out + 1 << " of " << shells.count
       << ", about (" << middle_mm.x() << ", " << middle_mm.y() << ", " << middle_mm.z()
       << ") mm, turned against shell " << conflict.other + 1
       << " and half over it: " << overlap_mm3 << " mm3 of both would be a hole";
  return text.str();
}

void check_shells(const TriangleMesh& mesh, const VoxelGrid& grid,
                  const std::vector<Eigen::Vector3d>& positions_index, const std::string& file) {
  const MeshShells shells = find_shells(mesh);
  const auto conflict = find_shell_conflict(mesh, shells, grid, positions_index);
  if (!conflict) return;
  throw InputError(file, "", describe(*conflict, mesh, shells, grid.voxel_m),
                   "shells turned alike, or a cavity wholly within another: turn its faces round "
                   "in a mesh editor");
}

MeshLattice lattice_about(const TriangleMesh& mesh) {
  constexpr double kAlong = 100.0;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& p : mesh.positions) box.extend(p.cast<double>());
  MeshLattice lattice;
  lattice.grid.voxel_m = box.sizes().maxCoeff() / kAlong;
  const Eigen::Vector3i leaves =
      (((box.sizes() / lattice.grid.voxel_m).array() + 2.0) / kLeafEdge).ceil().cast<int>();
  lattice.grid.cells = leaves * kLeafEdge;
  lattice.positions_index.reserve(mesh.positions.size());
  for (const Eigen::Vector3f& p : mesh.positions) {
    lattice.positions_index.push_back(
        lattice.grid.index_from_world(p.cast<double>() - box.center()));
  }
  return lattice;
}

}  // namespace sulcus
