#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/core/realtime.hpp"
#include "tools/sulcus_lab/stability/cases/cases.hpp"
#include "tools/sulcus_lab/statistics.hpp"

namespace sulcus::lab {

namespace {

struct Timed {
  std::vector<float> us;
  double contacts = 0.0, evaluations = 0.0;  // means
  std::vector<Pose> tools;
};

/// Steps a rig along a path; the ticks from `from` on are timed.
Timed timed_run(Rig& rig, PathDevice& path, std::size_t from) {
  Timed run;
  for (std::size_t tick = 0; tick < path.ticks(); ++tick) {
    const std::uint64_t begin = thread_cpu_ns();
    const Felt felt = rig.step(path);
    const auto us = static_cast<float>(1e-3 * static_cast<double>(thread_cpu_ns() - begin));
    run.tools.push_back(felt.tool);
    if (tick < from) continue;
    run.us.push_back(us);
    run.contacts += felt.contacts;
    run.evaluations += static_cast<double>(felt.evaluations);
  }
  run.contacts /= static_cast<double>(run.us.size());
  run.evaluations /= static_cast<double>(run.us.size());
  return run;
}

}  // namespace

/// What iterating the contact costs: burrs with some 40 and 2,000 voxels in contact slid over a
/// face at 1 to 20 mm/s, behind the coupling, and beside it the plain tick with the tool put at the
/// same poses. Thread CPU time, and ratios of means in one run.
void coupled_tick(CaseTrial& trial) {
  struct Burr {
    const char* toml;
    double diameter_mm;
  };
  for (const Burr& burr : {Burr{"shape = 'round'\ndiameter_mm = 1.0", 1.0},
                           Burr{"shape = 'fissure'\ndiameter_mm = 1.8\nlength_mm = 3", 1.8}}) {
    const std::string text =
        "tissue = ['enamel']\n[workpiece]\nshape = 'plate'\ncells = [160, 160, 64]\n"
        "plate.thickness_mm = 1.0\n[burr]\n" +
        std::string(burr.toml) + "\nfield = 'auto'\n";
    for (const double speed_mm_per_s : trial.settings<double>({20.0}, {1.0, 5.0, 10.0, 20.0})) {
      const double slide_m = std::min(1.2e-3, 0.4e-3 * speed_mm_per_s);
      // The device 1 N deep.
      const Scene scene = method_scene(ContactMethod::kCoupling, text);
      const double deep_m = 1.0 / scene.coupling->stiffness_N_per_m;
      const Eigen::Vector3d above(-0.6e-3, 0.013e-3, 0.6e-3),
          down(-0.6e-3, 0.013e-3, 0.5e-3 - deep_m);
      std::vector<Pose> poses = path_along({above, down}, 20e-3);
      const std::size_t from = poses.size() + 5;
      const std::vector<Pose> slide =
          path_along({down, down + slide_m * Eigen::Vector3d::UnitX()}, 1e-3 * speed_mm_per_s);
      poses.insert(poses.end(), slide.begin(), slide.end());
      PathDevice path(poses);
      Rig coupled(ContactMethod::kCoupling, scene);
      const Timed iterated = timed_run(coupled, path, from);

      Scene direct = scene;
      direct.coupling.reset();
      Rig plain(ContactMethod::kSmooth, direct);
      PathDevice same(iterated.tools);
      const Timed once = timed_run(plain, same, from);

      const std::string setting = std::to_string(std::lround(iterated.contacts)) + " contacts at " +
                                  std::to_string(static_cast<int>(speed_mm_per_s)) + " mm/s: ";
      const auto add = [&](const char* quantity, double value, const RowLimit& limit = {}) {
        trial.add(setting + quantity, "", value, limit).burr_mm = burr.diameter_mm;
      };
      add("evaluations in a tick", iterated.evaluations);
      add("coupled_us", mean(iterated.us));
      add("plain_us", mean(once.us));
      add("coupled over plain", mean(iterated.us) / mean(once.us), at_most(5.0));
      add("coupled p99_us", quantile(iterated.us, 0.99), at_most(1000.0));
    }
  }
}

}  // namespace sulcus::lab
