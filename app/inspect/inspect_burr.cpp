#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "app/inspect/burr_facts.hpp"
#include "app/inspect/inspect.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/cache/load_cache.hpp"
#include "engine/core/units.hpp"
#include "engine/import/load_burr.hpp"
#include "engine/scene/scene_keys.hpp"
#include "engine/tool/burr_profile.hpp"

namespace sulcus {

namespace {

double field_at(const DistanceField& field, const Eigen::Vector3d& p_tool) {
  return static_cast<double>(field.sample(field.field_from_tool(p_tool).cast<float>()));
}

double error_of_generated(const DistanceField& field, const BurrProfile& profile) {
  const FieldGrid& grid = field.grid();
  const double step = 0.5 * grid.spacing_m, near = 4.0 * grid.spacing_m;
  double largest = 0.0;
  const Eigen::Vector3d end =
      grid.tool_from_field((grid.samples - Eigen::Vector3i::Ones()).cast<double>());
  for (double y = grid.origin_tool.y() + 0.5 * step; y < end.y(); y += step) {
    for (double x = 0.5 * step; x < end.x(); x += step) {
      const double exact = profile.distance(x, y);
      if (std::abs(exact) > near) continue;
      const double here = field_at(field, Eigen::Vector3d(x, y, 0.0));
      largest = std::max(largest, std::abs(here - exact));
    }
  }
  return largest;
}

double error_of_mesh(const Burr& burr) {
  double largest = 0.0;
  for (const Eigen::Vector3f& p : burr.mesh_tool.positions) {
    largest = std::max(largest, std::abs(field_at(burr.field, p.cast<double>())));
  }
  return largest;
}

}  // namespace

BurrFacts burr_facts(const Burr& burr, const BurrSettings& settings) {
  BurrFacts facts;
  for (const Eigen::Vector3f& p : burr.mesh_tool.positions) {
    const Eigen::Vector3d q = p.cast<double>();
    facts.length_m = std::max(facts.length_m, q.y());
    if (q.y() > burr.head_length_m) continue;
    facts.diameter_m = std::max(facts.diameter_m, 2.0 * std::hypot(q.x(), q.z()));
  }
  if (settings.shape == BurrShape::kFile) {
    facts.field_error_m = error_of_mesh(burr);
  } else {
    facts.diameter_m = settings.diameter_m;
    facts.field_error_m = error_of_generated(burr.field, make_burr_profile(settings));
  }
  return facts;
}

std::string burr_title(const BurrSettings& settings, const BurrFacts& facts) {
  std::string name = std::filesystem::path(settings.file).filename().string();
  if (settings.shape != BurrShape::kFile) {
    name = find_scene_key("burr", "shape")->words[static_cast<std::size_t>(settings.shape)];
  }
  return name + formatted(", %.3g mm", facts.diameter_m / kMillimetre);
}

namespace {

/// Size, field and error, on lines of their own.
void print_burr(const Burr& burr, const BurrFacts& facts, const BurrSettings& settings) {
  const DistanceField& field = burr.field;
  const Eigen::Vector3i& n = field.samples();
  say("burr             %s\n", burr_title(settings, facts).c_str());
  say("head             %.3f mm wide, %.3f mm long, of %.3f mm\n", facts.diameter_m / kMillimetre,
      burr.head_length_m / kMillimetre, facts.length_m / kMillimetre);
  say("field            %d x %d x %d points, %.3g um apart, %.1f MiB\n", n.x(), n.y(), n.z(),
      field.spacing_m() * 1e6, static_cast<double>(field.memory_bytes()) / kMebibyte);
  say("field's error    %.3g um at most, %s\n", facts.field_error_m * 1e6,
      settings.shape == BurrShape::kFile ? "at the mesh's vertices" : "near the surface");
}

}  // namespace

void show_burr(const Scene& scene, const std::string& picture_png) {
  LoadCache cache = LoadCache::of_user();
  const Burr burr = load_burr(scene, &cache);
  const BurrFacts facts = burr_facts(burr, scene.burr);
  print_burr(burr, facts, scene.burr);
  if (!picture_png.empty() && !draw_burr(burr, facts, scene.burr, picture_png)) {
    throw std::runtime_error(picture_png + ": gnuplot could not draw it");
  }
}

void inspect_burr(const std::string& file_mesh, MeshUnit unit, const std::string& picture_png) {
  Scene scene;
  scene.file = file_mesh;
  scene.burr.shape = BurrShape::kFile;
  scene.burr.file = file_mesh;
  scene.burr.unit = unit;
  show_burr(scene, picture_png);
}

}  // namespace sulcus
