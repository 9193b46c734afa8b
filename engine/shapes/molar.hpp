#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/shapes/implicit_shape.hpp"

namespace sulcus {

/// The built-in lower first molar, made from formulas: five cusps, Y-shaped fissures, two roots;
/// enamel, dentine, pulp and, if asked for, a carious lesion under the central pit. In metres, in
/// its own space, which is the scene's: crown to +z, highest cusp at z = +8.4 mm, mesial +x, buccal
/// -y; about 11.5 x 10.3 x 20.3 mm. An ImplicitShape: not a distance, but within `lipschitz()` of
/// one; all functions are pure, use no libm but sqrt, and may be called from any thread.
class Molar {
 public:
  /// `caries_radius_m`: half the width of the lesion, up to 2.5 mm; 0: a sound tooth. Throws
  /// InputError beyond that.
  explicit Molar(double caries_radius_m = 0.0);

  double value(const Eigen::Vector3d& p) const;
  /// Analytic. Continuous within the bounds.
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const;
  double lipschitz() const;
  /// Pulp before caries before enamel and dentine; also an answer outside the tooth.
  PartSet parts_within(const Eigen::Vector3d& p, double radius, PartSet among) const;
  Eigen::AlignedBox3d bounds() const;

  /// Bottom of the central pit, on the surface.
  Eigen::Vector3d central_pit() const;

 private:
  double caries_radius_;  // mm
  double pit_z_;          // mm
};

}  // namespace sulcus
