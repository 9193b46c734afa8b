#include "tools/sulcus_lab/laws/law_rig.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "engine/scene/scene_file.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

std::vector<Workpiece> as_workpieces(std::vector<VoxelModel> solids) {
  std::vector<Workpiece> workpieces;
  workpieces.reserve(solids.size());
  for (VoxelModel& solid : solids) workpieces.emplace_back(std::move(solid));
  return workpieces;
}

/// `field = "auto"` goes by the voxels, and some settings by the surface.
Scene with_voxels(Scene scene, const VoxelModel& solid) {
  scene.workpiece.voxel_m = solid.grid.voxel_m;
  scene.workpiece.cells = solid.grid.cells;
  scene.workpiece.surface = solid.fills ? SurfaceKind::kFractions : SurfaceKind::kBinary;
  return scene;
}

/// A generated burr. Its field takes longer to make than most runs take: that of an earlier one
/// with the same shape and grid is taken again. For one thread.
Burr burr_of(const Scene& scene) {
  struct MadeField {
    BurrShape shape;
    double diameter_m;
    std::optional<double> length_m;
    DistanceField field;
  };
  static std::vector<MadeField> made;
  const BurrSettings& burr = scene.burr;
  const auto source = [&](const FieldGrid& grid, const TriangleMesh*, const auto& make) {
    for (const MadeField& m : made) {
      if (m.shape == burr.shape && m.diameter_m == burr.diameter_m && m.length_m == burr.length_m &&
          m.field.grid().samples == grid.samples &&
          m.field.grid().origin_tool == grid.origin_tool && m.field.spacing_m() == grid.spacing_m) {
        return m.field;
      }
    }
    made.push_back({burr.shape, burr.diameter_m, burr.length_m, make()});
    return made.back().field;
  };
  return make_burr(burr, scene.workpiece.voxel_m, scene.file, source);
}

}  // namespace

Pose pose_at_centre(const Vector3d& centre_m, const Vector3d& axis) {
  return {centre_m - kLawRadius_m * axis, orientation_along(axis)};
}

std::vector<Pose> poses_along(std::span<const Vector3d> corners_m, double step_m) {
  std::vector<Pose> poses{pose_at_centre(corners_m.front())};
  for (std::size_t c = 1; c < corners_m.size(); ++c) {
    const Vector3d& from = corners_m[c - 1];
    const Vector3d way = corners_m[c] - from;
    const int steps = std::max(1, static_cast<int>(std::ceil(way.norm() / step_m - 1e-9)));
    for (int s = 1; s <= steps; ++s) {
      poses.push_back(pose_at_centre(from + way * (static_cast<double>(s) / steps)));
    }
  }
  return poses;
}

std::vector<Vector3d> circle_over(const LawShape& shape, double depth_m, double radius_m,
                                  double step_m, bool back) {
  const Vector3d middle = touching_centre(shape) + (radius_m - depth_m) * shape.normal;
  const int steps = static_cast<int>(std::ceil(2.0 * std::numbers::pi * radius_m / step_m));
  std::vector<Vector3d> circle;
  circle.reserve(static_cast<std::size_t>(steps));
  for (int s = 0; s < steps; ++s) {
    const double angle = (back ? -2.0 : 2.0) * std::numbers::pi * s / steps;
    circle.push_back(middle +
                     radius_m * (std::cos(angle) * shape.normal + std::sin(angle) * shape.across));
  }
  return circle;
}

Scene law_scene(const LawSceneSettings& settings) {
  const std::string text =
      "tissue = [" + std::string(settings.tissues) +
      "]\n[workpiece]\nshape = 'box'\n[burr]\nshape = 'round'\ndiameter_mm = 1\nfield = 'auto'\n" +
      std::string(settings.burr) +
      "\n[trajectory]\npoints_mm = [[0, 0, 100]]\n[haptics]\nscaling = '" +
      std::string(settings.scaling) + "'\n" + std::string(settings.haptics) + "\n" +
      (settings.coupling ? "[coupling]\n" : "") + std::string(settings.tables);
  Scene scene = parse_scene(text, "laws");
  for (TissueSettings& tissue : scene.tissues) {
    tissue.stiffness_N_per_m =
        (settings.scaling == "none" ? 0.3e3 : 30e3) * (settings.coupling ? 10.0 : 1.0);
  }
  return scene;
}

LawRig::LawRig(const Scene& scene, std::vector<VoxelModel> solids)
    : scene_(with_voxels(scene, solids.front())),
      burr_(burr_of(scene_)),
      state_(initial_state(scene_, as_workpieces(std::move(solids)))),
      scratch_(scene_),
      context_{scene_, burr_} {}

TickResult LawRig::step(const Pose& pose) {
  PutDevice device;
  device.put = pose;
  return step(device);
}

TickResult LawRig::steps(std::span<const Pose> poses) {
  TickResult last;
  for (const Pose& pose : poses) last = step(pose);
  return last;
}

}  // namespace sulcus::lab
