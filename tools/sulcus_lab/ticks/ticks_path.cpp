#include "tools/sulcus_lab/ticks/ticks_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

#include "engine/core/error.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/tool/burr_mesh.hpp"
#include "haptics/contact/evaluate_contact.hpp"

namespace sulcus::lab {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kLargestRound = 5e-3, kLargestBall = 16e-3, kSmallest = 0.5e-3;  // diameters, m
constexpr double kKnotStep = 0.1e-3;                                              // m

Burr bare_ball(double diameter_m, double voxel_m) {
  const double r = 0.5 * diameter_m;
  const auto quarter = [&](const Vector2d& start, const Vector2d& end) {
    return ProfilePiece{start, end, Vector2d(0.0, r), r, 1.0};
  };
  const BurrProfile profile({quarter({0.0, 0.0}, {r, r}), quarter({r, r}, {0.0, diameter_m})},
                            diameter_m, diameter_m);
  BurrSettings settings;
  settings.field_samples.reset();
  const Eigen::AlignedBox3d bounds(Vector3d(-r, 0.0, -r), Vector3d(r, diameter_m, r));
  Burr burr;
  burr.mesh_tool = revolve(profile);
  burr.field = field_from_profile(profile, plan_field(settings, bounds, diameter_m, voxel_m));
  burr.capsule = axial_capsule(burr.mesh_tool);
  burr.capsule.radius_m += burr.field.spacing_m();  // as make_burr: the mesh lies within the ball
  burr.head_length_m = diameter_m;
  burr.reference_m = settings.reference_m;
  burr.speed_rad_per_s = settings.speed_rad_per_s;
  burr.tangential_ratio = settings.tangential_ratio;
  return burr;
}

Pose upright(const Vector2d& at, double height_m) {
  return {Vector3d(at.x(), at.y(), height_m), orientation_along(Vector3d::UnitZ())};
}

/// Counts the voxels in contact with one burr.
class Counter {
 public:
  Counter(const Workpiece& workpiece, const Burr& burr, int wanted)
      : workpiece_(workpiece),
        burr_(burr),
        settings_(counting_settings(wanted)),
        scratch_(settings_) {}

  int operator()(const Pose& pose) {
    return static_cast<int>(
        evaluate_contact(workpiece_, {burr_, pose, tissues_, settings_}, scratch_).contacts);
  }

