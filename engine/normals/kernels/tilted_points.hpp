// The points of a map in a ball, in a frame tilted, and sums over them: loops of map_kernels.hpp,
// as surface_group.hpp.

#pragma once

#include "engine/normals/kernels/simd.hpp"
#include "engine/normals/map_kernels.hpp"

namespace sulcus {

namespace {

/// Appends the lanes in a mask; beyond them a row's may be written.
class PointWriter {
 public:
  explicit PointWriter(TiltedPoints& points) : points_(points) {}

  void append(const RowMask& mask, const RowLanes& weight, const RowLanes& u, const RowLanes& w,
              const RowLanes& n) {
#if defined(__AVX512F__)
    const auto put = [&](const RowLanes& v, float* to) {
      _mm512_storeu_ps(to + count_, _mm512_maskz_compress_ps(mask, v));
    };
    put(weight, points_.weight), put(u, points_.u), put(w, points_.w), put(n, points_.n);
#elif defined(__AVX2__)
    const __m256i from = to_front(bits_of(mask));
    const auto put = [&](const RowLanes& v, float* to) {
      store(_mm256_permutevar8x32_ps(v, from), to + count_);
    };
    put(weight, points_.weight), put(u, points_.u), put(w, points_.w), put(n, points_.n);
#else
    for (int lane = 0, to = count_; lane < kRowStep; ++lane) {
      if (mask[lane] == 0) continue;
      points_.weight[to] = weight[lane], points_.u[to] = u[lane];
      points_.w[to] = w[lane], points_.n[to] = n[lane];
      ++to;
    }
#endif
    count_ += count_of(mask);
  }
  void finish() {
    for (int k = 0; k < TiltedPoints::kTogether; k += kLaneCount) {
      store(Lanes{}, points_.weight + count_ + k), store(Lanes{}, points_.u + count_ + k);
      store(Lanes{}, points_.w + count_ + k), store(Lanes{}, points_.n + count_ + k);
    }
    points_.count = count_;
  }

