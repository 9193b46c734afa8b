#include "app/inspect/volume_facts.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "app/inspect/suggested_run.hpp"
#include "engine/core/units.hpp"
#include "engine/import/meshes/solid_components.hpp"
#include "engine/import/volumes/grey_fills.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus {

namespace {

SolidFacts solid_facts(const MedicalVolume& volume, const SolidComponents& components, bool mask) {
  const std::uint32_t largest = components.largest();
  const Eigen::Matrix3d file_from_index = volume.direction * volume.spacing_m.asDiagonal();
  SolidFacts facts;
  facts.parts = components.voxels.size();
  int top_length = 0;  // of the run that the highest place is the middle of
  for (const SolidRun& run : components.runs) {
    if (!mask && run.component != largest) continue;
    facts.voxels += static_cast<std::uint64_t>(run.end - run.begin);
    for (const int i : {run.begin, run.end - 1}) {
      facts.box_index.extend(Eigen::Vector3i(i, run.j, run.k));
      facts.box_file_m.extend(file_from_index * Eigen::Vector3d(i, run.j, run.k));
    }
    const Eigen::Vector3d middle_file =
        file_from_index * Eigen::Vector3d(0.5 * (run.begin + run.end - 1), run.j, run.k);
    const double rise = middle_file.z() - facts.top_file_m.z();
    constexpr double kLevel = 1e-9;
    if (top_length == 0 || rise > kLevel || (rise > -kLevel && run.end - run.begin > top_length)) {
      top_length = run.end - run.begin;
      facts.top_file_m = middle_file;
    }
  }
  const Eigen::Vector3d around = file_from_index.cwiseAbs().rowwise().sum() * 0.5;
  facts.box_file_m = {facts.box_file_m.min() - around, facts.box_file_m.max() + around};
  return facts;
}

/// A tissue for each value of a label map, as TOML; empty of a mask, which has one alone.
std::string tissues_of(const std::vector<LabelCount>& labels) {
  std::string tissues;
  int count = 0;
  for (const LabelCount& label : labels) {
    if (label.value <= 0) continue;
    const std::string value = std::to_string(label.value);
    tissues += (++count > 1 ? ", {name = \"label_" : "{name = \"label_") + value +
               "\", label = " + value + "}";
  }
  return count > 1 ? tissues : "";
}

}  // namespace

double voxel_volume_mm3(const MedicalVolume& volume) {
  return (volume.spacing_m / kMillimetre).prod() * std::abs(volume.direction.determinant());
}

VolumeFacts volume_facts(const MedicalVolume& volume) {
  VolumeFacts facts;
  const int sizes[3] = {volume.sizes.x(), volume.sizes.y(), volume.sizes.z()};
  facts.labels = label_counts(volume.values, sizes);
  const bool mask = !facts.labels.empty();
  if (!mask) {
    facts.histogram = grey_histogram(volume.values);
    const std::vector<double> two = otsu_thresholds(facts.histogram, 1);
    facts.three_classes = otsu_thresholds(facts.histogram, 2);
    if (!two.empty()) facts.two_classes = facts.solid_above = two.front();
    if (has_three_classes(facts.histogram, two, facts.three_classes)) {
      facts.solid_above = facts.three_classes.front();
      facts.enamel_above = facts.three_classes.back();
    }
    if (!facts.solid_above) return facts;
    facts.ramp = grey_ramp(volume.values, volume.sizes, static_cast<float>(*facts.solid_above));
  }
  const float level = mask ? 0.0f : static_cast<float>(*facts.solid_above);
  const SolidComponents components = find_components(volume.values, volume.sizes, level, mask);
  if (!components.runs.empty()) facts.solid = solid_facts(volume, components, mask);
  return facts;
}

std::string cutting_command(const MedicalVolume& volume, const VolumeFacts& facts,
                            SpacingFrom spacing) {
  if (!facts.solid) return {};
  const Eigen::AlignedBox3d& box = facts.solid->box_file_m;
  const Eigen::Vector3d size_mm = box.sizes() / kMillimetre;
  // As fine as the file tells apart.
  constexpr double kFine_mm = 0.05;
  const double finest_mm = std::min(kFine_mm, volume.spacing_m.minCoeff() / kMillimetre / 3.0);
  const Eigen::Vector3d tip_mm = (facts.solid->top_file_m - box.center()) / kMillimetre;

  std::vector<std::string> settings{string_override("workpiece.file", volume.file)};
  if (spacing == SpacingFrom::kUser) {
    settings.push_back("workpiece.spacing_mm=" + short_triple(volume.spacing_m / kMillimetre));
  }
  if (facts.solid_above) {
    settings.push_back("workpiece.solid_above=" + short_number(*facts.solid_above));
    // The scene has enamel and dentine; where three classes do not tell them apart all is dentine.
    settings.push_back("tissue.enamel.above=" +
                       short_number(facts.enamel_above.value_or(
                           facts.histogram.edge(facts.histogram.counts.size() + 1))));
    settings.emplace_back("workpiece.rotation_deg=[0, 0, 0]");
  } else {
    if (const std::string tissues = tissues_of(facts.labels); !tissues.empty()) {
      settings.push_back("tissue=[" + tissues + "]");
    }
    settings.emplace_back("cutting={}");
    settings.emplace_back("record={}");
  }
  add_grid_and_way(size_mm, finest_mm, tip_mm, settings);
  // A mask has no grey values, which the other scene sorts its tissues by.
  return shell_command(facts.solid_above ? "cut_ct_tooth.toml" : "minimal.toml", settings);
}

}  // namespace sulcus
