// The burr's distance field for many points at a time, and the vectors of contact_loops.inl.
// Written once and compiled for each instruction set.

#include "engine/core/lanes.hpp"
#include "haptics/contact/contact_frame.hpp"

namespace sulcus {

namespace {

struct Lanes3 {
  Lanes x, y, z;
};
inline Lanes3 operator+(const Lanes3& a, const Lanes3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Lanes3 operator*(const Lanes3& a, const Lanes& s) { return {a.x * s, a.y * s, a.z * s}; }
inline Lanes dot(const Lanes3& a, const Lanes3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Lanes3 cross(const Lanes3& a, const Lanes3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Lanes3 constant(const float (&v)[3]) {
  return {Lanes{} + v[0], Lanes{} + v[1], Lanes{} + v[2]};
}
inline Lanes lerp(const Lanes& a, const Lanes& b, const Lanes& t) { return a + t * (b - a); }

/// A nearest cell of the field, and where the point lies from it: DistanceField's locate.
struct CellLanes {
  IntLanes offset;      // of the lower of its samples that are kept along x, the low one along z
  IntLanes mirrored_x;  // where the lower of the two is the high one
  IntLanes to_z;        // from a low sample to a high one
  Lanes3 t, beyond;
};
inline CellLanes locate(const ContactFrame& f, const Lanes3& p) {
  CellLanes cell{};
  const auto along = [&](int a, const Lanes& v, Lanes& t, Lanes& beyond) {
    // A NaN becomes 0: the memory read stays in the box, `beyond` carries the NaN.
    const Lanes inside = smaller(Lanes{} + f.last[a], larger(Lanes{}, v));
    beyond = v - inside;
    IntLanes i = to_int(inside);
    const IntLanes most = IntLanes{} + f.most[a];
    i = i < most ? i : most;
    t = inside - to_float(i);
    return i;
  };
  const IntLanes x = along(0, p.x, cell.t.x, cell.beyond.x);
  const IntLanes y = along(1, p.y, cell.t.y, cell.beyond.y);
  const IntLanes z = along(2, p.z, cell.t.z, cell.beyond.z);
  cell.mirrored_x = x > f.most_kept[0];
  const IntLanes mirrored_z = z > f.most_kept[2];
  cell.to_z = mirrored_z ? IntLanes{} - f.slice : IntLanes{} + f.slice;
  cell.offset = (cell.mirrored_x ? f.most[0] - x : x) + y * f.row +
                (mirrored_z ? f.most[2] + 1 - z : z) * f.slice;
  return cell;
}

/// The eight corners of a cell in each lane: [z][y][x].
struct Corners {
  Lanes of[8];
};
inline Corners corners(const ContactFrame& f, const CellLanes& cell) {
  // What is stored lane by lane cannot be loaded as a whole at once.
  alignas(64) std::int32_t at[2][kLaneCount];
  store(cell.offset, at[0]);
  store(cell.offset + cell.to_z, at[1]);
  Corners c;
#ifdef __AVX2__
  // Two neighbours in x at once.
  const auto two = [](const float* p, const float* q) {
    return _mm_loadh_pi(_mm_loadl_pi(_mm_setzero_ps(), reinterpret_cast<const __m64*>(p)),
                        reinterpret_cast<const __m64*>(q));
  };
  // Of lanes `lane` and the next in each four.
  const auto load_pairs = [&](const float* v, const std::int32_t* lane) {
    const auto eight = [&](const std::int32_t* from) {
      return _mm256_set_m128(two(v + from[4], v + from[5]), two(v + from[0], v + from[1]));
    };
#if SULCUS_LANES == 16
    return _mm512_insertf32x8(_mm512_castps256_ps512(eight(lane)), eight(lane + 8), 1);
#else
    return eight(lane);
#endif
  };
  const auto edge = [&](const float* v, const std::int32_t* lanes, Lanes* lower) {
    const Lanes a = load_pairs(v, lanes), b = load_pairs(v, lanes + 2);
    lower[0] = SULCUS_WIDE(shuffle_ps)(a, b, 0x88);
    lower[1] = SULCUS_WIDE(shuffle_ps)(a, b, 0xdd);
  };
#else
  const auto edge = [](const float* v, const std::int32_t* lanes, Lanes* lower) {
    alignas(32) float pair[2][kLaneCount];
    for (int lane = 0; lane < kLaneCount; ++lane) {
      pair[0][lane] = v[lanes[lane]], pair[1][lane] = v[lanes[lane] + 1];
    }
    lower[0] = load(pair[0]), lower[1] = load(pair[1]);
  };
#endif
  for (int z = 0; z < 2; ++z) {
    edge(f.values, at[z], c.of + 4 * z);
    edge(f.values + f.row, at[z], c.of + 4 * z + 2);
  }
  for (int k = 0; k < 8; k += 2) {
    const Lanes lower = c.of[k], upper = c.of[k + 1];
    c.of[k] = cell.mirrored_x ? upper : lower;
    c.of[k + 1] = cell.mirrored_x ? lower : upper;
  }
  return c;
}

/// Distance and gradient (tool axes) at points of field space: the bits of
/// DistanceField::sample_with_gradient.
[[gnu::always_inline]] inline Lanes sample(const ContactFrame& f, const Lanes3& p,
                                           Lanes3& gradient) {
  const CellLanes cell = locate(f, p);
  const Corners v = corners(f, cell);
  const Lanes3& t = cell.t;
  const Lanes x00 = lerp(v.of[0], v.of[1], t.x), x10 = lerp(v.of[2], v.of[3], t.x);
  const Lanes x01 = lerp(v.of[4], v.of[5], t.x), x11 = lerp(v.of[6], v.of[7], t.x);
  const Lanes y0 = lerp(x00, x10, t.y), y1 = lerp(x01, x11, t.y);
  const Lanes dx = lerp(lerp(v.of[1] - v.of[0], v.of[3] - v.of[2], t.y),
                        lerp(v.of[5] - v.of[4], v.of[7] - v.of[6], t.y), t.z);
  const Lanes dy = lerp(x10 - x00, x11 - x01, t.z);
  const float per_m = 1.0f / f.spacing_m;
  gradient = Lanes3{dx, dy, y1 - y0} * (Lanes{} + per_m);
  const Lanes inside = lerp(y0, y1, t.z);
  const Lanes squared = dot(cell.beyond, cell.beyond);
  if (!any(squared != 0.0f)) return inside;
  // Beyond a face the box's value no longer changes along its normal; the way there does.
  const Lanes beyond_m = square_root(squared) * f.spacing_m;
  const Lanes length = beyond_m * per_m;
  const auto turn = [&](const Lanes& beyond, Lanes& g) {
    g = beyond != 0.0f ? beyond / length : g;
  };
  turn(cell.beyond.x, gradient.x), turn(cell.beyond.y, gradient.y);
  turn(cell.beyond.z, gradient.z);
  return inside + beyond_m;
}

/// The value alone, never larger than the distance. Outside its box the field is the value at the
/// nearest point of the box plus the way there; the burr lies aslant of that way, so that the two
/// are the legs of the distance, not its parts.
inline Lanes least_distance(const ContactFrame& f, const Lanes3& p) {
  const CellLanes cell = locate(f, p);
  const Corners v = corners(f, cell);
  const Lanes3& t = cell.t;
  const Lanes y0 = lerp(lerp(v.of[0], v.of[1], t.x), lerp(v.of[2], v.of[3], t.x), t.y);
  const Lanes y1 = lerp(lerp(v.of[4], v.of[5], t.x), lerp(v.of[6], v.of[7], t.x), t.y);
  const Lanes value = lerp(y0, y1, t.z);
  const Lanes squared = dot(cell.beyond, cell.beyond) * (f.spacing_m * f.spacing_m);
  return value > 0.0f ? square_root(value * value + squared) : value;
}

/// Voxels from the frame's own, by key.
inline Lanes3 voxels(const ContactFrame& f, const std::uint32_t* keys) {
  const IntLanes key = load(reinterpret_cast<const std::int32_t*>(keys));
  return {to_float((key & 1023) - f.cell[0]), to_float((key >> 10 & 1023) - f.cell[1]),
          to_float((key >> 20 & 1023) - f.cell[2])};
}
inline Lanes3 field_from_voxels(const ContactFrame& f, const Lanes3& d) {
  const auto along = [&](int a) {
    return f.base[a] + (d.x * f.step[a][0] + d.y * f.step[a][1] + d.z * f.step[a][2]);
  };
  return {along(0), along(1), along(2)};
}
inline Lanes3 to_world(const ContactFrame& f, const Lanes3& v) {
  const auto row = [&](int a) {
    return v.x * f.world_from_tool[a][0] + v.y * f.world_from_tool[a][1] +
           v.z * f.world_from_tool[a][2];
  };
  return {row(0), row(1), row(2)};
}

}  // namespace

}  // namespace sulcus
