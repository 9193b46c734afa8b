#pragma once

#include <array>

#include "engine/shapes/dual.hpp"
#include "engine/shapes/molar_profile.hpp"

// The outer surface of the built-in molar, in millimetres, in its own space: z up (0 about the
// neck), x mesial, -y buccal. Every function takes `double` or `Dual`; there is no libm but sqrt,
// so that the tooth is the same on every processor. Negative inside.
//
//              crown = smooth_max(contour, occlusal)
//     occlusal: z above the height field of five cusps and two marginal ridges; where two cusps
//     meet
//               there is a fissure, so the Y-shaped pattern follows from where the cusps stand
//     contour:  rounded-rectangle cross sections whose four half widths follow curves over z, with
//               the buccal and lingual grooves pressed into them
//     roots:    two flattened, waisted ovals on curved centre lines, tapering to their apices
//              tooth = smooth_min(crown, roots)

namespace sulcus::molar {

template <class T>
struct Point {
  T x, y, z;
};

// clang-format off
//                           z: -13    -12    -11    -10     -9     -8     -7     -6     -5     -4     -3     -2     -1      0      1      2      3      4      5      6      7      8      9     10
inline constexpr Curve kBuccal  { 3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.30,  3.95,  4.40,  4.65,  5.05,  5.28,  5.15,  4.80,  4.35,  3.85,  3.30,  2.75,  2.20};
inline constexpr Curve kLingual { 3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.20,  3.85,  4.25,  4.45,  4.70,  4.95,  5.12,  5.12,  4.95,  4.65,  4.25,  3.85,  3.45};
inline constexpr Curve kMesial  { 3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.30,  3.95,  4.40,  4.65,  5.00,  5.35,  5.65,  5.82,  5.75,  5.45,  5.00,  4.50,  4.00};
inline constexpr Curve kDistal  { 3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.00,  3.20,  3.85,  4.30,  4.55,  4.95,  5.35,  5.68,  5.82,  5.70,  5.35,  4.85,  4.35,  3.85};
// Depth of the grooves in the contour.
inline constexpr Curve kBuccalGroove  { 0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.06,  0.45,  0.44,  0.54,  0.66,  0.60,  0.40,  0.30};
inline constexpr Curve kDistalGroove  { 0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.10,  0.22,  0.34,  0.46,  0.56,  0.50,  0.40,  0.30};
inline constexpr Curve kLingualGroove { 0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.00,  0.05,  0.18,  0.32,  0.46,  0.58,  0.60,  0.45,  0.30};

// Roots: centre line x, half width buccolingually (the apex is where it passes zero), and how many
// times narrower they are mesiodistally.
inline constexpr Curve kMesialRootX  { 0.83,  1.05,  1.32,  1.60,  1.85,  2.06,  2.24,  2.36,  2.42,  2.41,  2.38,  2.34,  2.32,  2.29,  2.25,  2.20,  2.20,  2.20,  2.20,  2.20,  2.20,  2.20,  2.20,  2.20};
inline constexpr Curve kMesialRootB  {-1.00,  0.95,  1.62,  2.10,  2.56,  2.90,  3.18,  3.42,  3.62,  3.77,  3.90,  4.02,  4.12,  4.16,  4.02,  3.20,  2.10,  0.70, -0.90, -2.50, -4.10, -5.70, -7.30, -8.90};
inline constexpr Curve kDistalRootX  {-3.83, -3.70, -3.52, -3.34, -3.16, -2.97, -2.81, -2.65, -2.52, -2.42, -2.36, -2.32, -2.28, -2.23, -2.15, -2.10, -2.10, -2.10, -2.10, -2.10, -2.10, -2.10, -2.10, -2.10};
inline constexpr Curve kDistalRootB  {-2.20, -0.50,  0.95,  1.55,  2.08,  2.46,  2.78,  3.04,  3.26,  3.45,  3.62,  3.76,  3.90,  3.94,  3.83,  3.10,  2.00,  0.60, -1.00, -2.60, -4.20, -5.80, -7.40, -9.00};
inline constexpr Curve kRootFlatness { 1.45,  1.50,  1.65,  1.88,  2.08,  2.22,  2.32,  2.38,  2.38,  2.36,  2.30,  2.22,  2.14,  2.06,  2.00,  1.95,  1.95,  1.95,  1.95,  1.95,  1.95,  1.95,  1.95,  1.95};
// clang-format on

/// A cusp of the height field: a pyramid with rounded edges, whose edges are its ridges. It falls
/// `inward` along the triangular ridge toward the centre of the tooth, `outward` away from it, and
/// `along` on both sides along the row of cusps.
struct Cusp {
  double x, y, z;          // tip, mm
  double ux, uy;           // unit, inward
  double inward, outward;  // slopes
  double along;
  double roundness;  // mm
};

inline constexpr std::array<Cusp, 5> kCusps{{
    {2.60, -2.85, 7.50, -0.10, 0.995, 0.61, 1.10, 0.60, 0.70},  // mesiobuccal
    {-1.05, -3.00, 7.30, 0.12, 0.993, 0.57, 1.10, 0.60, 0.70},  // distobuccal
    {-3.95, -1.55, 6.85, 0.78, 0.626, 0.62, 0.95, 0.62, 0.60},  // distal
    {2.45, 2.90, 8.39, -0.16, -0.987, 0.80, 1.30, 0.66, 0.45},  // mesiolingual
    {-2.00, 2.90, 8.02, 0.18, -0.984, 0.78, 1.30, 0.64, 0.45},  // distolingual
}};
inline constexpr double kRidgeBend = 0.07;  // 1/mm, of the cusp ridges toward the centre

template <class T>
T cusp_height(const Cusp& cusp, const T& x, const T& y) {
  const T dx = x - T(cusp.x), dy = y - T(cusp.y);
  const T v = dy * T(cusp.ux) - dx * T(cusp.uy);
  const T u = dx * T(cusp.ux) + dy * T(cusp.uy) - square(v) * T(kRidgeBend);
  const T fall =
      (smooth_abs(u, cusp.roundness) - T(cusp.roundness)) * T(0.5 * (cusp.inward + cusp.outward)) +
      u * T(0.5 * (cusp.inward - cusp.outward)) +
      (smooth_abs(v, cusp.roundness) - T(cusp.roundness)) * T(cusp.along);
  return T(cusp.z) - fall;
}

/// Depth of the supplemental grooves that flank a cusp's triangular ridge.
template <class T>
T supplemental_grooves(const Cusp& cusp, const T& x, const T& y) {
  const T dx = x - T(cusp.x), dy = y - T(cusp.y);
  const T u = dx * T(cusp.ux) + dy * T(cusp.uy);
  const T v = dy * T(cusp.ux) - dx * T(cusp.uy);
  const T lines =
      bell(T(v - T(0.55) - u * T(0.22)), 0.55) + bell(T(v + T(0.5) + u * T(0.25)), 0.55);
  return lines * smooth_step(u, 0.3, 1.5) * T(0.14);
}

/// The greater of two mounds, with a fissure where they meet: a V with a rounded bottom.
template <class T>
T meet(const T& a, const T& b, double depth, double width) {
  const T gap = smooth_abs(T(a - b), 0.04);
  const T greater = smooth_max(a, b, 0.25);
  if (plain(gap) >= width) return greater;
  const T h = T(1.0) - gap * T(1.0 / width);
  return greater - h * h * h * T(depth);
}

/// A marginal ridge: a rounded wall across the tooth at x = `x`, bent inward at its ends.
template <class T>
T marginal_ridge(const T& x, const T& y, double at, double centre_y, double height,
                 double inward_sign) {
  const T across = (x - T(at)) * T(inward_sign) - square(T(y - T(centre_y))) * T(0.07);
  return T(height) - smooth_abs(across, 0.45) * T(1.05) + across * T(0.25) -
         square(T(y - T(centre_y))) * T(0.05);
}

/// The height field stays above this, mm; it gets so low only outside the crown.
inline constexpr double kLowestOcclusal = 4.4;

/// Height of the chewing surface over (x, y), mm.
template <class T>
T occlusal_height(const T& x, const T& y) {
  std::array<T, 5> c;
  for (std::size_t n = 0; n < 5; ++n) {
    c[n] = cusp_height(kCusps[n], x, y) - supplemental_grooves(kCusps[n], x, y);
  }
  const T buccal = meet(meet(c[0], c[1], 0.24, 0.95), c[2], 0.24, 0.90);
  const T lingual = meet(c[3], c[4], 0.24, 0.95);
  const T cusps = meet(buccal, lingual, 0.28, 1.10);
  const T mesial = marginal_ridge(x, y, 4.45, 0.15, 7.20, -1.0);
  const T distal = marginal_ridge(x, y, -4.75, 1.0, 6.85, 1.0);
  const T surface = smooth_max(smooth_max(cusps, mesial, 0.9), distal, 0.9);
  return smooth_max(surface, T(kLowestOcclusal + 0.2), 0.4);
}

/// Rounded-rectangle cross sections, with the grooves of the buccal and lingual faces.
template <class T>
T contour(const Point<T>& p, const Knots<T>& at) {
  using std::sqrt;
  const T buccal = at(kBuccal), lingual = at(kLingual);
  const T mesial = at(kMesial), distal = at(kDistal);
  const T half_y = (buccal + lingual) * T(0.5), half_x = (mesial + distal) * T(0.5);
  const T cy = (lingual - buccal) * T(0.5), cx = (mesial - distal) * T(0.5);
  const T dx = p.x - cx, dy = p.y - cy;
  // The lingual side is shorter than the buccal, the distal end narrower than the mesial.
  const T nx = dx * (T(1.0) + dy * T(0.016)) / half_x;
  const T ny = dy * (T(1.0) - dx * T(0.016)) / half_y;
  const T x2 = nx * nx, y2 = ny * ny;
  const T radius = sqrt(sqrt(x2 * x2 + y2 * y2 + x2 * y2 * T(0.9) + T(1e-4)));
  T side = (radius - T(1.0)) * (half_x + half_y) * T(0.5);
  if (plain(p.y) < 0.0) {
    const T outer = smooth_step(T(-p.y), 0.0, 2.5);
    side = side + outer * (bell(T(p.x - T(0.75)), 1.1) * at(kBuccalGroove) +
                           bell(T(p.x + T(3.0)), 1.0) * at(kDistalGroove));
  } else {
    const T outer = smooth_step(p.y, 0.0, 2.5);
    side = side + outer * bell(T(p.x - T(0.2)), 1.2) * at(kLingualGroove);
  }
  return side;
}

/// One root: flattened, with round edges, pinched in the middle by the grooves that run down it. A
/// distance in each cross section.
template <class T>
T root(const Point<T>& p, const Knots<T>& at, const Curve& centre_x, const Curve& half_y,
       double pinch) {
  using std::sqrt;
  const T half = at(half_y);
  const T thick = half / at(kRootFlatness);
  const T across = square(p.y);
  const T waist = T(1.0) - T(pinch) / (T(1.0) + across * T(0.35));
  const T beyond = smooth_max(T(smooth_abs(p.y, 0.3) - (half - thick)), T(0.0), 2.4);
  return sqrt(square(T(p.x - at(centre_x))) + square(beyond) + T(0.04)) - thick * waist;
}

/// How far a point is below the crown's floor. The floor arches from root to root; between them it
/// is the roof of the furcation.
template <class T>
T crown_floor(const Point<T>& p) {
  const T x2 = square(p.x);
  return (T(-3.0) - x2 * T(2.2) / (x2 + T(2.0)) - p.z) * T(0.65);
}

template <class T>
T crown(const Point<T>& p, const Knots<T>& at, const T& floor) {
  constexpr double kEdge = 1.0;  // mm, rounding between chewing surface and contour
  constexpr double kSlope = 0.53;
  T side = contour(p, at);
  // Low on the crown the chewing surface is out of reach of the rounding: its cost is saved.
  if (plain(side) < kSlope * (plain(p.z) - kLowestOcclusal) + kEdge) {
    side = smooth_max(side, T((p.z - occlusal_height(p.x, p.y)) * T(kSlope)), kEdge);
  }
  return smooth_max(side, floor, 2.0);
}

template <class T>
T roots(const Point<T>& p, const Knots<T>& at) {
  return smooth_min(root(p, at, kMesialRootX, kMesialRootB, 0.20),
                    root(p, at, kDistalRootX, kDistalRootB, 0.12), 1.6);
}

/// The whole tooth: negative inside, mm.
template <class T>
T tooth(const Point<T>& p) {
  constexpr double kNeck = 1.0;  // mm, rounding between crown and roots
  const Knots<T> at(p.z);
  const T floor = crown_floor(p);
  const T lower = roots(p, at);
  if (plain(floor) >= plain(lower) + kNeck) return lower;  // as the crown lies above its floor
  return smooth_min(crown(p, at, floor), lower, kNeck);
}

/// The same surface; beyond 0.6 mm to either side the value grows at a third of its rate, so that
/// the steepest places far from the surface do not set the Lipschitz bound for those near it.
template <class T>
T eased(const T& tooth_value) {
  constexpr double kNear = 0.6, kTurn = 0.4, kFar = 1.0 / 3.0;  // mm, mm, slope
  const double sign = plain(tooth_value) < 0.0 ? -1.0 : 1.0;
  const T beyond = tooth_value * T(sign) - T(kNear);
  if (plain(beyond) <= 0.0) return tooth_value;
  constexpr double kLoss = 1.0 - kFar;  // of the slope, gained evenly over the turn
  const T lost = plain(beyond) < kTurn ? square(beyond) * T(0.5 * kLoss / kTurn)
                                       : (beyond - T(0.5 * kTurn)) * T(kLoss);
  return tooth_value - lost * T(sign);
}

}  // namespace sulcus::molar