 private:
  TiltedPoints& points_;
  int count_ = 0;
};

template <bool kHasSide>
inline void gather(const HeightMap& map, const TiltedFrame& frame, TiltedPoints& points) {
  const float radius = frame.radius, unit = 1.0f / radius;
  const int reach = radius < static_cast<float>(map.ns) ? static_cast<int>(radius) : map.ns;
  const int middle = map.lanes / 2, first = (middle - reach) & -kRowStep;
  const float limit = radius * radius, fall = 1.0f / (1.05f * limit);
  // By value: what is stored below could be what a reference refers to.
  const auto [u0, u1, u2] = frame.u;
  const auto [w0, w1, w2] = frame.w;
  const auto [n0, n1, n2] = frame.n;
  const int lanes = map.lanes;
  const auto sign = static_cast<float>(map.sign);
  const MapSide side = frame.side;
  // What the columns of all rows have in common.
  struct Along {
    RowLanes xx, u, w, n, behind;  // by so much behind a side whose other half is at zero
  };
  Along along[HeightMap::kMaxLanes / kRowStep];
  int parts = 0;
  for (int at = first; at <= middle + reach; at += kRowStep, ++parts) {
    const RowLanes x = kLaneIndex + static_cast<float>(at - middle);
    along[parts] = {x * x, x * (u0 * unit), x * (w0 * unit), x * (n0 * unit),
                    -(x * side.x) - side.behind};
  }
  PointWriter writer(points);
  const auto* row = map.height.begin() + (map.ns - reach) * lanes + first;
  for (int j = -reach; j <= reach; ++j, row += lanes) {
    const auto y = static_cast<float>(j);
    const float yy = y * y, y_unit = y * unit, y_u = y_unit * u1, y_w = y_unit * w1,
                y_n = y_unit * n1;
    for (int part = 0; part < parts; ++part) {
      const auto& [xx, x_u, x_w, x_n, behind] = along[part];
      // The surface is half a voxel beyond the centre of the outermost solid voxel.
      const RowLanes z = heights(row + part * kRowStep) * sign + 0.5f, z_unit = z * unit;
      const RowLanes r2 = xx + yy + z * z;
      // kNone is far out of every ball.
      RowMask in = at_most(r2, limit);
      if constexpr (kHasSide) in = bits_and(in, at_most(behind, y * side.y));
      writer.append(in, 1.0f - r2 * fall, x_u + y_u + z_unit * u2, x_w + y_w + z_unit * w2,
                    x_n + y_n + z_unit * n2);
    }
  }
  writer.finish();
}
inline void gather_points(const HeightMap& map, const TiltedFrame& frame,
                          TiltedPoints& points) noexcept {
  const bool has_side = frame.side.x != 0.0f || frame.side.y != 0.0f;
  has_side ? gather<true>(map, frame, points) : gather<false>(map, frame, points);
}

/// Sixteen sums side by side, over points that are taken sixteen at a time: all at once, or those
/// of the first eight of each sixteen and of the second. `from` is 0, then 8.
template <std::size_t kSums, class Add>
inline std::array<float, kSums> sum_points(const TiltedPoints& points, const Add& add) {
  std::array<Lanes, kSums> total;
  for (int from = 0; from < TiltedPoints::kTogether; from += kRowStep) {
    RowLanes sums[kSums]{};
    for (int k = from; k < points.count; k += TiltedPoints::kTogether) add(k, sums);
#pragma GCC unroll 16
    for (std::size_t f = 0; f < kSums; ++f) {
      if (from == 0) {
        total.begin()[f] = halves_of(sums[f]);
      } else {
        add_row(total.begin()[f], sums[f]);
      }
    }
  }
  return sum_all(total);
}

// In two passes: the sums of one take all the registers there are.
inline void tilted_moments(const TiltedPoints& points, TiltedMoments& moments) noexcept {
  const TiltedPoints& p = points;
  auto& m = moments.m;
  auto& z = moments.z;
  const auto low = sum_points<12>(p, [&](int k, RowLanes* s) {
    const RowLanes weight = load_row(p.weight + k), u = load_row(p.u + k), w = load_row(p.w + k),
                   n = load_row(p.n + k);
    const RowLanes w1 = weight * w, u1 = weight * u, w2 = w1 * w, uw = u1 * w, u2 = u1 * u;
    s[0] += weight, s[1] += w1, s[2] += w2, s[3] += u1, s[4] += uw, s[5] += u2;
    s[6] += weight * n, s[7] += w1 * n, s[8] += w2 * n;
    s[9] += u1 * n, s[10] += uw * n, s[11] += u2 * n;
  });
  m[0][0] = low[0], m[0][1] = low[1], m[0][2] = low[2];
  m[1][0] = low[3], m[1][1] = low[4], m[2][0] = low[5];
  z[0][0] = low[6], z[0][1] = low[7], z[0][2] = low[8];
  z[1][0] = low[9], z[1][1] = low[10], z[2][0] = low[11];
  const auto high = sum_points<9>(p, [&](int k, RowLanes* s) {
    const RowLanes weight = load_row(p.weight + k), u = load_row(p.u + k), w = load_row(p.w + k);
    const RowLanes w2 = weight * w * w, w3 = w2 * w, uw2 = w2 * u;
    const RowLanes u2 = weight * u * u, u3 = u2 * u, u2w = u2 * w;
    s[0] += w3, s[1] += w3 * w, s[2] += uw2, s[3] += uw2 * w;
    s[4] += u2w, s[5] += u2w * w, s[6] += u3, s[7] += u3 * w, s[8] += u3 * u;
  });
  m[0][3] = high[0], m[0][4] = high[1], m[1][2] = high[2], m[1][3] = high[3];
  m[2][1] = high[4], m[2][2] = high[5];
  m[3][0] = high[6], m[3][1] = high[7], m[4][0] = high[8];
}

inline RowLanes residual_of(const TiltedPoints& p, int k, const Quadric& c) {
  const RowLanes u = load_row(p.u + k), w = load_row(p.w + k);
  return load_row(p.n + k) - (c[0] + (c[1] + c[3] * u + c[4] * w) * u + (c[2] + c[5] * w) * w);
}

inline void tilted_residuals(const TiltedPoints& points, const Quadric& c,
                             Residuals& residuals) noexcept {
  RowLanes largest{};
  const auto squares = sum_points<1>(points, [&](int k, RowLanes* s) {
    const RowLanes r = where(above(load_row(points.weight + k), 0.0f), residual_of(points, k, c));
    largest = larger(largest, abs(r));
    s[0] += r * r;
  });
  residuals.largest = largest_of(largest);
  residuals.sum_squares = squares[0];
}

inline void sharpen_points(const Quadric& c, TiltedPoints& points) noexcept {
  for (int k = 0; k < points.count; k += kRowStep) {
    const RowLanes r = residual_of(points, k, c);
    store_row(load_row(points.weight + k) * r * r, points.weight + k);
    store_row(r, points.n + k);
  }
}

}  // namespace

}  // namespace sulcus