 private:
  const Workpiece& workpiece_;
  const Burr& burr_;
  HapticsSettings settings_;
  ContactScratch scratch_;
  std::vector<TissueSettings> tissues_{256};
};

struct Height {
  double first_m, wanted_m;  // where the tip touches, and where as many are in contact
};

/// Comes down in small steps, since deep down contacts are lost again on the far sides of walls;
/// then halves the last step.
std::optional<Height> find_height(Counter& count, const Vector2d& at, double top_m,
                                  double diameter_m, double voxel_m, int wanted) {
  const double step = std::max(voxel_m, diameter_m / 40.0);
  std::optional<double> first_m;
  for (double z = top_m; z > top_m - diameter_m - 4e-3; z -= step) {
    const int found = count(upright(at, z));
    if (found > 0 && !first_m) first_m = z;
    if (found < wanted) continue;
    double few = z + step, many = z;
    for (int halving = 0; halving < 12; ++halving) {
      const double middle = 0.5 * (few + many);
      (count(upright(at, middle)) < wanted ? few : many) = middle;
    }
    return Height{*first_m, many};
  }
  return std::nullopt;
}

/// Points kTickStep apart along a line and back again, the ends once each.
std::vector<Pose> to_and_fro(const std::vector<Vector3d>& line) {
  std::vector<Vector3d> way;
  double into = 0.0;  // of the next point, from the start of a piece
  for (std::size_t p = 0; p + 1 < line.size(); ++p) {
    const Vector3d piece = line[p + 1] - line[p];
    const double length = piece.norm();
    for (; into < length; into += kTickStep) way.push_back(line[p] + into / length * piece);
    into -= length;
  }
  std::vector<Pose> poses;
  const auto add = [&](const Vector3d& p) {
    poses.push_back({p, orientation_along(Vector3d::UnitZ())});
  };
  for (const Vector3d& p : way) add(p);
  for (std::size_t p = way.size() - 1; p-- > 1;) add(way[p]);
  return poses;
}

std::vector<Pose> shifted(std::vector<Pose> poses, double z_m) {
  for (Pose& pose : poses) pose.position.z() += z_m;
  return poses;
}

double mean_contacts(Counter& count, const std::vector<Pose>& poses, std::size_t stride) {
  double sum = 0.0;
  std::size_t counted = 0;
  for (std::size_t p = 0; p < poses.size(); p += stride, ++counted) sum += count(poses[p]);
  return sum / static_cast<double>(counted);
}

std::optional<TickPath> path_with(const Workpiece& workpiece, const TickGround& ground, int wanted,
                                  double diameter_m) {
  const double voxel_m = workpiece.grid().voxel_m;
  TickPath path;
  path.diameter_m = diameter_m;
  path.burr = round_burr(diameter_m, voxel_m);
  Counter count(workpiece, path.burr, wanted);
  const Vector2d way = ground.to_m - ground.from_m;
  const int pieces = std::max(1, static_cast<int>(std::lround(way.norm() / kKnotStep)));
  std::vector<Vector3d> line;
  for (int k = 0; k <= pieces; ++k) {
    const Vector2d at = ground.from_m + static_cast<double>(k) / pieces * way;
    const auto height = find_height(count, at, ground.top_m, diameter_m, voxel_m, wanted);
    if (!height) return std::nullopt;
    line.push_back({at.x(), at.y(), height->wanted_m});
    path.depth_m += (height->first_m - height->wanted_m) / (pieces + 1);
  }
  const std::vector<Pose> poses = to_and_fro(line);
  double up = voxel_m, down = -voxel_m;
  for (int halving = 0; halving < 8; ++halving) {
    const double middle = 0.5 * (up + down);
    (mean_contacts(count, shifted(poses, middle), 4) < wanted ? up : down) = middle;
  }
  const double shift = 0.5 * (up + down);
  path.poses = shifted(poses, shift);
  path.depth_m -= shift;
  std::vector<int> found;
  for (const Pose& pose : path.poses) found.push_back(count(pose));
  const auto [least, most] = std::minmax_element(found.begin(), found.end());
  path.least = *least;
  path.most = *most;
  path.contacts =
      std::accumulate(found.begin(), found.end(), 0.0) / static_cast<double>(found.size());
  return path;
}

}  // namespace

HapticsSettings counting_settings(int wanted) {
  HapticsSettings settings;
  settings.normals = NormalMethod::kLdmFast;
  settings.scaling = Scaling::kSmooth;
  settings.max_contacts = std::max(settings.max_contacts, 4 * wanted);
  return settings;
}

Burr round_burr(double diameter_m, double voxel_m) {
  if (diameter_m > kLargestRound) return bare_ball(diameter_m, voxel_m);
  BurrSettings settings;
  settings.diameter_m = diameter_m;
  settings.field_samples.reset();
  return make_burr(settings, voxel_m);
}

TickPath find_tick_path(const Workpiece& workpiece, const TickGround& ground, int wanted) {
  const double voxel_m = workpiece.grid().voxel_m;
  const double patch_m = 2.0 * voxel_m * std::sqrt(wanted / std::numbers::pi);
  double diameter_m = std::max(kSmallest, 1.4 * patch_m);
  for (; diameter_m <= kLargestBall; diameter_m *= 1.25) {
    if (auto path = path_with(workpiece, ground, wanted, diameter_m)) return *std::move(path);
  }
  throw InputError("", "--contacts", std::to_string(wanted) + " voxels in contact",
                   "fewer than a burr of 16 mm reaches here");
}

}  // namespace sulcus::lab
