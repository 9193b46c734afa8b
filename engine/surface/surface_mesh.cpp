#include "engine/surface/surface_mesh.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/core/parallel.hpp"
#include "engine/surface/surface_nets.hpp"

namespace sulcus {
namespace {

/// Moves each vertex by `step` of the way to the mean of its neighbours, within its cell
/// [Gibson 1998]; once for each of the steps. Those that are where the surface is stay.
void relax(VoxelNet& net, std::span<const float> steps) {
  const bool placed = !net.at_surface.empty();
  if (placed && std::ranges::find(net.at_surface, 0) == net.at_surface.end()) return;
  std::vector<Eigen::Vector3f> sum(net.offsets.size());
  std::vector<float> weight(net.offsets.size());
  for (const float step : steps) {
    std::fill(sum.begin(), sum.end(), Eigen::Vector3f::Zero());
    std::fill(weight.begin(), weight.end(), 0.0f);
    for (const auto& quad : net.quads) {
      for (int i = 0; i < 4; ++i) {
        // The reverse of each directed edge is in another quad: one end here is enough.
        const std::uint32_t a = quad[i];
        const std::uint32_t b = quad[(i + 1) % 4];
        sum[a] += net.offsets[b] + (net.cells[b] - net.cells[a]).cast<float>();
        weight[a] += 1.0f;
      }
    }
    for (std::size_t v = 0; v < net.offsets.size(); ++v) {
      if (placed && net.at_surface[v] != 0) continue;
      Eigen::Vector3f& offset = net.offsets[v];
      offset = ((1.0f - step) * offset + step * (sum[v] / weight[v])).cwiseMax(0.0f).cwiseMin(1.0f);
    }
  }
}

TriangleMesh triangles_of(const VoxelNet& net, const VoxelGrid& grid) {
  TriangleMesh mesh;
  mesh.positions.resize(net.cells.size());
  parallel_for(std::size_t{0}, net.cells.size(), [&](std::size_t v) {
    mesh.positions[v] =
        grid.world_from_index(net.cells[v].cast<double>() + net.offsets[v].cast<double>())
            .cast<float>();
  });
  mesh.triangles.resize(2 * net.quads.size());
  parallel_for(std::size_t{0}, net.quads.size(), [&](std::size_t q) {
    const auto& quad = net.quads[q];
    const auto& p = mesh.positions;
    const auto halves = split_quad(quad, p[quad[0]], p[quad[1]], p[quad[2]], p[quad[3]]);
    std::ranges::copy(halves, mesh.triangles.begin() + static_cast<std::ptrdiff_t>(2 * q));
  });
  return mesh;
}

/// Several nets as one with a single vertex in each cell.
struct SharedNet {
  VoxelNet net;
  std::vector<std::vector<std::uint32_t>> shared;  // vertex of `net`, of each net's vertices
};

SharedNet share(std::span<const VoxelNet> nets) {
  const auto key = [](const Eigen::Vector3i& cell) {  // from -1 on, along each axis
    return static_cast<std::uint64_t>(cell.x() + 1) |
           static_cast<std::uint64_t>(cell.y() + 1) << 20 |
           static_cast<std::uint64_t>(cell.z() + 1) << 40;
  };
  std::vector<std::uint64_t> keys;
  for (const VoxelNet& net : nets) {
    for (const Eigen::Vector3i& cell : net.cells) keys.push_back(key(cell));
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());

  SharedNet all;
  all.net.cells.resize(keys.size());
  all.net.offsets.assign(keys.size(), Eigen::Vector3f::Zero());
  std::vector<float> count(keys.size(), 0.0f);
  const bool placed =
      std::ranges::any_of(nets, [](const auto& n) { return !n.at_surface.empty(); });
  if (placed) all.net.at_surface.resize(keys.size());
  for (const VoxelNet& net : nets) {
    std::vector<std::uint32_t>& shared = all.shared.emplace_back(net.cells.size());
    for (std::size_t v = 0; v < net.cells.size(); ++v) {
      const auto found = std::lower_bound(keys.begin(), keys.end(), key(net.cells[v]));
      shared[v] = static_cast<std::uint32_t>(found - keys.begin());
      all.net.cells[shared[v]] = net.cells[v];
      if (placed) all.net.at_surface[shared[v]] = net.at_surface[v];  // the same of every net
      all.net.offsets[shared[v]] += net.offsets[v];
      count[shared[v]] += 1.0f;
    }
    for (const auto& [a, b, c, d] : net.quads) {
      all.net.quads.push_back({shared[a], shared[b], shared[c], shared[d]});
    }
  }
  for (std::size_t v = 0; v < count.size(); ++v) all.net.offsets[v] /= count[v];
  return all;
}

}  // namespace

TriangleMesh closed_surface(const VoxelModel& model, const ClosedSurfaceSettings& settings) {
  VoxelNet net = voxel_net(model, settings.tissue);
  const std::vector<float> steps(static_cast<std::size_t>(settings.smoothing_passes), 0.5f);
  relax(net, steps);
  return triangles_of(net, model.grid);
}

std::vector<TriangleMesh> tissue_surfaces(const VoxelModel& model, std::size_t tissues,
                                          int smoothing_passes) {
  std::vector<VoxelNet> nets;
  for (std::size_t t = 0; t < tissues; ++t) {
    nets.push_back(voxel_net(model, static_cast<std::uint8_t>(t)));
  }
  SharedNet all = share(nets);
  // Out again after each step in, so that canals keep their volume [Taubin 1995].
  std::vector<float> steps;
  for (int pass = 0; pass < smoothing_passes; ++pass) steps.insert(steps.end(), {0.5f, -0.53f});
  relax(all.net, steps);

  std::vector<TriangleMesh> meshes;
  for (std::size_t t = 0; t < tissues; ++t) {
    for (std::size_t v = 0; v < nets[t].offsets.size(); ++v) {
      nets[t].offsets[v] = all.net.offsets[all.shared[t][v]];
    }
    meshes.push_back(triangles_of(nets[t], model.grid));
    nets[t] = {};
  }
  return meshes;
}

}  // namespace sulcus
