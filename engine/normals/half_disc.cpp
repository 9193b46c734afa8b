#include "engine/normals/half_disc.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <Eigen/Core>

namespace sulcus {

namespace {

constexpr int kReach = 6;
constexpr float kRadius2 = 6.8f * 6.8f;
constexpr int kFewestPoints = 40;
constexpr float kSlack = 0.4f;      // of a residual beyond half the cosine, voxels
constexpr float kMostMean = 0.35f;  // of the residuals' root mean square, share of the cosine
constexpr float kMostInside = -0.25f, kMostOutside = 1.0f;  // offset of the voxel's own face
constexpr float kPerPoint = 0.004f;                         // of the score, voxels

/// z = c0 + c1 i + c2 j by least squares, from sums.
struct PlaneSums {
  std::int32_t n = 0, i = 0, j = 0, ii = 0, ij = 0, jj = 0, z = 0, iz = 0, jz = 0;  // z twice

  void add(int pi, int pj, int twice_z) {
    ++n, i += pi, j += pj, ii += pi * pi, ij += pi * pj, jj += pj * pj;
    z += twice_z, iz += pi * twice_z, jz += pj * twice_z;
  }
  void add(const PlaneSums& s) {
    n += s.n, i += s.i, j += s.j, ii += s.ii, ij += s.ij, jj += s.jj;
    z += s.z, iz += s.iz, jz += s.jz;
  }
};

struct HeightPlane {
  float c0 = 0, c1 = 0, c2 = 0, cosine = 1;
  float residual(int i, int j, int twice_z) const {  // across the plane
    return (0.5f * static_cast<float>(twice_z) - c0 - c1 * static_cast<float>(i) -
            c2 * static_cast<float>(j)) *
           cosine;
  }
};

std::optional<HeightPlane> plane_of(const PlaneSums& s) {
  if (s.n < kFewestPoints) return {};
  // About the mean, n times the covariances: whole numbers.
  const auto times_n = [&](std::int32_t product, std::int32_t a, std::int32_t b) {
    return static_cast<float>(s.n * product - a * b);
  };
  const float ii = times_n(s.ii, s.i, s.i), ij = times_n(s.ij, s.i, s.j),
              jj = times_n(s.jj, s.j, s.j);
  const float iz = times_n(s.iz, s.i, s.z), jz = times_n(s.jz, s.j, s.z);
  const float determinant = ii * jj - ij * ij;
  if (determinant <= 0.0f) return {};
  HeightPlane plane;
  plane.c1 = 0.5f * (jj * iz - ij * jz) / determinant;
  plane.c2 = 0.5f * (ii * jz - ij * iz) / determinant;
  const auto n = static_cast<float>(s.n);
  plane.c0 = (0.5f * static_cast<float>(s.z) - plane.c1 * static_cast<float>(s.i) -
              plane.c2 * static_cast<float>(s.j)) /
             n;
  plane.cosine = 1.0f / std::sqrt(1.0f + plane.c1 * plane.c1 + plane.c2 * plane.c2);
  return plane;
}

/// A pixel of the disc. Sixteen parts make up the disc but for its middle: the rays every 45
/// degrees, and the sectors between them. Five rays and four sectors are a half.
struct Pixel {
  signed char i, j;
  std::uint8_t part;  // 2 d: on ray d; 2 d + 1: between the rays d and d + 1; kMiddle
};

constexpr int kPixels = 149;  // within 6.8 of the middle of 13 x 13
constexpr std::uint8_t kParts = 16, kMiddle = 16;

constexpr std::uint8_t part_of(int i, int j) {
  if (i == 0 && j == 0) return kMiddle;
  constexpr int kRays[9][2] = {{1, 0},   {1, 1},  {0, 1},  {-1, 1}, {-1, 0},
                               {-1, -1}, {0, -1}, {1, -1}, {1, 0}};
  for (int d = 0; d < 8; ++d) {
    const int left_of = kRays[d][0] * j - kRays[d][1] * i;
    const int right_of = kRays[d + 1][0] * j - kRays[d + 1][1] * i;
    const int along = kRays[d][0] * i + kRays[d][1] * j;
    if (left_of == 0 && along > 0) return static_cast<std::uint8_t>(2 * d);
    if (left_of > 0 && right_of < 0) return static_cast<std::uint8_t>(2 * d + 1);
  }
  return kMiddle;
}

constexpr auto kDisc = [] {
  std::array<Pixel, kPixels> pixels{};
  std::size_t count = 0;
  for (int j = -kReach; j <= kReach; ++j) {
    for (int i = -kReach; i <= kReach; ++i) {
      if (static_cast<float>(i * i + j * j) > kRadius2) continue;
      pixels[count++] = {static_cast<signed char>(i), static_cast<signed char>(j), part_of(i, j)};
    }
  }
  return pixels;
}();

/// Whether a part lies in the half about ray `d`: up to 90 degrees, four parts, to either side.
constexpr bool in_half(std::uint8_t part, int d) {
  return part == kMiddle || (part + 4u - 2u * static_cast<unsigned>(d)) % kParts <= 8u;
}

}  // namespace

std::optional<HalfDisc> nearest_half_disc(const HeightMap& map) noexcept {
  struct Point {
    int i, j, twice_z;
    std::uint8_t part;
  };
  std::array<Point, kPixels> points;
  std::size_t count = 0;
  std::array<PlaneSums, kParts + 1> parts;
  for (const Pixel& pixel : kDisc) {
    if (std::abs(pixel.i) > map.ns || std::abs(pixel.j) > map.ns) continue;
    const int h = map.at(pixel.i, pixel.j);
    if (h == HeightMap::kNone) continue;
    const Point p{pixel.i, pixel.j, 2 * map.sign * h + 1, pixel.part};
    points[count++] = p;
    parts[p.part].add(p.i, p.j, p.twice_z);
  }

  std::optional<HalfDisc> best;
  for (int d = 0; d < 8; ++d) {
    PlaneSums half;
    for (std::uint8_t part = 0; part <= kMiddle; ++part) {
      if (in_half(part, d)) half.add(parts[part]);
    }
    const std::optional<HeightPlane> first = plane_of(half);
    if (!first) continue;
    // What lies on the first plane.
    std::array<Point, kPixels> inlier;
    std::size_t inliers = 0;
    PlaneSums sums;
    const float most = kSlack + 0.5f * first->cosine;
    for (std::size_t k = 0; k < count; ++k) {
      const Point& p = points[k];
      if (!in_half(p.part, d) || std::abs(first->residual(p.i, p.j, p.twice_z)) > most) continue;
      sums.add(p.i, p.j, p.twice_z);
      inlier[inliers++] = p;
    }
    const std::optional<HeightPlane> plane = plane_of(sums);
    if (!plane) continue;
    const float offset = plane->cosine * plane->c0;
    if (offset < kMostInside || offset > kMostOutside) continue;
    const float score = std::abs(offset) - kPerPoint * static_cast<float>(inliers);
    if (best && best->score <= score) continue;

    float largest = 0.0f, squares = 0.0f;
    for (std::size_t k = 0; k < inliers; ++k) {
      const float r = plane->residual(inlier[k].i, inlier[k].j, inlier[k].twice_z);
      largest = std::max(largest, std::abs(r));
      squares += r * r;
    }
    const float mean = kMostMean * plane->cosine;
    if (largest > kSlack + 0.5f * plane->cosine ||
        squares > static_cast<float>(inliers) * mean * mean) {
      continue;
    }
    const Eigen::Vector3f normal(-plane->c1 * plane->cosine, -plane->c2 * plane->cosine,
                                 plane->cosine);
    best = HalfDisc{{normal, offset}, score};
  }
  return best;
}

}  // namespace sulcus
