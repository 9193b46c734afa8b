#include "haptics/contact/contact_force.hpp"

#include <algorithm>
#include <cmath>

#include "haptics/contact/contact_kernels.hpp"
#include "haptics/contact/potential.hpp"

namespace sulcus {

namespace {

constexpr float kFadeBelow = 0.2f;     // cosine between the normal and the tool's
constexpr double kFullWeights = 10.0;  // W0: sum of weights from which the stiffness is K
constexpr double kFewContacts = 10.0;  // up to so many McNeely's are not divided
constexpr float kFrictionRegularisationSpeed = 10e-3f;  // v0, m/s

void put(const Eigen::Vector3d& v, float (&to)[3]) {
  for (int a = 0; a < 3; ++a) to[a] = static_cast<float>(v[a]);
}

Wrench wrench_of(const double (&sums)[6]) {
  return {Eigen::Vector3d(sums[0], sums[1], sums[2]), Eigen::Vector3d(sums[3], sums[4], sums[5])};
}

/// What a tissue's stiffness is divided by.
double divisor_of(Scaling scaling, const MeasureSums& all) noexcept {
  switch (scaling) {
    case Scaling::kNone:
      break;
    case Scaling::kCount:
      return std::max(1.0, static_cast<double>(all.counted));
    case Scaling::kMcNeely:
      return std::max(1.0, all.counted / kFewContacts);
    case Scaling::kSmooth:
      return std::max(kFullWeights, all.weights);
    case Scaling::kPotential:
      return potential::kLeastSum + all.weights;
  }
  return 1.0;
}

}  // namespace

double contact_reach_m(const Workpiece& workpiece, Scaling scaling, Outputs outputs) noexcept {
  const double voxel_m = workpiece.grid().voxel_m;
  if (scaling == Scaling::kPotential) return voxel_m;
  // A voxel with fractions may have its centre outside of its surface.
  if (scaling != Scaling::kSmooth) return workpiece.has_fills() ? voxel_m : 0.0;
  return (outputs == Outputs::kCoupling ? 2.0 : 1.0) * voxel_m;
}

ContactForce::ContactForce(const Workpiece& workpiece, const ContactQuery& query) noexcept
    : query_(query),
      frame_(workpiece.grid(), query.burr.field, query.world_from_tool, query.burr.reference_m) {
  const Scaling scaling = query.settings.scaling;
  settings_.weighs_depth = scaling == Scaling::kSmooth;
  settings_.at_surface = settings_.weighs_depth || workpiece.has_fills();
  settings_.fade_below = kFadeBelow;
  if (settings_.weighs_depth && query.outputs == Outputs::kCoupling) {
    settings_.spread_reach_m =
        static_cast<float>(contact_reach_m(workpiece, scaling, query.outputs));
  }
  if (scaling != Scaling::kPotential) return;
  settings_.potential = true;
  for (std::size_t t = 0; t < query.tissues.size(); ++t) {
    stiffness_N_per_m_[t] = static_cast<float>(query.tissues[t].stiffness_N_per_m);
  }
  settings_.stiffness_N_per_m = stiffness_N_per_m_.data();
  sum_of_weight_ = std::pow(workpiece.grid().voxel_m, 2 + potential::kDepthPower);
}

void ContactForce::begin() noexcept {
  measured_ = 0;
  lanes_ = {};
}

void ContactForce::measure_until(ContactScratch& scratch, std::size_t end) noexcept {
  ContactArrays arrays = arrays_of(scratch.contacts, measured_);
  arrays.size = end - measured_;
  contact_kernels().measure(frame_, settings_, arrays, arrays_of(scratch.block, measured_), lanes_);
  measured_ = end;
}

void ContactForce::measure(ContactScratch& scratch) noexcept {
  measure_until(scratch, scratch.contacts.size() / Contacts::kGroup * Contacts::kGroup);
  scratch.block.release(measured_);
}

MeasureSums ContactForce::measured(ContactScratch& scratch) noexcept {
  if (scratch.contacts.empty()) return {};
  measure_until(scratch, scratch.contacts.size());
  MeasureSums sums = sums_of(lanes_);
  sums.weights *= sum_of_weight_;
  sums.energy *= sum_of_weight_;
  return sums;
}

ForceTerms ContactForce::terms_of(const MeasureSums& all) const noexcept {
  ForceTerms terms;
  if (const Twist* const twist = query_.twist) {
    const Pose& tool = query_.world_from_tool;
    const Eigen::Vector3d axis_world = tool.direction(Eigen::Vector3d::UnitY());
    terms.cutting = true;
    put(query_.burr.reference_m * axis_world, terms.axis_m);
    put(twist->linear_m_per_s, terms.linear);
    put(twist->angular_rad_per_s + twist->spindle_rad_per_s * axis_world, terms.turning);
    terms.tangential_ratio = static_cast<float>(query_.burr.tangential_ratio);
    terms.friction_speed_m_per_s = kFrictionRegularisationSpeed;
  }
  if (settings_.spread_reach_m > 0.0f) {
    const Eigen::Matrix3f gain = edge_gain(all.spread).cast<float>();
    terms.blend_normals = true;
    for (int a = 0, entry = 0; a < 3; ++a) {
      for (int b = a; b < 3; ++b) terms.edge_blend[entry++] = gain(a, b);
    }
  }
  terms.with_stiffness = query_.outputs != Outputs::kForce;
  if (settings_.potential) {
    const double divisor = divisor_of(query_.settings.scaling, all);
    terms.potential = true;
    terms.push_per_weight = static_cast<float>(potential::kDepthPower * potential::kEnergyShare *
                                               all.energy / divisor * (sum_of_weight_ / divisor));
  }
  return terms;
}

void ContactForce::sum(const MeasureSums& all, ContactScratch& scratch,
                       ContactResult& result) const noexcept {
  Contacts& contacts = scratch.contacts;
  if (contacts.empty()) return;
  const double share = settings_.potential ? potential::kShareOfForce : 1.0;
  const double divisor = divisor_of(query_.settings.scaling, all) / (share * sum_of_weight_);
  std::array<float, 256> stiffness;
  for (std::size_t t = 0; t < query_.tissues.size(); ++t) {
    stiffness[t] = static_cast<float>(query_.tissues[t].stiffness_N_per_m / divisor);
  }
  ForceTerms terms = terms_of(all);
  terms.stiffness_N_per_m = stiffness.data();
  ForceSums sums;
  contact_kernels().forces(frame_, terms, arrays_of(contacts), sums);
  result.wrench = wrench_of(sums.wrench);
  result.tangential = wrench_of(sums.tangential);
  int entry = 0;
  for (int a = 0; a < 6; ++a) {
    result.weight_growth[a] = sum_of_weight_ * sums.weights[a];
    for (int b = a; b < 6; ++b) {
      result.stiffness(a, b) = result.stiffness(b, a) = sums.stiffness[entry++];
    }
  }
}

double energy_J(Scaling scaling, const MeasureSums& all) noexcept {
  if (scaling != Scaling::kPotential) return 0.0;
  return potential::kEnergyShare * all.energy / divisor_of(scaling, all);
}

void add_weight_derivative(Scaling scaling, const MeasureSums& all,
                           ContactResult& result) noexcept {
  if (scaling != Scaling::kSmooth && scaling != Scaling::kPotential) return;
  Vector6d normal;  // the wrench without its tangential part
  normal << result.wrench.force_N - result.tangential.force_N,
      result.wrench.torque_Nm - result.tangential.torque_Nm;
  const double divisor = divisor_of(scaling, all);
  double per_weight = potential::kDepthPower / divisor;
  if (scaling == Scaling::kSmooth) {
    // F = K sum(w d N) / W, with w = d / voxel x fade and W = max(sum w, W0), changes by 2 K w / W
    // along each N, as d and w grow alike; less F dW / W, where the sum of weights is what divides.
    // Fades held; of the second part, which two normals need not make symmetric, the symmetric
    // half.
    result.stiffness *= 2.0;
    per_weight = all.weights > kFullWeights ? 0.5 / divisor : 0.0;
  }
  for (int a = 0; a < 6; ++a) {
    for (int b = 0; b < 6; ++b) {
      result.stiffness(a, b) -=
          per_weight * (normal[a] * result.weight_growth[b] + result.weight_growth[a] * normal[b]);
    }
  }
}

}  // namespace sulcus
