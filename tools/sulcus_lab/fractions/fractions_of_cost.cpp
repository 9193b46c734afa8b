#include <memory>
#include <string>
#include <vector>

#include "engine/shapes/build_shape.hpp"
#include "tools/sulcus_lab/fractions/fractions.hpp"
#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/ticks/ticks_measurement.hpp"

namespace sulcus::lab {

namespace {

/// The tooth of sulcus-lab ticks, of 512^3 voxels.
Workpiece molar_with(SurfaceKind surface) {
  Scene scene;
  scene.workpiece.shape = ShapeKind::kMolar;
  scene.workpiece.surface = surface;
  scene.tissues = tick_tissues(1.0);
  return Workpiece(build_shape(scene));
}

}  // namespace

std::vector<FractionRow> fractions_of_memory(const FractionOptions& options) {
  constexpr double kMebibyte = 1048576.0;
  FractionRow row;
  row.quantity = "memory_MiB";
  row.shape = "molar";
  row.setting = "512^3 voxels";
  for (std::size_t s = 0; s < 2; ++s) {
    options.progress("memory: " + std::string(kSurfaceNames[s]));
    row.value[s] = static_cast<double>(molar_with(kBothSurfaces[s]).memory_bytes()) / kMebibyte;
  }
  row.wanted = row.binary() + 12.0;
  return {row};
}

std::vector<FractionRow> fractions_of_ticks(const FractionOptions& options) {
  // Along the central sulcus, as sulcus-lab ticks.
  const TickGround ground{{0.8e-3, -0.28e-3}, {1.2e-3, -0.31e-3}, 8.5e-3};
  // With fractions both methods are one; binary's are measured beside it, each by itself.
  constexpr NormalMethod kMethods[] = {NormalMethod::kLdm, NormalMethod::kLdmFast};
  const auto plan = [&](SurfaceKind surface) {
    TicksPlan all{.contacts = {350, 10000}, .methods = {kMethods[0]}, .ticks = 200, .lead = 100};
    if (surface == SurfaceKind::kBinary) all.methods.push_back(kMethods[1]);
    return all;
  };
  constexpr double kWantedTimes[] = {2.0, 1.2, 2.0};  // binary's: fresh, kept, cutting
  Workpiece teeth[] = {molar_with(SurfaceKind::kBinary), molar_with(SurfaceKind::kFractions)};
  std::vector<std::unique_ptr<TicksGroup>> groups;
  std::vector<TickRun> runs;  // of a number of contacts: binary's by each method, then fractions'
  for (const int contacts : plan(SurfaceKind::kBinary).contacts) {
    for (std::size_t s = 0; s < 2; ++s) {
      groups.push_back(plan_group(teeth[s], nullptr, ground, contacts, plan(kBothSurfaces[s]),
                                  options.progress));
      for (const TickRun& run : groups.back()->runs) runs.push_back(run);
    }
  }
  repeat_runs(runs, options.progress);
  std::vector<FractionRow> rows;
  constexpr std::size_t kCaches = kTickCacheNames.size(), kOfBinary = std::size(kMethods);
  for (std::size_t r = 0; r < runs.size(); r += (kOfBinary + 1) * kCaches) {
    for (std::size_t n = 0; n < kOfBinary * kCaches; ++n) {
      const std::size_t cache = n % kCaches;
      FractionRow& row = rows.emplace_back();
      row.quantity = "tick_us";
      row.shape = with_number("%.0f contacts", runs[r].task.wanted);
      row.setting =
          std::string(kTickCacheNames[cache]) + ", binary by " +
          std::string(kNormalMethodNames[static_cast<std::size_t>(kMethods[n / kCaches])]);
      row.value = {runs[r + n].summary.us_mean,
                   runs[r + kOfBinary * kCaches + cache].summary.us_mean};
      row.wanted = kWantedTimes[cache] * row.binary();
    }
  }
  return rows;
}

}  // namespace sulcus::lab
