#include <algorithm>
#include <string>
#include <vector>

#include "tools/sulcus_lab/laws/law_rig.hpp"
#include "tools/sulcus_lab/laws/laws.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr int kShift = 16;  // voxels that the second body's grid lies further in x

/// A solid cut apart at x = 0: what is below, in the same grid, and the rest in one that lies
/// further on.
std::vector<VoxelModel> halves_of(const VoxelModel& whole) {
  const int middle = whole.grid.cells.x() / 2;
  std::vector<VoxelModel> halves(2);
  for (const bool second : {false, true}) {
    VoxelModel kept = whole;
    for_each_cell(Cell::Zero(), whole.grid.cells, [&](const Cell& c) {
      if ((c.x() >= middle) != second) kept.set_level(c, 0);
    });
    VoxelModel& half = halves[second ? 1 : 0];
    half.grid = whole.grid;
    put_voxels(
        kept, [&](const Cell& c) -> Cell { return second ? c - Cell(kShift, 0, 0) : c; }, half);
  }
  return halves;
}

Scene with_second_body(Scene scene, double voxel_m) {
  BodySettings body;
  body.name = "half";
  body.world_from_grid.position.x() = kShift * voxel_m;
  body.cuttable = true;
  scene.bodies.push_back(body);
  return scene;
}

double left_voxels(const LawRig& rig) {
  double left = 0.0;
  for (const Body& body : rig.state().bodies) left += filled_voxels(body.solid.model());
  return left;
}

struct SeamForces {
  double most_N = 0.0;      // on the one solid
  double apart_N = 0.0;     // the largest difference
  double sideways_N = 0.0;  // of it, across the seam
};

/// Slid over the seam.
SeamForces forces_over_seam(const std::string& scaling, const LawShape& shape,
                            const std::vector<VoxelModel>& halves, const std::vector<Pose>& way) {
  const Scene scene = law_scene({.scaling = scaling});
  LawRig one(scene, shape.model);
  LawRig two(with_second_body(scene, shape.model.grid.voxel_m), halves);
  SeamForces forces;
  for (const Pose& pose : way) {
    const Vector3d one_N = one.step(pose).contact.wrench.force_N;
    const Vector3d off_N = two.step(pose).contact.wrench.force_N - one_N;
    forces.most_N = std::max(forces.most_N, one_N.norm());
    forces.apart_N = std::max(forces.apart_N, off_N.norm());
    forces.sideways_N = std::max(forces.sideways_N, std::abs(off_N.x()));
  }
  return forces;
}

/// A flat face, which has no place where the seam lies otherwise.
LawShape flat_shape(SurfaceKind surface) {
  return {.model = law_voxels(Vector3d::Constant(2.78e-3), kLawVoxel_m, surface,
                              {[](const Vector3d& p) { return p.z(); }})};
}

}  // namespace

/// One solid, and the same as two bodies that meet at x = 0: slid over the seam, and cut along it.
void two_bodies(LawTrial& trial) {
  for (const std::string& name :
       trial.shapes({"flat"}, {"flat", "plane", "blob", "groove", "ridge", "molar"})) {
    const LawShape shape =
        name == "flat" ? flat_shape(trial.surface()) : law_shape(name, trial.surface());
    const std::vector<VoxelModel> halves = halves_of(shape.model);
    const Vector3d deep = touching_centre(shape) - 0.1e-3 * shape.normal;
    const Vector3d over = 0.6e-3 * Vector3d::UnitX(), up = 0.4e-3 * shape.normal;
    const double step_m = trial.quick() ? 10e-6 : 4e-6;
    const std::vector<Pose> across =
        poses_along(std::vector<Vector3d>{deep - over + up, deep - over, deep + over}, step_m);
    const Vector3d along = 0.3e-3 * shape.along();
    const std::vector<Pose> lengthwise =
        poses_along(std::vector<Vector3d>{deep - along + up, deep - along, deep + along}, step_m);
    for (const std::string& scaling : trial.scalings()) {
      const SeamForces forces = forces_over_seam(scaling, shape, halves, across);
      const LawPlace where{name, scaling, ""};
      trial.add(where, "force_off_percent", 100.0 * forces.apart_N / forces.most_N, at_most(1.0));
      trial.add(where, "sideways_percent", 100.0 * forces.sideways_N / forces.most_N, at_most(1.0));
      const Scene cutting = law_scene({.scaling = scaling,
                                       .burr = "speed_rpm = 150000",
                                       .tables = "[cutting]\n",
                                       .tissues = "'dentine'"});
      LawRig one(cutting, shape.model);
      LawRig two(with_second_body(cutting, shape.model.grid.voxel_m), halves);
      one.steps(lengthwise);
      two.steps(lengthwise);
      const double whole = filled_voxels(shape.model);
      trial.add(where, "removed_off_percent",
                100.0 * std::abs((whole - left_voxels(two)) / (whole - left_voxels(one)) - 1.0),
                at_most(1.0));
    }
  }
}

}  // namespace sulcus::lab
