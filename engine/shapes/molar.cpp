#include "engine/shapes/molar.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/shapes/molar_surface.hpp"
#include "engine/shapes/molar_tissues.hpp"

namespace sulcus {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

namespace {

constexpr double kMaxCariesRadius = 2.5;  // mm

// The formulas are for the box below; beyond it they are continued, so that no bound has to hold
// for curves that nobody meant there. In mm.
const Vector3d kBoxMin(-5.9, -5.35, -12.1), kBoxMax(5.9, 5.35, 8.6);
const Vector3d kToothMin(-5.76, -5.28, -11.94), kToothMax(5.82, 5.15, 8.42);

// Greatest length of the gradient in the box, found by dense sampling (the test repeats it), with
// some 2 % to spare.
constexpr double kToothLipschitz = 1.48;
constexpr double kCoreLipschitz = 1.40;
constexpr double kPulpLipschitz = 1.36;
constexpr double kLesionLipschitz = 1.0;

molar::Point<double> point(const Vector3d& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace

Molar::Molar(double caries_radius_m) : caries_radius_(caries_radius_m / kMillimetre) {
  if (!(caries_radius_ >= 0.0 && caries_radius_ <= kMaxCariesRadius)) {
    throw InputError("", "workpiece.molar.caries_radius_mm", std::to_string(caries_radius_),
                     "0 to 2.5");
  }
  pit_z_ = molar::occlusal_height(molar::kPitX, molar::kPitY);
}

double Molar::value(const Vector3d& p) const {
  const Vector3d p_mm = p / kMillimetre;
  const Vector3d q = p_mm.cwiseMax(kBoxMin).cwiseMin(kBoxMax);
  const double inner = molar::eased(molar::tooth(point(q)));
  // Projection onto the box does not lengthen, so the greater of the two keeps the bound; the tooth
  // ends within the box, so it is continuous.
  return kMillimetre * (q == p_mm ? inner : std::max(inner, (p_mm - q).norm()));
}

Vector3d Molar::gradient(const Vector3d& p) const {
  const Vector3d p_mm = p / kMillimetre;
  const Vector3d q = p_mm.cwiseMax(kBoxMin).cwiseMin(kBoxMax);
  const molar::Dual inner = molar::eased(molar::tooth(molar::Point<molar::Dual>{
      molar::Dual(q.x(), 1, 0, 0), molar::Dual(q.y(), 0, 1, 0), molar::Dual(q.z(), 0, 0, 1)}));
  const Vector3d away = p_mm - q;
  const double distance = away.norm();
  if (distance > 0.0 && distance > inner.value) return away / distance;
  Vector3d gradient(inner.dx, inner.dy, inner.dz);
  for (int axis = 0; axis < 3; ++axis) {
    if (away[axis] != 0.0) gradient[axis] = 0.0;
  }
  return gradient;
}

double Molar::lipschitz() const { return kToothLipschitz; }

PartSet Molar::parts_within(const Vector3d& p, double radius, PartSet among) const {
  const molar::Point<double> q = point((p / kMillimetre).cwiseMax(kBoxMin).cwiseMin(kBoxMax));
  const double reach = radius / kMillimetre;
  // A surface between tissues is asked about only where both of its sides are left.
  PartSet left = among;
  if (left.has(Part::kPulp) && left != PartSet::only(Part::kPulp)) {
    const double pulp = molar::pulp(q) / kPulpLipschitz;
    if (pulp <= -reach) return PartSet::only(Part::kPulp);
    if (pulp > reach) left = left.without(Part::kPulp);
  }
  if (caries_radius_ == 0.0) left = left.without(Part::kCaries);
  const bool hard = left.has(Part::kEnamel) || left.has(Part::kDentine);
  if (left.has(Part::kCaries) && hard) {
    const double lesion = molar::lesion(q, caries_radius_, pit_z_) / kLesionLipschitz;
    if (lesion <= -reach) return left.without(Part::kEnamel).without(Part::kDentine);
    if (lesion > reach) left = left.without(Part::kCaries);
  }
  if (left.has(Part::kEnamel) && left.has(Part::kDentine)) {
    const double core = molar::core(q, molar::eased(molar::tooth(q))) / kCoreLipschitz;
    if (core > reach) return left.without(Part::kDentine);
    if (core <= -reach) return left.without(Part::kEnamel);
  }
  return left;
}

AlignedBox3d Molar::bounds() const { return {kMillimetre * kToothMin, kMillimetre * kToothMax}; }

Vector3d Molar::central_pit() const {
  return kMillimetre * Vector3d(molar::kPitX, molar::kPitY, pit_z_);
}

}  // namespace sulcus
