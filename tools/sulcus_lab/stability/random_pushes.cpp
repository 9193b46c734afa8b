#include "tools/sulcus_lab/stability/random_pushes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include <Eigen/Geometry>
#include <tbb/parallel_for.h>

#include "engine/core/units.hpp"
#include "engine/normals/coarse_normal.hpp"
#include "engine/scene/trajectory.hpp"
#include "tools/sulcus_lab/stability/rig.hpp"

namespace sulcus::lab {

namespace {

constexpr int kPart = 160;                  // voxels along an edge of what a push is run in
constexpr double kWidest = 50.0 * kDegree;  // off the surface's normal

/// The most that a push may give, to the rounding of its square root.
double largest_force_N(double force_limit_N) { return force_limit_N * (1.0 + 1e-9); }

struct BurrKind {
  const char* name;
  const char* toml;
};
constexpr std::array<BurrKind, 5> kBurrs{
    {{"round 0.5", "shape = 'round'\ndiameter_mm = 0.5"},
     {"round 1.0", "shape = 'round'\ndiameter_mm = 1.0"},
     {"round 2.0", "shape = 'round'\ndiameter_mm = 2.0"},
     {"fissure 1.0", "shape = 'fissure'\ndiameter_mm = 1.0\nlength_mm = 2.5"},
     {"flame 1.0", "shape = 'flame'\ndiameter_mm = 1.0\nlength_mm = 2.5"}}};

/// Numbers of one seed; the same everywhere (the distributions of the library are not).
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : random_(seed) {}
  double between(double a, double b) {
    return a + (b - a) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  std::uint64_t below(std::uint64_t n) { return random_() % n; }
  /// A direction within an angle of another.
  Eigen::Vector3d near(const Eigen::Vector3d& direction, double angle) {
    const double cosine = between(std::cos(angle), 1.0), turn = between(0.0, 6.283185307179586);
    const double sine = std::sqrt(1.0 - cosine * cosine);
    const Eigen::Vector3d across = direction.unitOrthogonal();
    return cosine * direction +
           sine * (std::cos(turn) * across + std::sin(turn) * direction.cross(across));
  }

 private:
  std::mt19937_64 random_;
};

/// A cube of the tooth about a voxel, leaf by leaf; of one tissue.
VoxelModel part_about(const VoxelModel& tooth, const Cell& about) {
  VoxelModel part;
  part.grid.cells.setConstant(kPart);
  part.grid.voxel_m = tooth.grid.voxel_m;
  part.leaves.resize(part.grid.leaf_count());
  const Cell first = (about.array() - kPart / 2).matrix();
  Cell aligned;
  for (int a = 0; a < 3; ++a) aligned[a] = (first[a] >> 3) * 8;
  for (std::uint32_t leaf = 0; leaf < part.grid.leaf_count(); ++leaf) {
    const Cell from = aligned + part.grid.leaf_origin(leaf);
    if (tooth.grid.contains(from)) part.leaves[leaf] = tooth.leaves[tooth.grid.leaf_of(from)];
  }
  return part;
}

/// A surface voxel with a direction out of the solid.
struct Spot {
  Cell voxel;
  Eigen::Vector3d out;
};
Spot place_on(const Workpiece& tooth, Numbers& numbers) {
  const VoxelGrid& grid = tooth.grid();
  for (;;) {
    Cell c;
    for (int a = 0; a < 3; ++a) {
      // Not where the grid cuts the tooth off.
      c[a] = 40 + static_cast<int>(numbers.below(static_cast<std::uint64_t>(grid.cells[a] - 80)));
    }
    // From a random cell along a random axis to the surface.
    const int axis = static_cast<int>(numbers.below(3)), sign = numbers.below(2) ? 1 : -1;
    for (; grid.contains(c) && !tooth.is_surface(c); c[axis] += sign) {
    }
    if (!grid.contains(c) || (c.array() < 40).any() ||
        (c.array() >= grid.cells.array() - 40).any()) {
      continue;
    }
    const Eigen::Vector3d out = coarse_normal(tooth, c).cast<double>();
    if (!out.isZero(0.0)) return {c, out.normalized()};
  }
}

}  // namespace

RandomPush run_random_push(const Workpiece& tooth, std::uint64_t seed) {
  Numbers numbers(seed);
  RandomPush push;
  push.seed = seed;
  push.cutting = seed % 2 == 1;
  for (;;) {
    const Spot place = place_on(tooth, numbers);
    const BurrKind& burr = kBurrs[numbers.below(kBurrs.size())];
    const Eigen::Vector3d into = -numbers.near(place.out, kWidest);
    const Eigen::Vector3d axis = numbers.near(place.out, kWidest);
    push.burr = burr.name;
    push.speed_mm_per_s = std::pow(10.0, numbers.between(0.0, 2.0));
    const std::string text = "tissue = ['enamel']\n[workpiece]\nshape = 'box'\nvoxel_mm = " +
                             std::to_string(tooth.grid().voxel_m * 1e3) + "\n[burr]\n" + burr.toml +
                             "\nfield = 'auto'\n" + (push.cutting ? "[cutting]\n" : "");
    const Scene scene = method_scene(ContactMethod::kCoupling, text);
    const VoxelModel part = part_about(tooth.model(), place.voxel);
    // The place in the part's world: the leaves it was cut along shift it.
    const Cell first = (place.voxel.array() - kPart / 2).matrix();
    Cell in_part;
    for (int a = 0; a < 3; ++a) in_part[a] = place.voxel[a] - (first[a] >> 3) * 8;
    const Eigen::Vector3d touch = part.grid.centre_world(in_part);

    Rig rig(ContactMethod::kCoupling, scene, part);
    const Eigen::Vector3d middle_tool(0.0, 0.5 * rig.head_m(), 0.0);
    const Eigen::Quaterniond turn = orientation_along(axis);
    // The middle of the head comes along the line to the place.
    const double far_m = 1.6e-3;
    const Eigen::Vector3d start = touch - far_m * into - turn * middle_tool;
    const double deep_m =
        far_m + scene.coupling->force_limit_N / scene.coupling->stiffness_N_per_m * 1.2;
    const Eigen::Vector3d along = 0.4e-3 * numbers.near(place.out, 3.14).cross(into).normalized();
    const Eigen::Vector3d deep = start + deep_m * into;
    PathDevice path(path_along({start, deep, deep + along, start + along},
                               1e-3 * push.speed_mm_per_s, 1000.0, axis));
    Eigen::Vector3d last_N = Eigen::Vector3d::Zero();
    int touching = 0;
    for (std::size_t tick = 0; tick < path.ticks(); ++tick) {
      const Felt felt = rig.step(path);
      if (tick == 0 && felt.contacts > 0) break;  // no free start here: another place
      push.finite &= felt.force_N.allFinite() && felt.torque_Nm.allFinite();
      push.force_N = std::max(push.force_N, felt.force_N.norm());
      touching += felt.contacts > 0 ? 1 : 0;
      if (touching > 5) push.step_N = std::max(push.step_N, (felt.force_N - last_N).norm());
      last_N = felt.force_N;
      push.crossed |= rig.is_inside(felt.tool);
      if (!push.finite) break;
    }
    push.touched = touching > 5;
    if (push.touched || !push.finite) return push;
  }
}

std::vector<RandomPush> run_random_pushes(const Workpiece& tooth,
                                          std::span<const std::uint64_t> seeds) {
  std::vector<RandomPush> pushes(seeds.size());
  tbb::parallel_for(std::size_t{0}, seeds.size(),
                    [&](std::size_t i) { pushes[i] = run_random_push(tooth, seeds[i]); });
  return pushes;
}

bool fails(const RandomPush& push, double force_limit_N) {
  return push.crossed || !push.finite || push.force_N > largest_force_N(force_limit_N) ||
         push.step_N > kLargestStep_N;
}

CaseResult random_push_rows(const std::string& tooth, std::span<const RandomPush> pushes,
                            double force_limit_N) {
  CaseResult result;
  for (const bool cutting : {false, true}) {
    double count = 0.0, crossed = 0.0, not_finite = 0.0, force_N = 0.0, step_N = 0.0;
    for (const RandomPush& push : pushes) {
      if (push.cutting != cutting) continue;
      ++count;
      crossed += push.crossed;
      not_finite += !push.finite;
      force_N = std::max(force_N, push.force_N);
      step_N = std::max(step_N, push.step_N);
    }
    StabilityRow row;
    row.case_name = "random_pushes";
    const auto add = [&](const char* quantity, double value, std::optional<double> limit) {
      row.quantity = tooth + (cutting ? ", cutting: " : ": ") + quantity;
      row.value = value;
      row.limit = limit;
      result.rows.push_back(row);
    };
    add("pushes", count, {});
    add("crossed", crossed, 0.0);
    add("not finite", not_finite, 0.0);
    add("force_N", force_N, largest_force_N(force_limit_N));
    add("force_step_N", step_N, kLargestStep_N);
  }
  return result;
}

}  // namespace sulcus::lab
