#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "tools/sulcus_lab/laws/law_rig.hpp"
#include "tools/sulcus_lab/laws/laws.hpp"

namespace sulcus::lab {

using Eigen::Matrix3i;
using Eigen::Vector3d;

namespace {

/// Axes exchanged and turned round: the 48 symmetries of a cube, that which changes nothing first.
std::vector<Matrix3i> cube_symmetries() {
  std::vector<Matrix3i> all;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Matrix3i symmetry = Matrix3i::Zero();
      for (int row = 0; row < 3; ++row) {
        symmetry(row, order[static_cast<std::size_t>(row)]) = (signs >> row & 1) != 0 ? -1 : 1;
      }
      all.push_back(symmetry);
    }
  } while (std::ranges::next_permutation(order).found);
  return all;
}

/// Those without a mirror.
std::vector<Matrix3i> cube_rotations() {
  std::vector<Matrix3i> rotations = cube_symmetries();
  std::erase_if(rotations, [](const Matrix3i& s) { return s.cast<double>().determinant() < 0.0; });
  return rotations;
}

/// Every so many of them, and always the first.
std::vector<Matrix3i> every(std::size_t step, const std::vector<Matrix3i>& all) {
  std::vector<Matrix3i> some;
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

/// Where a voxel of a grid that is a cube comes to; in half voxels from its middle all is whole.
Cell cell_under(const Matrix3i& symmetry, const VoxelGrid& grid, const Cell& cell) {
  const Cell last = grid.cells - Cell::Ones();
  return (symmetry * (2 * cell - last) + last) / 2;
}

VoxelModel solid_under(const Matrix3i& symmetry, const VoxelModel& model) {
  VoxelModel turned;
  turned.grid = model.grid;
  put_voxels(
      model, [&](const Cell& c) { return cell_under(symmetry, model.grid, c); }, turned);
  return turned;
}

/// The tool under a symmetry; under one with a mirror the burr's own mirror image in it, which a
/// body of revolution is.
Pose pose_under(const Matrix3i& symmetry, const Pose& pose) {
  const Eigen::Matrix3d s = symmetry.cast<double>();
  Eigen::Matrix3d turned = s * pose.orientation.toRotationMatrix();
  if (s.determinant() < 0.0) turned.col(0) = -turned.col(0);
  return {s * pose.position, Eigen::Quaterniond(turned)};
}

std::vector<Pose> poses_under(const Matrix3i& symmetry, const std::vector<Pose>& poses) {
  std::vector<Pose> turned;
  turned.reserve(poses.size());
  for (const Pose& pose : poses) turned.push_back(pose_under(symmetry, pose));
  return turned;
}

/// Of poses on a shape, off its line and at several depths.
std::vector<Pose> poses_on(const LawShape& shape, int count) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const Vector3d aside = 0.13e-3 * std::sin(2.1 * i + 0.3) * shape.across +
                           0.17e-3 * std::cos(1.7 * i) * shape.along();
    const double depth_m = 0.03e-3 + 0.04e-3 * (i % 4);
    poses.push_back(pose_at_centre(touching_centre(shape, aside) - depth_m * shape.normal));
  }
  return poses;
}

struct Asymmetry {
  double force_N = 0.0;  // the largest difference
  int contacts = 0;
};

Asymmetry asymmetry_of(const Scene& scene, const LawShape& shape, const std::vector<Pose>& poses,
                       const std::vector<Matrix3i>& under) {
  Asymmetry most;
  LawRig straight(scene, shape.model);
  std::vector<ContactResult> straight_on;
  straight_on.reserve(poses.size());
  for (const Pose& pose : poses) straight_on.push_back(straight.step(pose).contact);
  for (const Matrix3i& symmetry : under) {
    LawRig rig(scene, solid_under(symmetry, shape.model));
    const Eigen::Matrix3d back = symmetry.cast<double>().transpose();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const ContactResult on = rig.step(pose_under(symmetry, poses[i])).contact;
      const Vector3d off_N = back * on.wrench.force_N - straight_on[i].wrench.force_N;
      most.force_N = std::max(most.force_N, off_N.norm());
      most.contacts = std::max(most.contacts, std::abs(static_cast<int>(on.contacts) -
                                                       static_cast<int>(straight_on[i].contacts)));
    }
  }
  return most;
}

