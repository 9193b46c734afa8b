#include "app/inspect/mesh_facts.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "app/inspect/suggested_run.hpp"
#include "engine/core/units.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus {

namespace {

using Edges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::size_t count_open(const Edges& sorted) {
  return static_cast<std::size_t>(std::ranges::count_if(sorted, [&](const auto& e) {
    return !std::ranges::binary_search(sorted, std::pair(e.second, e.first));
  }));
}

/// Edges of more than two triangles.
std::size_t count_non_manifold(const Edges& edges) {
  Edges sides;
  sides.reserve(edges.size());
  for (const auto& [a, b] : edges) sides.emplace_back(std::min(a, b), std::max(a, b));
  std::ranges::sort(sides);
  std::size_t count = 0;
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    while (end < sides.size() && sides[end] == sides[i]) ++end;
    count += end - i > 2 ? 1 : 0;
  }
  return count;
}

}  // namespace

MeshFacts mesh_facts(const TriangleMesh& mesh) {
  MeshFacts facts;
  Eigen::Vector3d highest = mesh.positions.front().cast<double>();
  for (const Eigen::Vector3f& p : mesh.positions) {
    const Eigen::Vector3d place = p.cast<double>();
    facts.box_file_m.extend(place);
    if (place.z() > highest.z()) highest = place;
  }
  facts.highest_scene_m = facts.scene_from_file(highest);
  Edges edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.positions[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.positions[t[1]].cast<double>();
    const Eigen::Vector3d c = mesh.positions[t[2]].cast<double>();
    facts.volume_m3 += a.dot(b.cross(c)) / 6.0;
    for (std::size_t e = 0; e < 3; ++e) edges.emplace_back(t[e], t[(e + 1) % 3]);
  }
  std::ranges::sort(edges);
  facts.open_edges = count_open(edges);
  facts.non_manifold_edges = count_non_manifold(edges);
  return facts;
}

std::string mesh_command(const std::string& file, MeshUnit unit, const MeshFacts& facts) {
  std::vector<std::string> settings{string_override("workpiece.file", file)};
  if (unit != MeshUnit::kMillimetre) {
    settings.push_back("workpiece.unit=\"" +
                       std::string(kMeshUnitNames[static_cast<std::size_t>(unit)]) + "\"");
  }
  settings.emplace_back("workpiece.rotation_deg=[0, 0, 0]");
  constexpr double kFinest_mm = 0.035;
  add_grid_and_way(facts.box_file_m.sizes() / kMillimetre, kFinest_mm,
                   facts.highest_scene_m / kMillimetre, settings);
  return shell_command("cut_mesh_tooth.toml", settings);
}

}  // namespace sulcus
