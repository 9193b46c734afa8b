#include "haptics/contact/contact_force.hpp"

#include <algorithm>
#include <array>

#include "haptics/contact/contact_kernels.hpp"

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

/// What weights that grow with depth make of the stiffness with weights held. F = K sum(w d N) / W,
/// with w = d / voxel x fade and W = max(sum w, W0), changes by 2 K w / W along each N, as d and w
/// grow alike; less F dW / W, where the sum of weights is what divides. Fades held; of the second
/// part, which two normals need not make symmetric, the symmetric half.
void add_weight_derivative(const ForceSums& sums, double per_weight, Matrix6d& stiffness) {
  stiffness *= 2.0;
  for (int a = 0; a < 6; ++a) {
    for (int b = 0; b < 6; ++b) {
      const double normal_a = sums.wrench[a] - sums.tangential[a];
      const double normal_b = sums.wrench[b] - sums.tangential[b];
      stiffness(a, b) -=
          0.5 * per_weight * (normal_a * sums.weights[b] + sums.weights[a] * normal_b);
    }
  }
}

}  // namespace

double contact_reach_m(const Workpiece& workpiece, Scaling scaling, Outputs outputs) noexcept {
  if (scaling != Scaling::kSmooth) return 0.0;
  return (outputs == Outputs::kCoupling ? 2.0 : 1.0) * workpiece.grid().voxel_m;
}

ContactForce::ContactForce(const Workpiece& workpiece, const Burr& burr,
                           const Pose& world_from_tool, Scaling scaling, Outputs outputs) noexcept
    : burr_(burr),
      world_from_tool_(world_from_tool),
      frame_(workpiece.grid(), burr.field, world_from_tool, burr.reference_m),
      scaling_(scaling),
      outputs_(outputs) {
  settings_.at_surface = scaling == Scaling::kSmooth;
  settings_.fade_below = kFadeBelow;
  if (settings_.at_surface && outputs == Outputs::kCoupling) {
    settings_.spread_reach_m = static_cast<float>(contact_reach_m(workpiece, scaling, outputs));
  }
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

void ContactForce::sum(std::span<const TissueSettings> tissues, const Twist* twist,
                       ContactScratch& scratch, ContactResult& result) noexcept {
  Contacts& contacts = scratch.contacts;
  if (contacts.empty()) return;
  measure_until(scratch, contacts.size());
  const MeasureSums measured = sums_of(lanes_);
  const double weights = measured.weights;
  result.contacts = measured.counted;
  double divisor = 1.0;
  if (scaling_ == Scaling::kCount) divisor = std::max<double>(1.0, result.contacts);
  if (scaling_ == Scaling::kMcNeely) divisor = std::max(1.0, result.contacts / kFewContacts);
  if (scaling_ == Scaling::kSmooth) divisor = std::max(kFullWeights, weights);

  ForceTerms terms;
  std::array<float, 256> stiffness;
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    stiffness[t] = static_cast<float>(tissues[t].stiffness_N_per_m / divisor);
  }
  terms.stiffness_N_per_m = stiffness.data();
  if (twist) {
    const Eigen::Vector3d axis_world = world_from_tool_.direction(Eigen::Vector3d::UnitY());
    terms.cutting = true;
    put(burr_.reference_m * axis_world, terms.axis_m);
    put(twist->linear_m_per_s, terms.linear);
    put(twist->angular_rad_per_s + twist->spindle_rad_per_s * axis_world, terms.turning);
    terms.tangential_ratio = static_cast<float>(burr_.tangential_ratio);
    terms.friction_speed_m_per_s = kFrictionRegularisationSpeed;
  }
  if (settings_.spread_reach_m > 0.0f) {
    const Eigen::Matrix3f gain = edge_gain(measured.spread).cast<float>();
    terms.blend_normals = true;
    for (int a = 0, entry = 0; a < 3; ++a) {
      for (int b = a; b < 3; ++b) terms.edge_blend[entry++] = gain(a, b);
    }
  }
  terms.with_stiffness = outputs_ != Outputs::kForce;
  ForceSums sums;
  contact_kernels().forces(frame_, terms, arrays_of(contacts), sums);
  result.wrench = wrench_of(sums.wrench);
  result.tangential = wrench_of(sums.tangential);
  int entry = 0;
  for (int a = 0; a < 6; ++a) {
    for (int b = a; b < 6; ++b) {
      result.stiffness(a, b) = result.stiffness(b, a) = sums.stiffness[entry++];
    }
  }
  if (terms.with_stiffness && scaling_ == Scaling::kSmooth) {
    add_weight_derivative(sums, weights > kFullWeights ? 1.0 / weights : 0.0, result.stiffness);
  }
}

}  // namespace sulcus
