#include "engine/normals/ldm_paper.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "engine/normals/neighbour_pattern.hpp"

namespace sulcus {

namespace {

/// Lattice of a map: pixel (i, j) lies at i u + j v from the voxel, its column runs along p.
struct MapFrame {
  Eigen::Vector3i p, u, v;
};

/// The shortest lattice vectors across a direction of projection with components -1, 0, 1.
MapFrame frame_of(const Eigen::Vector3i& p) {
  const int axes = p.cwiseAbs().sum();
  if (axes == 1) {
    const int a = p.x() != 0 ? 0 : p.y() != 0 ? 1 : 2;
    return {p, Eigen::Vector3i::Unit((a + 1) % 3), Eigen::Vector3i::Unit((a + 2) % 3)};
  }
  if (axes == 2) {
    const int zero = p.x() == 0 ? 0 : p.y() == 0 ? 1 : 2;
    const int a = (zero + 1) % 3, b = (zero + 2) % 3;
    return {p, p[b] * Eigen::Vector3i::Unit(a) - p[a] * Eigen::Vector3i::Unit(b),
            Eigen::Vector3i::Unit(zero)};
  }
  return {p, Eigen::Vector3i(p.x(), -p.y(), 0), Eigen::Vector3i(0, p.y(), -p.z())};
}

/// Signed steps from pixel q along p to the outermost solid voxel of its run; beyond `limit` steps
/// where there is none within it.
int trace_column(const Workpiece& workpiece, const Cell& q, const Eigen::Vector3i& p, int limit) {
  if (workpiece.solid(q)) {
    int z = 0;
    while (z <= limit && workpiece.solid(q + (z + 1) * p)) ++z;
    return z;
  }
  int z = -1;
  while (z >= -limit && !workpiece.solid(q + z * p)) --z;
  return z;
}

}  // namespace

SurfaceEstimate estimate_ldm_paper(const Workpiece& workpiece, const Cell& voxel, int neighbourhood,
                                   int trace) noexcept {
  const Eigen::Vector3i direction = projection_directions()[exposed_faces(workpiece, voxel)];
  if ((direction.array() == 0).all()) return {};
  const MapFrame frame = frame_of(direction);
  const float step_length = std::sqrt(static_cast<float>(direction.squaredNorm()));
  const int limit = static_cast<int>(static_cast<float>(trace) / step_length);

  const Eigen::Vector3f u = frame.u.cast<float>(), v = frame.v.cast<float>();
  const float uu = u.dot(u), uv = u.dot(v), vv = v.dot(v);
  // Moments of the accepted rings, in lattice coordinates: z ~ a . x with x = i u + j v has
  // sum w z x = (sum w x x^T) a, w = 1/|x|^2 [eqs. 3, 4]. The centre has z = 0 by construction.
  float m_uu = 0, m_uv = 0, m_vv = 0, b_u = 0, b_v = 0;
  for (int ring = 1; ring <= neighbourhood; ++ring) {
    float r_uu = 0, r_uv = 0, r_vv = 0, s_u = 0, s_v = 0;
    bool accepted = true;
    for (int j = -ring; j <= ring && accepted; ++j) {
      const int stride = std::abs(j) == ring ? 1 : 2 * ring;
      for (int i = -ring; i <= ring; i += stride) {
        const int z = trace_column(workpiece, voxel + i * frame.u + j * frame.v, frame.p, limit);
        if (std::abs(z) > limit) {
          accepted = false;
          break;
        }
        const auto fi = static_cast<float>(i), fj = static_cast<float>(j);
        const float xu = fi * uu + fj * uv, xv = fi * uv + fj * vv;  // x . u, x . v
        const float w = 1.0f / (fi * xu + fj * xv);                  // 1 / |x|^2
        const float wz = w * static_cast<float>(z) * step_length;
        r_uu += w * fi * fi;
        r_uv += w * fi * fj;
        r_vv += w * fj * fj;
        s_u += wz * fi;
        s_v += wz * fj;
      }
    }
    if (!accepted) break;
    m_uu += r_uu;
    m_uv += r_uv;
    m_vv += r_vv;
    b_u += s_u;
    b_v += s_v;
  }

  Eigen::Vector3f normal = direction.cast<float>() / step_length;
  const float det = m_uu * m_vv - m_uv * m_uv;
  if (det > 0) {
    // Slopes along i and j, then the gradient as a vector of the plane: its dot products with u
    // and v are those slopes.
    const float slope_i = (m_vv * b_u - m_uv * b_v) / det;
    const float slope_j = (m_uu * b_v - m_uv * b_u) / det;
    const float gram = uu * vv - uv * uv;
    normal -= ((vv * slope_i - uv * slope_j) / gram) * u +
              ((uu * slope_j - uv * slope_i) / gram) * v;  // eq. 5
  }
  return {normal / std::sqrt(normal.squaredNorm()), 0.0f, true};
}

}  // namespace sulcus