struct Cut {
  VoxelModel left;
  std::vector<Vector3d> forces_N;
};

Cut cut_along(const Scene& scene, const VoxelModel& solid, const std::vector<Pose>& way) {
  LawRig rig(scene, solid);
  Cut cut;
  for (const Pose& pose : way) cut.forces_N.push_back(rig.step(pose).contact.wrench.force_N);
  cut.left = rig.state().workpiece().solid.model();
  return cut;
}

}  // namespace

/// Solid and tool under the symmetries of the grid, and the force turned back.
void symmetries(LawTrial& trial) {
  const std::vector<Matrix3i> under = every(trial.quick() ? 7 : 1, cube_symmetries());
  for (const std::string& name :
       trial.shapes({"box", "blob"}, {"box", "tilted_box", "blob", "groove", "wall", "molar"})) {
    const LawShape shape = law_shape(name, trial.surface());
    const std::vector<Pose> poses = poses_on(shape, trial.quick() ? 4 : 12);
    for (const std::string& scaling : trial.scalings()) {
      for (const std::string& normals :
           trial.settings<std::string>({"ldm"}, {"ldm", "ldm_fast", "weighted_sum"})) {
        const Scene scene = law_scene(
            {.scaling = scaling, .haptics = "keep_normals = false\nnormals = '" + normals + "'"});
        const Asymmetry most = asymmetry_of(scene, shape, poses, under);
        const LawPlace where{name, scaling, "normals by " + normals};
        trial.add(where, "force_off_N", most.force_N, at_most(1e-5));
        trial.add(where, "contacts_off", most.contacts, at_most(0.0));
      }
    }
  }
}

/// A turning burr drawn along a shape, with both turned: the same voxels go.
void turned_cut(LawTrial& trial) {
  const std::vector<Matrix3i> under = every(trial.quick() ? 7 : 1, cube_rotations());
  for (const std::string& name :
       trial.shapes({"box"}, {"box", "blob", "groove", "wall", "molar"})) {
    const LawShape shape = law_shape(name, trial.surface());
    const Vector3d deep = touching_centre(shape) - 0.15e-3 * shape.normal;
    const std::vector<Vector3d> corners{deep + 0.3e-3 * shape.normal - 0.2e-3 * shape.along(),
                                        deep - 0.2e-3 * shape.along(),
                                        deep + 0.2e-3 * shape.along() - 0.1e-3 * shape.across};
    const std::vector<Pose> way = poses_along(corners, trial.quick() ? 4e-6 : 2e-6);
    for (const std::string& scaling : trial.scalings()) {
      const Scene scene = law_scene({.scaling = scaling,
                                     .burr = "speed_rpm = 300000",
                                     .tables = "[cutting]\n",
                                     .tissues = "'dentine'"});
      const Cut straight = cut_along(scene, shape.model, way);
      const double removed = filled_voxels(shape.model) - filled_voxels(straight.left);
      double voxels = 0.0, force_N = 0.0;
      for (const Matrix3i& turn : under) {
        const Cut cut = cut_along(scene, solid_under(turn, shape.model), poses_under(turn, way));
        const VoxelModel back = solid_under(turn.transpose(), cut.left);
        double others = 0.0;
        for_each_cell(Cell::Zero(), back.grid.cells, [&](const Cell& c) {
          others += std::abs(back.level(c) - straight.left.level(c));
        });
        voxels = std::max(voxels, others / kFullLevel);
        for (std::size_t t = 0; t < way.size(); ++t) {
          const Vector3d turned_N = turn.transpose().cast<double>() * cut.forces_N[t];
          force_N = std::max(force_N, (turned_N - straight.forces_N[t]).norm());
        }
      }
      const LawPlace where{name, scaling, ""};
      trial.add(where, "removed_voxels", removed);
      trial.add(where, "other_voxels_percent", 100.0 * voxels / removed, at_most(0.03));
      trial.add(where, "force_off_N", force_N);
    }
  }
}

}  // namespace sulcus::lab
