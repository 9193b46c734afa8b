#include "engine/tool/burr_profile.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"

namespace sulcus {
namespace {

using Eigen::Vector2d;

constexpr double kMinDiameter = 0.3e-3, kMaxDiameter = 5e-3;  // m
constexpr double kMaxNeckRadius = 0.6e-3;   // m; the neck is always thinner than the shank
constexpr double kMinNeck = 1.6e-3;         // m, from the head to the shank
constexpr double kMaxNeck = 6e-3;           // m
constexpr double kShank = 1e-3;             // m of shank, at least
constexpr double kLengthPerDiameter = 4.0;  // of the whole
constexpr double kSlack = 1e-9;             // m: 0.3 * 1e-3 is a bit less than 0.3e-3

/// Proportions of a head; lengths to the diameter, radii to its half.
struct HeadShape {
  double length, min_length, max_length;
  double base;  // radius where the cutting part ends
  double neck;  // smallest radius behind it
  double edge;  // radius of the rounding between the end face and the side; 1: a hemisphere
};

HeadShape head_shape(BurrShape shape) {
  switch (shape) {
    case BurrShape::kRound:
      return {0.933, 0.75, 0.98, 0.5, 0.5, 1.0};
    case BurrShape::kPear:
      return {1.8, 1.1, 5.0, 0.62, 0.5, 1.0};
    case BurrShape::kFissure:
      return {3.0, 0.5, 8.0, 1.0, 0.62, 0.08};
    case BurrShape::kInvertedCone:
      return {0.9, 0.5, 3.0, 0.62, 0.5, 0.08};
    case BurrShape::kFlame:
      return {3.2, 1.5, 10.0, 0.72, 0.6, 0.12};
    case BurrShape::kFile:
      break;
  }
  throw std::invalid_argument("a burr from a mesh file has no generated profile");
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

ProfilePiece segment(const Vector2d& from, const Vector2d& to) {
  return {from, to, Vector2d::Zero(), 0.0, 0.0};
}

ProfilePiece arc(const Vector2d& from, const Vector2d& to, const Vector2d& centre, double radius,
                 double turn) {
  return {from, to, centre, radius, turn};
}

bool is_arc(const ProfilePiece& piece) { return piece.radius > 0.0; }

/// Outward unit normal of the piece at one of its points.
Vector2d piece_normal(const ProfilePiece& piece, const Vector2d& p) {
  if (is_arc(piece)) return piece.turn * (p - piece.centre) / piece.radius;
  const Vector2d along = (piece.end - piece.start).normalized();
  return {along.y(), -along.x()};
}

/// Nearest point of a piece; `interior` says that it is not one of the ends.
struct Nearest {
  Vector2d point;
  bool interior;
};

Nearest nearest_on(const ProfilePiece& piece, const Vector2d& p) {
  if (is_arc(piece)) {
    const Vector2d q = p - piece.centre;
    const double length = std::sqrt(q.squaredNorm());
    const bool in_span = piece.turn * cross(piece.start - piece.centre, q) >= 0.0 &&
                         piece.turn * cross(q, piece.end - piece.centre) >= 0.0;
    if (in_span && length > 0.0) return {piece.centre + q * (piece.radius / length), true};
    const bool first = (p - piece.start).squaredNorm() <= (p - piece.end).squaredNorm();
    return {first ? piece.start : piece.end, false};
  }
  const Vector2d along = piece.end - piece.start;
  const double t = along.dot(p - piece.start) / along.squaredNorm();
  if (t <= 0.0) return {piece.start, false};
  if (t >= 1.0) return {piece.end, false};
  return {piece.start + t * along, true};
}

/// Head with an end face (none if the edge is a hemisphere), a rounded edge whose widest point is
/// at the full radius, and a straight side to (base, length): pear, fissure and inverted cone.
void append_straight_head(std::vector<ProfilePiece>& pieces, double radius, double edge,
                          double base, double length) {
  const Vector2d centre(radius - edge, edge);
  const Vector2d bottom(radius - edge, 0.0);
  if (edge < radius) pieces.push_back(segment(Vector2d::Zero(), bottom));
  // The tangent from the side's end to the circle touches it where centre-touch is perpendicular to
  // touch-end: with u = end - centre, touch = centre + (edge^2 u + edge sqrt(u^2 - edge^2) u') /
  // u^2 where u' is u turned to the outer side.
  const Vector2d end(base, length);
  const Vector2d u = end - centre;
  const double u2 = u.squaredNorm();
  const Vector2d outer(u.y(), -u.x());
  const Vector2d touch =
      centre + (edge * edge * u + edge * std::sqrt(u2 - edge * edge) * outer) / u2;
  pieces.push_back(arc(bottom, touch, centre, edge, 1.0));
  pieces.push_back(segment(touch, end));
}

/// A flame: rounded tip of radius t, an arc to the widest point at (R, m), another to (base,
/// length).
void append_flame_head(std::vector<ProfilePiece>& pieces, double radius, double tip, double base,
                       double length) {
  const double widest = 0.42 * length;
  // The front arc is level with the axis at (R, m), so its centre is (R - rho, m); it holds the tip
  // circle inside, touching: (R - rho)^2 + (m - t)^2 = (rho - t)^2, linear in rho.
  const double up = widest - tip;
  const double front = (radius * radius - tip * tip + up * up) / (2.0 * (radius - tip));
  const Vector2d tip_centre(0.0, tip);
  const Vector2d front_centre(radius - front, widest);
  const Vector2d touch = front_centre + (tip_centre - front_centre) * (front / (front - tip));
  // The back arc leaves (R, m) the same way and passes through (base, length).
  const double in = radius - base, back_length = length - widest;
  const double back = (in * in + back_length * back_length) / (2.0 * in);
  const Vector2d waist(radius, widest);
  pieces.push_back(arc(Vector2d::Zero(), touch, tip_centre, tip, 1.0));
  pieces.push_back(arc(touch, waist, front_centre, front, 1.0));
  pieces.push_back(arc(waist, Vector2d(base, length), Vector2d(radius - back, widest), back, 1.0));
}

/// Shoulder, neck widening in one concave arc to the shank, shank and its end face.
void append_neck_and_shank(std::vector<ProfilePiece>& pieces, double neck_radius,
                           double max_radius) {
  const Vector2d base = pieces.back().end;
  const double shank_radius = 0.5 * kShankDiameter;
  const double total =
      std::max(kLengthPerDiameter * 2.0 * max_radius, base.y() + kMinNeck + kShank);
  const double shank_start = std::min(total - kShank, base.y() + kMaxNeck);

  Vector2d neck = base;
  if (neck_radius < base.x() - kSlack) {
    neck = Vector2d(neck_radius, base.y() + 0.6 * (base.x() - neck_radius));
    pieces.push_back(segment(base, neck));
  }
  const double out = shank_radius - neck.x(), up = shank_start - neck.y();
  const double radius = (out * out + up * up) / (2.0 * out);
  const Vector2d shank(shank_radius, shank_start);
  pieces.push_back(arc(neck, shank, Vector2d(neck.x() + radius, neck.y()), radius, -1.0));
  pieces.push_back(segment(shank, Vector2d(shank_radius, total)));
  pieces.push_back(segment(Vector2d(shank_radius, total), Vector2d(0.0, total)));
}

std::string in_mm(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g mm", metres / kMillimetre);
  return text;
}

}  // namespace

BurrProfile::BurrProfile(std::vector<ProfilePiece> pieces, double head_length_m,
                         double head_diameter_m)
    : pieces_(std::move(pieces)),
      head_length_m_(head_length_m),
      head_diameter_m_(head_diameter_m),
      max_radius_m_(0.5 * head_diameter_m) {
  for (const ProfilePiece& piece : pieces_) {
    max_radius_m_ = std::max({max_radius_m_, piece.start.x(), piece.end.x()});
  }
}

double BurrProfile::radius_at(double y) const {
  double radius = -1.0;
  for (const ProfilePiece& piece : pieces_) {
    const double low = piece.start.y(), high = piece.end.y();
    if (y < low || y > high) continue;
    double here = std::max(piece.start.x(), piece.end.x());
    if (is_arc(piece)) {
      const double dy = y - piece.centre.y();
      const double across = piece.radius * piece.radius - dy * dy;
      here = piece.centre.x() + piece.turn * std::sqrt(std::max(across, 0.0));
    } else if (high > low) {
      here = piece.start.x() + (piece.end.x() - piece.start.x()) * ((y - low) / (high - low));
    }
    radius = std::max(radius, here);
  }
  return radius;
}

double BurrProfile::distance(double r, double y) const {
  const Vector2d p(r, y);
  double nearest2 = std::numeric_limits<double>::infinity();
  for (const ProfilePiece& piece : pieces_) {
    nearest2 = std::min(nearest2, (p - nearest_on(piece, p).point).squaredNorm());
  }
  const double distance = std::sqrt(nearest2);
  return r <= radius_at(y) ? -distance : distance;
}

ProfileDistance BurrProfile::distance_and_normal(double r, double y) const {
  const Vector2d p(r, y);
  const ProfilePiece* nearest_piece = &pieces_.front();
  Nearest nearest = nearest_on(*nearest_piece, p);
  double nearest2 = (p - nearest.point).squaredNorm();
  for (const ProfilePiece& piece : pieces_) {
    const Nearest here = nearest_on(piece, p);
    const double d2 = (p - here.point).squaredNorm();
    if (d2 < nearest2) {
      nearest2 = d2;
      nearest = here;
      nearest_piece = &piece;
    }
  }
  const double sign = r <= radius_at(y) ? -1.0 : 1.0;
  const double distance = std::sqrt(nearest2);
  // At a corner the direction is that from the corner; on it, any normal between the two sides.
  const bool from_corner = !nearest.interior && distance > 0.0;
  const Vector2d normal = from_corner ? Vector2d(sign * (p - nearest.point) / distance)
                                      : piece_normal(*nearest_piece, nearest.point);
  return {sign * distance, normal};
}

double BurrProfile::volume_m3() const {
  // pi times the integral of r^2 dy along the outline, in closed form piece by piece.
  double integral = 0.0;
  for (const ProfilePiece& piece : pieces_) {
    const double y0 = piece.start.y(), y1 = piece.end.y();
    if (!is_arc(piece)) {
      const double r0 = piece.start.x(), r1 = piece.end.x();
      integral += (y1 - y0) * (r0 * r0 + r0 * r1 + r1 * r1) / 3.0;
      continue;
    }
    // r = c + s sqrt(R^2 - u^2), u = y - y_c:
    // r^2 = c^2 + R^2 - u^2 + 2 c s sqrt(R^2 - u^2).
    const auto primitive = [&piece](double u) {
      const double big = piece.radius, c = piece.centre.x();
      const double root = std::sqrt(std::max(big * big - u * u, 0.0));
      const double angle = std::asin(std::clamp(u / big, -1.0, 1.0));
      return (c * c + big * big) * u - u * u * u / 3.0 +
             c * piece.turn * (u * root + big * big * angle);
    };
    integral += primitive(y1 - piece.centre.y()) - primitive(y0 - piece.centre.y());
  }
  return std::numbers::pi * integral;
}

BurrProfile make_burr_profile(const BurrSettings& settings, std::string_view scene_file) {
  const double diameter = settings.diameter_m;
  if (!(diameter >= kMinDiameter - kSlack && diameter <= kMaxDiameter + kSlack)) {
    throw InputError(scene_file, "burr.diameter_mm", in_mm(diameter),
                     in_mm(kMinDiameter) + " to " + in_mm(kMaxDiameter));
  }
  const HeadShape shape = head_shape(settings.shape);
  const double length = settings.length_m.value_or(shape.length * diameter);
  if (!(length >= shape.min_length * diameter - kSlack &&
        length <= shape.max_length * diameter + kSlack)) {
    throw InputError(scene_file, "burr.length_mm", in_mm(length),
                     in_mm(shape.min_length * diameter) + " to " +
                         in_mm(shape.max_length * diameter) +
                         " for a head of this shape and diameter");
  }

  const double radius = 0.5 * diameter;
  double neck_radius = shape.neck * radius;
  std::vector<ProfilePiece> pieces;
  switch (settings.shape) {
    case BurrShape::kRound: {
      // The sphere is cut where the head ends, so its length sets the neck.
      const double above = length - radius;
      const double base = std::sqrt(radius * radius - above * above);
      pieces.push_back(
          arc(Vector2d::Zero(), Vector2d(base, length), Vector2d(0.0, radius), radius, 1.0));
      neck_radius = base;
      break;
    }
    case BurrShape::kFlame:
      append_flame_head(pieces, radius, shape.edge * radius, shape.base * radius, length);
      break;
    default:
      append_straight_head(pieces, radius, shape.edge * radius, shape.base * radius, length);
  }
  append_neck_and_shank(pieces, std::min(neck_radius, kMaxNeckRadius),
                        std::max(radius, 0.5 * kShankDiameter));
  return BurrProfile(std::move(pieces), length, diameter);
}

}  // namespace sulcus
