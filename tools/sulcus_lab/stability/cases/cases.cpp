#include "tools/sulcus_lab/stability/cases/cases.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/units.hpp"

namespace sulcus::lab {

namespace {

constexpr StabilityCase kCases[] = {
    {"harness", CaseMethods::kOurs, harness},
    {"thin_wall", CaseMethods::kAll, thin_wall},
    {"thin_wall_stiffness", CaseMethods::kAll, thin_wall_stiffness},
    {"tunnelling", CaseMethods::kAll, tunnelling},
    {"sticking", CaseMethods::kAll, sticking},
    {"buzz", CaseMethods::kAll, buzz_case},
    {"edge_normals", CaseMethods::kAll, edge_normals},
    {"tilted_planes", CaseMethods::kAll, tilted_planes},
    {"opposing_faces", CaseMethods::kAll, opposing_faces},
    {"vanishing_voxels", CaseMethods::kBurrs, vanishing_voxels},
    {"count_steps", CaseMethods::kBurrs, count_steps},
    {"deep_inside", CaseMethods::kAll, deep_inside},
    {"sample_and_hold", CaseMethods::kAll, sample_and_hold},
    {"coupling_mismatch", CaseMethods::kCoupling, coupling_mismatch},
    {"spur", CaseMethods::kAll, spur},
    {"loose_piece", CaseMethods::kBurrs, loose_piece},
    {"wedge", CaseMethods::kAll, wedge},
    {"proxy_thrown", CaseMethods::kAll, proxy_thrown},
    {"overload", CaseMethods::kBurrs, overload},
    {"late_tick", CaseMethods::kAll, late_tick},
    {"cutting_energy", CaseMethods::kBurrs, cutting_energy},
    {"pressed_off_axis", CaseMethods::kOurs, pressed_off_axis},
    {"clinical_pushes", CaseMethods::kOurs, clinical_pushes},
    {"coupled_tick", CaseMethods::kOurs, coupled_tick},
};

bool applies(CaseMethods methods, ContactMethod method) {
  if (methods == CaseMethods::kBurrs) return method != ContactMethod::kSinglePoint;
  return methods == CaseMethods::kAll || method == ContactMethod::kCoupling;
}

}  // namespace

StabilityRow& CaseTrial::add(std::string_view quantity, std::string_view setting, double value,
                             const RowLimit& limit) {
  StabilityRow& row = result_.rows.emplace_back();
  row.case_name = case_name_;
  row.method = method;
  row.quantity = std::string(quantity) + (setting.empty() ? "" : ": ") + std::string(setting);
  row.value = value;
  row.limit = limit.value;
  row.at_least = limit.is_least;
  return row;
}

void CaseTrial::trace(std::string_view label, std::span<const Felt> ticks,
                      const Eigen::Vector3d& along) {
  std::vector<float> force_N, depth_mm;
  for (const Felt& felt : ticks) {
    force_N.push_back(static_cast<float>(along.dot(felt.force_N)));
    depth_mm.push_back(static_cast<float>(-felt.tool.position.z() / kMillimetre));
  }
  trace(label, std::move(force_N), std::move(depth_mm));
}

void CaseTrial::trace(std::string_view label, std::vector<float> force_N,
                      std::vector<float> depth_mm) {
  result_.traces.push_back({.case_name = std::string(case_name_),
                            .label = std::string(label),
                            .method = method,
                            .force_N = std::move(force_N),
                            .depth_mm = std::move(depth_mm)});
}

std::span<const StabilityCase> stability_cases() { return kCases; }

CaseResult run_case(std::string_view name, const CaseOptions& options) {
  const StabilityCase& stability_case = *std::ranges::find(kCases, name, &StabilityCase::name);
  CaseResult result;
  constexpr ContactMethod kOurs[] = {ContactMethod::kCoupling};
  const std::span<const ContactMethod> methods =
      stability_case.methods == CaseMethods::kOurs ? kOurs : options.methods;
  for (const ContactMethod method : methods) {
    if (!applies(stability_case.methods, method)) continue;
    CaseTrial trial(stability_case.name, method, options.brief, result);
    stability_case.run(trial);
  }
  return result;
}

}  // namespace sulcus::lab
