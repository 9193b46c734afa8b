#include "engine/tool/burr.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/tool/burr_mesh.hpp"
#include "engine/tool/burr_profile.hpp"
#include "engine/tool/field_grid.hpp"
#include "engine/tool/mesh_field.hpp"

namespace sulcus {
namespace {

constexpr double kMinSize = 0.1e-3, kMaxSize = 100e-3;  // m, of a mesh along each axis

double signed_volume(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Eigen::Vector3d a = mesh.positions[i].cast<double>(),
                          b = mesh.positions[j].cast<double>(),
                          c = mesh.positions[k].cast<double>();
    volume += a.dot(b.cross(c)) / 6.0;
  }
  return volume;
}

/// The largest radius of a mesh's head.
double rim_radius_of(const TriangleMesh& mesh_tool, double head_length_m) {
  double radius = 0.0;
  for (const Eigen::Vector3f& p : mesh_tool.positions) {
    if (static_cast<double>(p.y()) > head_length_m) continue;
    radius = std::max(radius, std::hypot(static_cast<double>(p.x()), static_cast<double>(p.z())));
  }
  return radius;
}

Burr assemble(const BurrSettings& settings, TriangleMesh mesh_tool, DistanceField field,
              double head_length_m, double rim_radius_m) {
  Burr burr;
  burr.capsule = axial_capsule(mesh_tool);
  // Between vertices, and between samples, the surface may stand out by less than a sample.
  burr.capsule.radius_m += field.spacing_m();
  burr.mesh_tool = std::move(mesh_tool);
  burr.field = std::move(field);
  burr.head_length_m = head_length_m;
  burr.rim_radius_m = rim_radius_m;
  burr.reference_m = settings.reference_m;
  burr.speed_rad_per_s = settings.speed_rad_per_s;
  burr.tangential_ratio = settings.tangential_ratio;
  return burr;
}

}  // namespace

Capsule axial_capsule(const TriangleMesh& mesh_tool) {
  const auto radial2 = [](const Eigen::Vector3d& p) { return p.x() * p.x() + p.z() * p.z(); };
  double radius2 = 0.0;
  for (const Eigen::Vector3f& p : mesh_tool.positions) {
    radius2 = std::max(radius2, radial2(p.cast<double>()));
  }
  // A vertex at height y and radius r is held by a sphere of the capsule's radius R anywhere within
  // sqrt(R^2 - r^2) of y; the segment has to reach each of these intervals.
  double a = std::numeric_limits<double>::infinity(), b = -a;
  for (const Eigen::Vector3f& p : mesh_tool.positions) {
    const double reach = std::sqrt(radius2 - radial2(p.cast<double>()));
    a = std::min(a, static_cast<double>(p.y()) + reach);
    b = std::max(b, static_cast<double>(p.y()) - reach);
  }
  if (a > b) a = b = 0.5 * (a + b);
  return {Eigen::Vector3d(0.0, a, 0.0), Eigen::Vector3d(0.0, b, 0.0), std::sqrt(radius2)};
}

Burr make_burr(const BurrSettings& settings, double voxel_m, std::string_view scene_file,
               const FieldSource& field_source) {
  const BurrProfile profile = make_burr_profile(settings, scene_file);
  const double radius = profile.max_radius_m();
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d(-radius, 0.0, -radius),
                                   Eigen::Vector3d(radius, profile.length_m(), radius));
  const FieldGrid grid =
      plan_field(settings, bounds, profile.head_diameter_m(), voxel_m, scene_file);
  DistanceField field =
      field_source(grid, nullptr, [&] { return field_from_profile(profile, grid); });
  return assemble(settings, revolve(profile), std::move(field), profile.head_length_m(),
                  0.5 * profile.head_diameter_m());
}

Burr make_burr(const BurrSettings& settings, double voxel_m, TriangleMesh mesh_tool,
               std::string_view scene_file, const FieldSource& field_source) {
  check_burr_mesh(mesh_tool, settings.file);
  Eigen::AlignedBox3d bounds;
  for (const Eigen::Vector3f& p : mesh_tool.positions) bounds.extend(p.cast<double>());
  const Eigen::Vector3d size = bounds.sizes();
  if (size.minCoeff() < kMinSize || size.maxCoeff() > kMaxSize) {
    char found[96], expected[96];
    std::snprintf(found, sizeof found, "a burr of %.4g x %.4g x %.4g mm", size.x() / kMillimetre,
                  size.z() / kMillimetre, size.y() / kMillimetre);
    std::snprintf(expected, sizeof expected, "%g to %g mm along each axis (lengths are in mm)",
                  kMinSize / kMillimetre, kMaxSize / kMillimetre);
    throw InputError(settings.file, "mesh", found, expected);
  }
  if (signed_volume(mesh_tool) < 0.0) {
    for (auto& triangle : mesh_tool.triangles) std::swap(triangle[1], triangle[2]);
  }
  const double width = std::min(size.x(), size.z());
  const FieldGrid grid = plan_field(settings, bounds, width, voxel_m, scene_file);
  DistanceField field = field_source(
      grid, &mesh_tool, [&] { return field_from_mesh(mesh_tool, grid, settings.file); });
  const double head_length = std::min(settings.length_m.value_or(size.y()), size.y());
  const double rim_radius = rim_radius_of(mesh_tool, head_length);
  return assemble(settings, std::move(mesh_tool), std::move(field), head_length, rim_radius);
}

}  // namespace sulcus
