#include "engine/normals/column_quadric.hpp"

#include <cmath>

#include "engine/normals/quadric_filter.hpp"

namespace sulcus {

namespace {

/// Fills in what follows from slopes and curvatures.
void complete(ColumnQuadric& q) noexcept {
  const Quadric& c = q.c;
  const float g2 = 1.0f / (1.0f + c[1] * c[1] + c[2] * c[2]);
  q.t_x = g2 * (2.0f * c[3] * c[1] + c[4] * c[2]);
  q.t_y = g2 * (c[4] * c[1] + 2.0f * c[5] * c[2]);
  q.quartic = 0.5f * g2 * (q.t_x * c[1] + q.t_y * c[2]);
}

}  // namespace

ColumnQuadric column_quadric(const Quadric& fitted, const QuadricFilter& filter,
                             int stride) noexcept {
  // From columns to voxels; so are the filter's answers to powers.
  const float one = static_cast<float>(stride), per = 1.0f / one;
  const Quadric raw{fitted[0],
                    fitted[1] * per,
                    fitted[2] * per,
                    fitted[3] * per * per,
                    fitted[4] * per * per,
                    fitted[5] * per * per};
  const FilterAnswers& a = filter.answers;
  const float second = one * one, fourth = second * second;

  ColumnQuadric q;
  q.c = raw;
  complete(q);
  for (int pass = 0; pass < 2; ++pass) {
    const Quadric& c = q.c;
    const float tx = q.t_x, ty = q.t_y, k = q.quartic;
    const float x3 = c[3] * tx, x2y = c[3] * ty + c[4] * tx;
    const float xy2 = c[5] * tx + c[4] * ty, y3 = c[5] * ty;
    const float txx = tx * tx, txy = 2.0f * tx * ty, tyy = ty * ty;
    const float x4 = c[3] * (txx + k * c[3]);
    const float x3y = c[3] * txy + c[4] * (txx + 2.0f * k * c[3]);
    const float x2y2 = c[3] * tyy + c[4] * (txy + k * c[4]) + c[5] * (txx + 2.0f * k * c[3]);
    const float xy3 = c[5] * txy + c[4] * (tyy + 2.0f * k * c[5]);
    const float y4 = c[5] * (tyy + k * c[5]);
    const Quadric next{raw[0] - fourth * (a.value_x4 * (x4 + y4) + a.value_x2y2 * x2y2),
                       raw[1] - second * (a.slope_x3 * x3 + a.slope_xy2 * xy2),
                       raw[2] - second * (a.slope_x3 * y3 + a.slope_xy2 * x2y),
                       raw[3] - second * (a.bend_x4 * x4 + a.bend_x2y2 * x2y2 + a.bend_y4 * y4),
                       raw[4] - second * a.twist_x3y * (x3y + xy3),
                       raw[5] - second * (a.bend_x4 * y4 + a.bend_x2y2 * x2y2 + a.bend_y4 * x4)};
    q.c = next;
    complete(q);
  }
  return q;
}

Foot foot_of(const ColumnQuadric& q) noexcept {
  const Quadric& c = q.c;
  float x = 0.0f, y = 0.0f;
  for (int step = 0;; ++step) {
    const float z2 = (c[3] * x + c[4] * y) * x + c[5] * y * y;
    const float more = 1.0f + q.t_x * x + q.t_y * y;
    const float z = c[0] + c[1] * x + c[2] * y + z2 * more;
    const float slope_x = c[1] + (2.0f * c[3] * x + c[4] * y) * more + z2 * q.t_x;
    const float slope_y = c[2] + (c[4] * x + 2.0f * c[5] * y) * more + z2 * q.t_y;
    const float shrink2 = 1.0f / (1.0f + slope_x * slope_x + slope_y * slope_y);
    const float above = z - slope_x * x - slope_y * y;  // of the tangent plane, at the origin
    if (step == 2) {
      const float shrink = std::sqrt(shrink2);
      return {{-slope_x * shrink, -slope_y * shrink, shrink}, above * shrink};
    }
    x = -above * shrink2 * slope_x;
    y = -above * shrink2 * slope_y;
  }
}

}  // namespace sulcus
