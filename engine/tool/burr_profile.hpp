#pragma once

#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "engine/scene/scene.hpp"

namespace sulcus {

/// Diameter of a friction-grip (FG) shank, m [ISO 1797: type 3, 1.60 mm].
inline constexpr double kShankDiameter = 1.6e-3;

/// One piece of a profile, walked with the inside on the left: a straight segment, or a circular
/// arc of less than half a turn. Points are (r, y) in tool space, m.
struct ProfilePiece {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  Eigen::Vector2d end = Eigen::Vector2d::Zero();
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // arcs only
  double radius = 0.0;                               // m; 0: a segment
  double turn = 0.0;                                 // arcs: +1 convex, -1 concave
};

/// Signed distance and unit outward direction at a point of the (r, y) half-plane.
struct ProfileDistance {
  double distance = 0.0;                             // m, negative inside
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();  // gradient of the distance, (r, y)
};

/// Outline of a rotationally symmetric burr: r(y) from the tip at (0, 0) along head, neck and the
/// beginning of the shank to (0, length), in tool space, m. Of arcs and segments only,
/// single-valued in y but for level segments, so that distances are exact with no function but
/// sqrt. Immutable once built; any thread may ask.
class BurrProfile {
 public:
  /// `pieces` join end to start, from (0, 0) to (0, length), y never falling.
  BurrProfile(std::vector<ProfilePiece> pieces, double head_length_m, double head_diameter_m);

  /// Exact signed distance of (r, y), r >= 0, m; negative inside.
  double distance(double r, double y) const;
  /// The same with its gradient. Where several outline points are nearest (on the axis, on the
  /// medial curve) it is that of one of them.
  ProfileDistance distance_and_normal(double r, double y) const;
  /// Outer radius at height y, m; negative beyond tip or top.
  double radius_at(double y) const;

  const std::vector<ProfilePiece>& pieces() const { return pieces_; }
  double head_length_m() const { return head_length_m_; }      // the cutting part is y <= this
  double head_diameter_m() const { return head_diameter_m_; }  // largest diameter of the head
  double length_m() const { return pieces_.back().end.y(); }   // of all that is modelled
  double max_radius_m() const { return max_radius_m_; }        // head or shank
  double volume_m3() const;

 private:
  std::vector<ProfilePiece> pieces_;
  double head_length_m_;
  double head_diameter_m_;
  double max_radius_m_;
};

/// The profile of a generated shape (not kFile). Diameter 0.3 to 5 mm. The head's length is
/// `length_m`, or else the shape's own ratio to the diameter. As much neck and shank follows as
/// makes the whole about four diameters long (6 to 8 mm for a head of 1.4 mm), so that 1 : 4 : 1
/// samples are well spent.
/// Shapes and size numbers (largest diameter in tenths of a millimetre) after ISO 6360-2: round
/// 001, pear 237, fissure 107, inverted cone 010, flame 243. The number does not fix the head's
/// length; our ratios are of the usual order of FG carbide burs. Blades are not modelled: the
/// profile is what they sweep. InputError names `scene_file` and burr.diameter_mm or
/// burr.length_mm.
BurrProfile make_burr_profile(const BurrSettings& settings, std::string_view scene_file = {});

}  // namespace sulcus
