#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "tools/sulcus_lab/laws/law_rig.hpp"
#include "tools/sulcus_lab/laws/laws.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

constexpr std::string_view kOfWholeContact[] = {"count", "smooth", "potential"};

/// Force over K of a ball of radius R, D deep in a plane whose every area counts alike, m. On the
/// sphere's points of depth d the plane has the area 2 pi (R - d) dd, so that sum f(d) is 2 pi
/// times the integral of f(d) (R - d):
///   count      the mean of d
///   smooth     sum d^2 / max(sum d, S), S ten voxels of 34.8 um
///   potential  the derivative of 5/9 sum d^4 / (sum d^2 + S0)
double force_over_stiffness_m(std::string_view scaling, double radius, double deep) {
  constexpr double kWhole = 2.0 * std::numbers::pi;
  constexpr double kLeast_m3 = 4.2e-13 / kWhole, kLeast_m4 = 4.6e-18 / kWhole;
  const auto sum = [&](int n) {  // of d^n
    return radius * std::pow(deep, n + 1) / (n + 1) - std::pow(deep, n + 2) / (n + 2);
  };
  if (scaling == "count") return sum(1) / sum(0);
  if (scaling == "smooth") return sum(2) / std::max(sum(1), kLeast_m3);
  const auto by_depth = [&](int n) { return std::pow(deep, n) * (radius - deep); };
  const double weights = sum(2) + kLeast_m4;
  return 5.0 / 9.0 * (by_depth(4) * weights - sum(4) * by_depth(2)) / (weights * weights);
}

/// A half space whose plane goes through the origin.
VoxelModel half_space(double voxel_m, SurfaceKind surface, const Vector3d& up) {
  const double size_m = std::max(2.4e-3, 24.0 * voxel_m);
  return law_voxels(Vector3d::Constant(size_m), voxel_m, surface,
                    {[=](const Vector3d& p) { return up.dot(p); }});
}

}  // namespace

/// The force of a ball in a plane, against the integral over the ball, by voxel size.
void stiffness_and_voxels(LawTrial& trial) {
  struct Plane {
    std::string name;
    Vector3d up;
  };
  const Plane planes[] = {{"flat", Vector3d::UnitZ()},
                          {"plane", Vector3d(0.21, 0.34, 1.0).normalized()},
                          {"steep plane", Vector3d(0.8, 0.5, 1.0).normalized()}};
  for (const Plane& plane : planes) {
    if (!trial.asks_for(plane.name)) continue;
    for (const double voxel_mm : trial.settings<double>({0.1, 0.05}, {0.2, 0.1, 0.05, 0.035})) {
      const VoxelModel solid = half_space(kMillimetre * voxel_mm, trial.surface(), plane.up);
      for (const std::string& scaling : trial.scalings(kOfWholeContact)) {
        const Scene scene = law_scene({.scaling = scaling, .haptics = "keep_normals = false"});
        LawRig rig(scene, solid);
        for (const double deep_m : {0.03e-3, 0.06e-3, 0.1e-3, 0.2e-3}) {
          double force_N = 0.0;
          constexpr int kPlaces = 12;  // of the voxels below it, which it is the mean of
          for (int i = 0; i < kPlaces; ++i) {
            const Vector3d aside =
                kMillimetre * voxel_mm *
                Vector3d(std::fmod(0.618 * i, 1.0), std::fmod(0.414 * i, 1.0), 0);
            const Vector3d centre =
                aside - plane.up.dot(aside) * plane.up + (kLawRadius_m - deep_m) * plane.up;
            const ContactResult contact = rig.step(pose_at_centre(centre, plane.up)).contact;
            force_N += plane.up.dot(contact.wrench.force_N) / kPlaces;
          }
          const double wanted_N = scene.tissues[0].stiffness_N_per_m *
                                  force_over_stiffness_m(scaling, kLawRadius_m, deep_m);
          const LawPlace where{plane.name, scaling,
                               with_number("voxels of %g mm ", voxel_mm) +
                                   with_number("%g mm deep", deep_m / kMillimetre)};
          // The paper's depth is at the voxel's centre, half a voxel in: of that it is only
          // reported.
          const bool held = voxel_mm <= 0.1 && scaling != "count";
          trial.add(where, "stiffness_off_percent", 100.0 * std::abs(force_N / wanted_N - 1.0),
                    held ? at_most(5.0) : RowLimit{});
        }
      }
    }
  }
}

/// A ball in the middle of a V that lies askew in the grid: its force is along the bisector. No
/// face lies along the grid or its diagonals, where voxels do not tell to half a voxel where it is.
void groove_direction(LawTrial& trial) {
  const std::vector<double> leans = trial.settings<double>({22.0}, {0.0, 7.0, 11.0, 22.0});
  const std::vector<double> turns = trial.settings<double>({17.0}, {5.0, 17.0, 33.0});
  for (const double angle_deg : {30.0, 60.0, 90.0}) {
    const std::string name = with_number("groove of %g degrees", angle_deg);
    if (!trial.asks_for(name)) continue;
    for (const std::string& scaling : trial.scalings()) {
      const Scene scene = law_scene({.scaling = scaling, .haptics = "keep_normals = false"});
      double mean_deg = 0.0, worst_deg = 0.0;
      for (const double lean : leans) {
        for (const double turn : turns) {
          const Eigen::Quaterniond askew = rotation_xyz({0.0, lean * kDegree, turn * kDegree});
          const Vector3d up = askew * Vector3d::UnitZ(), across = askew * Vector3d::UnitX(),
                         along = askew * Vector3d::UnitY();
          LawRig rig(scene, law_groove(angle_deg * kDegree, 0.1e-3, up, across, trial.surface()));
          Vector3d sum_N = Vector3d::Zero();
          for (int place = -8; place < 8; ++place) {
            const Pose pose = pose_at_centre(0.031e-3 * (place + 0.3) * along, up);
            const Vector3d force_N = rig.step(pose).contact.wrench.force_N;
            sum_N += force_N;
            worst_deg = std::max(worst_deg,
                                 std::atan2(force_N.cross(up).norm(), force_N.dot(up)) / kDegree);
          }
          mean_deg =
              std::max(mean_deg, std::atan2(sum_N.cross(up).norm(), sum_N.dot(up)) / kDegree);
        }
      }
      trial.add({name, scaling, "mean along it"}, "off_the_bisector_deg", mean_deg, at_most(0.3));
      trial.add({name, scaling, "worst place"}, "off_the_bisector_deg", worst_deg);
    }
  }
}

}  // namespace sulcus::lab
