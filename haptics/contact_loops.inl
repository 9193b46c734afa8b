// The loops of contact_kernels.hpp, written once and compiled for each instruction set by the files
// that include this.

#include "engine/core/lanes.hpp"
#include "haptics/contact_kernels.hpp"

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

/// Lanes of the first `count`.
alignas(64) constexpr std::int32_t kLaneNumbers[16] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                       8, 9, 10, 11, 12, 13, 14, 15};
inline IntLanes among(std::size_t count) {
  return load(kLaneNumbers) < static_cast<std::int32_t>(count);
}

/// A nearest cell of the field, and where the point lies from it: DistanceField's locate.
struct CellLanes {
  IntLanes offset;
  Lanes3 t, beyond;
};
inline CellLanes locate(const ContactFrame& f, const Lanes3& p) {
  CellLanes cell{};
  const auto along = [&](int a, const Lanes& v, Lanes& t, Lanes& beyond, std::int32_t pitch) {
    // A NaN becomes 0: the memory read stays in the box, `beyond` carries the NaN.
    const Lanes inside = smaller(Lanes{} + f.last[a], larger(Lanes{}, v));
    beyond = v - inside;
    IntLanes i = to_int(inside);
    const IntLanes most = IntLanes{} + f.most[a];
    i = i < most ? i : most;
    t = inside - to_float(i);
    cell.offset += i * pitch;
  };
  along(0, p.x, cell.t.x, cell.beyond.x, 1);
  along(1, p.y, cell.t.y, cell.beyond.y, f.row);
  along(2, p.z, cell.t.z, cell.beyond.z, f.slice);
  return cell;
}

/// The eight corners of a cell in each lane: [z][y][x].
struct Corners {
  Lanes of[8];
};
inline Corners corners(const ContactFrame& f, const IntLanes& offset) {
#ifdef __AVX2__
  // Two neighbours in x at once; what is stored lane by lane cannot be loaded as a whole at once.
  alignas(64) std::int32_t at[kLaneCount];
  store(offset, at);
  const auto two = [](const float* p, const float* q) {
    return _mm_loadh_pi(_mm_loadl_pi(_mm_setzero_ps(), reinterpret_cast<const __m64*>(p)),
                        reinterpret_cast<const __m64*>(q));
  };
  // Of lanes `lane` and the next in each four.
  const auto twos = [&](const float* v, int lane) {
    const auto eight = [&](const std::int32_t* from) {
      return _mm256_set_m128(two(v + from[4], v + from[5]), two(v + from[0], v + from[1]));
    };
#if SULCUS_LANES == 16
    return _mm512_insertf32x8(_mm512_castps256_ps512(eight(at + lane)), eight(at + lane + 8), 1);
#else
    return eight(at + lane);
#endif
  };
  const auto edge = [&](const float* v, Lanes& low, Lanes& high) {
    const Lanes a = twos(v, 0), b = twos(v, 2);
    low = SULCUS_WIDE(shuffle_ps)(a, b, 0x88);
    high = SULCUS_WIDE(shuffle_ps)(a, b, 0xdd);
  };
  Corners c;
  edge(f.values, c.of[0], c.of[1]);
  edge(f.values + f.row, c.of[2], c.of[3]);
  edge(f.values + f.slice, c.of[4], c.of[5]);
  edge(f.values + f.slice + f.row, c.of[6], c.of[7]);
  return c;
#else
  alignas(32) float v[8][kLaneCount];
  for (int lane = 0; lane < kLaneCount; ++lane) {
    const float* c = f.values + offset[lane];
    v[0][lane] = c[0], v[1][lane] = c[1];
    v[2][lane] = c[f.row], v[3][lane] = c[f.row + 1];
    c += f.slice;
    v[4][lane] = c[0], v[5][lane] = c[1];
    v[6][lane] = c[f.row], v[7][lane] = c[f.row + 1];
  }
  Corners all;
  for (int k = 0; k < 8; ++k) all.of[k] = load(v[k]);
  return all;
#endif
}

/// Distance and gradient (tool axes) at points of field space: the bits of
/// DistanceField::sample_with_gradient.
[[gnu::always_inline]] inline Lanes sample(const ContactFrame& f, const Lanes3& p,
                                           Lanes3& gradient) {
  const CellLanes cell = locate(f, p);
  const Corners v = corners(f, cell.offset);
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
  const Corners v = corners(f, cell.offset);
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

/// Appends what a mask keeps of a group of keys and four numbers each to arrays that have room for
/// a whole group more; returns how many.
inline std::size_t append(const IntLanes& mask, const std::uint32_t* keys, const Lanes (&values)[4],
                          std::uint32_t* to_keys, float* const (&to)[4]) {
#if SULCUS_LANES == 16
  // To a register, and from there: compressing to memory is slow on some.
  const auto kept = static_cast<__mmask16>(bits_of(mask));
  _mm512_storeu_si512(to_keys, _mm512_maskz_compress_epi32(kept, _mm512_loadu_si512(keys)));
  for (int q = 0; q < 4; ++q) _mm512_storeu_ps(to[q], _mm512_maskz_compress_ps(kept, values[q]));
  return static_cast<std::size_t>(__builtin_popcount(kept));
#elif defined(__AVX2__)
  const unsigned kept = bits_of(mask);
  const __m256i order = to_front(kept);
  const auto from = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(keys));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to_keys),
                      _mm256_permutevar8x32_epi32(from, order));
  for (int q = 0; q < 4; ++q) _mm256_storeu_ps(to[q], _mm256_permutevar8x32_ps(values[q], order));
  return static_cast<std::size_t>(__builtin_popcount(kept));
#else
  std::size_t n = 0;
  for (int lane = 0; lane < kLaneCount; ++lane) {
    if (mask[lane] == 0) continue;
    to_keys[n] = keys[lane];
    for (int q = 0; q < 4; ++q) to[q][n] = values[q][lane];
    ++n;
  }
  return n;
#endif
}

inline std::size_t leaf_keys_of(const LeafBits& voxels, std::uint32_t first_key,
                                std::uint32_t* keys) noexcept {
  std::uint32_t* out = keys;
  for (int k = 0; k < kLeafEdge; ++k) {
    const std::uint64_t word = voxels.words.begin()[k];
    const std::uint32_t slice = first_key + voxel_key(0, 0, k);
#if SULCUS_LANES == 16
    constexpr auto kNextRow = static_cast<std::int32_t>(voxel_key(0, 1, 0));
    alignas(64) std::uint8_t bits[64];
    for (int bit = 0; bit < 64; ++bit) bits[bit] = static_cast<std::uint8_t>(bit);
    _mm512_store_si512(bits, _mm512_maskz_compress_epi8(word, _mm512_load_si512(bits)));
    const int count = __builtin_popcountll(word);
    for (int done = 0; done < count; done += kLaneCount) {
      const auto bit = reinterpret_cast<IntLanes>(
          _mm512_cvtepu8_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(bits + done))));
      store((bit & 7) + (bit >> 3) * kNextRow + static_cast<std::int32_t>(slice),
            reinterpret_cast<std::int32_t*>(out + done));
    }
    out += count;
#else
    for (std::uint64_t rest = word; rest != 0; rest &= rest - 1) {
      const int bit = __builtin_ctzll(rest);
      *out++ = slice + voxel_key(bit & 7, bit >> 3, 0);
    }
#endif
  }
  return static_cast<std::size_t>(out - keys);
}

inline std::size_t find_near(const ContactFrame& frame, const std::uint32_t* keys,
                             std::size_t count, float reach_m, std::uint32_t* to_keys,
                             float* to_distance_m, float* const to_outward[3]) noexcept {
  std::size_t found = 0;
  for (std::size_t k = 0; k < count; k += kLaneCount) {
    Lanes3 gradient;
    const Lanes3 p = field_from_voxels(frame, voxels(frame, keys + k));
    const Lanes distance_m = sample(frame, p, gradient);
    const Lanes3 away = to_world(frame, gradient);
    const IntLanes near = (distance_m < reach_m) & among(count - k);
    float* const to[4] = {to_distance_m + found, to_outward[0] + found, to_outward[1] + found,
                          to_outward[2] + found};
    found += append(near, keys + k, {distance_m, -away.x, -away.y, -away.z}, to_keys + found, to);
  }
  return found;
}

inline void leaf_distances_of(const ContactFrame& frame, const std::uint32_t* keys,
                              std::size_t count, float* distance_m) noexcept {
  constexpr float kCentre = 0.5f * (kLeafEdge - 1);
  for (std::size_t k = 0; k < count; k += kLaneCount) {
    const Lanes3 first = voxels(frame, keys + k);
    const Lanes3 centre{first.x + kCentre, first.y + kCentre, first.z + kCentre};
    store(least_distance(frame, field_from_voxels(frame, centre)), distance_m + k);
  }
}

template <class Arrays>
inline Lanes3 load3(const Arrays& arrays, std::size_t q, std::size_t k) {
  return {load(arrays.of[q] + k), load(arrays.of[q + 1] + k), load(arrays.of[q + 2] + k)};
}
inline void store3(const Lanes3& v, const ContactArrays& contacts, Contacts::Quantity q,
                   std::size_t k) {
  store(v.x, contacts.of[q] + k), store(v.y, contacts.of[q + 1] + k);
  store(v.z, contacts.of[q + 2] + k);
}

/// Four numbers that lie together for each lane, number by number.
struct Fours {
  Lanes of[4];
};
inline Fours fours(const float* const* from) {
#ifdef __AVX2__
  const auto each_fourth = [&](int lane) {  // and the ones four and more on
    const auto eight = [&](const float* const* p) {
      return _mm256_set_m128(_mm_loadu_ps(p[4]), _mm_loadu_ps(p[0]));
    };
#if SULCUS_LANES == 16
    return _mm512_insertf32x8(_mm512_castps256_ps512(eight(from + lane)), eight(from + lane + 8),
                              1);
#else
    return eight(from + lane);
#endif
  };
  const Lanes r0 = each_fourth(0), r1 = each_fourth(1), r2 = each_fourth(2), r3 = each_fourth(3);
  const Lanes low01 = SULCUS_WIDE(unpacklo_ps)(r0, r1), high01 = SULCUS_WIDE(unpackhi_ps)(r0, r1),
              low23 = SULCUS_WIDE(unpacklo_ps)(r2, r3), high23 = SULCUS_WIDE(unpackhi_ps)(r2, r3);
  return {{SULCUS_WIDE(shuffle_ps)(low01, low23, 0x44), SULCUS_WIDE(shuffle_ps)(low01, low23, 0xee),
           SULCUS_WIDE(shuffle_ps)(high01, high23, 0x44),
           SULCUS_WIDE(shuffle_ps)(high01, high23, 0xee)}};
#else
  Fours all;
  for (int lane = 0; lane < kLaneCount; ++lane) {
    for (int q = 0; q < 4; ++q) all.of[q][lane] = from[lane][q];
  }
  return all;
#endif
}

inline std::uint64_t take_kept(const float* const (&kept)[kKeptBlock], std::size_t count,
                               float voxel_m, const ContactArrays& contacts,
                               const BlockArrays& block, std::size_t first) noexcept {
  std::uint64_t away = 0;
  for (std::size_t k = 0; k < count; k += kLaneCount) {
    const Fours v = fours(kept + k);
    const Lanes3 normal{v.of[0], v.of[1], v.of[2]};
    store3(normal, contacts, Contacts::kNormal, first + k);
    store(v.of[3] * voxel_m, block.of[ContactBlock::kOffset] + first + k);
    const Lanes3 outward = load3(block, ContactBlock::kOutward, first + k);
    const Lanes agree = normal.x * outward.x + (normal.y * outward.y + normal.z * outward.z);
    const IntLanes vetoed = ~(agree > 0.0f) & (dot(normal, normal) > 0.0f);
    away |= std::uint64_t{bits_of(vetoed)} << k;
  }
  return away;
}

inline DoubleLanes load(const double (&sums)[kSumLanes]) {
  DoubleLanes v;
  __builtin_memcpy(&v, sums, sizeof v);
  return v;
}
inline void store(const DoubleLanes& v, double (&sums)[kSumLanes]) {
  __builtin_memcpy(sums, &v, sizeof v);
}

inline void measure_all(const ContactFrame& frame, const ForceSettings& settings,
                        const ContactArrays& contacts, const BlockArrays& block,
                        MeasureLanes& lanes) noexcept {
  const float half_voxel_m = 0.5f * frame.voxel_m, per_voxel = 1.0f / frame.voxel_m;
  const float full_cosine = 1.0f / settings.fade_below;
  const bool spreads = settings.at_surface && settings.spread_reach_m > 0.0f;
  DoubleLanes weights = load(lanes.weights), near_sum = load(lanes.near), normal_sums[3],
              product_sums[6];
  for (int a = 0; a < 3; ++a) normal_sums[a] = load(lanes.normal[a]);
  for (int entry = 0; entry < 6; ++entry) product_sums[entry] = load(lanes.products[entry]);
  IntLanes counts{};
  for (std::size_t k = 0; k < contacts.size; k += kLaneCount) {
    const Lanes3 d = voxels(frame, contacts.keys + k);
    Lanes3 normal = load3(contacts, Contacts::kNormal, k);
    const Lanes distance_m = load(block.of[ContactBlock::kDistance] + k);
    const IntLanes known = dot(normal, normal) > 0.0f;
    const IntLanes there = among(contacts.size - k);  // what fills up the last group weighs nothing
    // Voxels from the frame's to where depth is measured: from the centre along the normal.
    Lanes along = settings.at_surface
                      ? where(known, load(block.of[ContactBlock::kOffset] + k) * per_voxel)
                      : Lanes{};
    Lanes depth = -distance_m;
    Lanes weight;
    if (settings.at_surface || any(~known)) {
      Lanes3 gradient;
      const Lanes3 p = field_from_voxels(frame, d + normal * along);
      const Lanes value = sample(frame, p, gradient);
      const Lanes3 away = to_world(frame, gradient);
      const Lanes length = square_root(dot(away, away));
      const IntLanes tells = length > 0.0f;
      // Where the method gives no normal the tool's is taken, and the voxel's own face.
      const Lanes turned = where(tells, -1.0f / length);
      Lanes cosine = tells ? -dot(normal, away) / length : Lanes{} + 1.0f;
      cosine = known ? cosine : Lanes{} + 1.0f;
      const Lanes3 given = normal + away * turned;
      normal = {known ? normal.x : given.x, known ? normal.y : given.y, known ? normal.z : given.z};
      if (settings.at_surface) {
        depth = known ? -value : half_voxel_m - value;
        along = known ? along : Lanes{} + 0.5f;
      }
      // Neither the tooth nor the tool knows a direction here.
      depth = where(known | tells, depth);
      along = where(known | tells, along);
      if (settings.at_surface) {
        const Lanes fade = smaller(Lanes{} + 1.0f, cosine * full_cosine);
        weight = where(there & (depth > 0.0f) & (cosine > 0.0f), depth * per_voxel * fade);
        if (spreads) {
          store3(away * where(tells, -1.0f / length), contacts, Contacts::kToolNormal, k);
          const Lanes reached =
              larger(Lanes{}, smaller(Lanes{} + 1.0f, 1.0f + depth / settings.spread_reach_m));
          const Lanes near = where(there & (known | tells) & (cosine > 0.0f), reached * fade);
          add(near_sum, near);
          const Lanes along_axes[3] = {normal.x, normal.y, normal.z};
          for (int a = 0, entry = 0; a < 3; ++a) {
            const Lanes scaled = near * along_axes[a];
            add(normal_sums[a], scaled);
            for (int b = a; b < 3; ++b) add(product_sums[entry++], scaled * along_axes[b]);
          }
        }
      } else {
        weight = where(there & (depth > 0.0f), Lanes{} + 1.0f);
      }
      // What is known is there already; of many contacts a store costs more than the question.
      if (any(~known)) store3(normal, contacts, Contacts::kNormal, k);
    } else {
      weight = where(there & (depth > 0.0f), Lanes{} + 1.0f);
    }
    store(along, contacts.of[Contacts::kAlong] + k);
    store(depth, contacts.of[Contacts::kDepth] + k);
    store(weight, contacts.of[Contacts::kWeight] + k);
    add(weights, weight);
    counts -= weight > 0.0f;
  }
  for (int lane = 0; lane < kLaneCount; ++lane) {
    lanes.counted += static_cast<std::uint32_t>(counts[lane]);
  }
  store(weights, lanes.weights), store(near_sum, lanes.near);
  for (int a = 0; a < 3; ++a) store(normal_sums[a], lanes.normal[a]);
  for (int entry = 0; entry < 6; ++entry) store(product_sums[entry], lanes.products[entry]);
}

/// N + gain (g - N), unit, of normals N and the tool's outward directions g.
inline Lanes3 turned_to(const Lanes3& normal, const Lanes3& outward, const float (&gain)[6]) {
  const Lanes3 way = outward + normal * (Lanes{} - 1.0f);
  const Lanes3 turned = normal + Lanes3{way.x * gain[0] + way.y * gain[1] + way.z * gain[2],
                                        way.x * gain[1] + way.y * gain[3] + way.z * gain[4],
                                        way.x * gain[2] + way.y * gain[4] + way.z * gain[5]};
  const Lanes length = square_root(dot(turned, turned));
  const IntLanes has = length > 0.1f;  // else the two are opposed
  return {has ? turned.x / length : normal.x, has ? turned.y / length : normal.y,
          has ? turned.z / length : normal.z};
}

/// Looked up by label. Neighbours are mostly of one tissue, and then nothing has to wait for what
/// is stored lane by lane.
inline Lanes of_tissues(const float* by_label, const std::uint8_t* labels) {
  constexpr std::uint64_t kEach = 0x0101010101010101u;
  const std::uint64_t all = labels[0] * kEach;
  std::uint64_t differ = 0;
  for (int k = 0; k < kLaneCount; k += 8) {
    std::uint64_t eight;
    __builtin_memcpy(&eight, labels + k, sizeof eight);
    differ |= eight ^ all;
  }
  if (differ == 0) return Lanes{} + by_label[labels[0]];
  alignas(64) float found[kLaneCount];
  for (int lane = 0; lane < kLaneCount; ++lane) found[lane] = by_label[labels[lane]];
  return load(found);
}

template <bool kCutting, bool kStiffness>
inline void add_forces(const ContactFrame& frame, const ForceTerms& terms,
                       const ContactArrays& contacts, ForceSums& sums) {
  DoubleLanes wrench_sums[6] = {}, stiffness_sums[21] = {}, tangential_sums[6] = {};
  DoubleLanes weight_sums[6] = {};
  const Lanes3 to_tip = constant(terms.axis_m), linear = constant(terms.linear),
               turning = constant(terms.turning);
  for (std::size_t k = 0; k < contacts.size; k += kLaneCount) {
    Lanes3 normal = load3(contacts, Contacts::kNormal, k);
    // Found again: of many contacts what is stored costs more than what is computed.
    const Lanes3 arm = constant(frame.arm_m) + (voxels(frame, contacts.keys + k) +
                                                normal * load(contacts.of[Contacts::kAlong] + k)) *
                                                   (Lanes{} + frame.voxel_m);
    if (terms.turns) {
      normal = turned_to(normal, load3(contacts, Contacts::kToolNormal, k), terms.gain);
      store3(normal, contacts, Contacts::kNormal, k);
    }
    const Lanes stiffness = of_tissues(terms.stiffness_N_per_m, contacts.tissues + k) *
                            load(contacts.of[Contacts::kWeight] + k);
    const Lanes normal_force = stiffness * load(contacts.of[Contacts::kDepth] + k);
    Lanes3 force = normal * normal_force;  // eq. 1
    Lanes power{};
    if constexpr (kCutting) {
      const Lanes3 velocity = linear + cross(turning, arm + to_tip);
      const Lanes3 sliding = velocity + normal * -dot(velocity, normal);
      const Lanes squared = dot(sliding, sliding);
      const Lanes speed = larger(square_root(squared), Lanes{} + terms.slow_edge_m_per_s);
      const Lanes along = terms.tangential_ratio * normal_force / speed;
      const Lanes3 drag = sliding * -along;  // eq. 7
      force = force + drag;
      power = along * squared;
      const Lanes3 moment = cross(arm, drag);
      const Lanes tangential[6] = {drag.x, drag.y, drag.z, moment.x, moment.y, moment.z};
      for (int a = 0; a < 6; ++a) add(tangential_sums[a], tangential[a]);
    }
    store(normal_force, contacts.of[Contacts::kForce] + k);
    store(power, contacts.of[Contacts::kPower] + k);
    const Lanes3 torque = cross(arm, force);
    const Lanes wrench[6] = {force.x, force.y, force.z, torque.x, torque.y, torque.z};
    for (int a = 0; a < 6; ++a) add(wrench_sums[a], wrench[a]);
    if constexpr (!kStiffness) continue;
    const Lanes3 turn = cross(arm, normal);
    const Lanes row[6] = {normal.x, normal.y, normal.z, turn.x, turn.y, turn.z};  // of the Jacobian
    const Lanes weight = load(contacts.of[Contacts::kWeight] + k);
    const Lanes depth = load(contacts.of[Contacts::kDepth] + k);
    const Lanes per_depth = where(weight > 0.0f, weight / depth);
    int entry = 0;
    for (int a = 0; a < 6; ++a) {
      add(weight_sums[a], per_depth * row[a]);
      const Lanes scaled = stiffness * row[a];
      for (int b = a; b < 6; ++b) add(stiffness_sums[entry++], scaled * row[b]);
    }
  }
  for (int a = 0; a < 6; ++a) {
    sums.weights[a] = sum_of(weight_sums[a]);
    sums.wrench[a] = sum_of(wrench_sums[a]);
    sums.tangential[a] = sum_of(tangential_sums[a]);
  }
  for (int entry = 0; entry < 21; ++entry) sums.stiffness[entry] = sum_of(stiffness_sums[entry]);
}

inline void forces_of(const ContactFrame& frame, const ForceTerms& terms,
                      const ContactArrays& contacts, ForceSums& sums) noexcept {
  if (terms.with_stiffness) {
    terms.cutting ? add_forces<true, true>(frame, terms, contacts, sums)
                  : add_forces<false, true>(frame, terms, contacts, sums);
  } else {
    terms.cutting ? add_forces<true, false>(frame, terms, contacts, sums)
                  : add_forces<false, false>(frame, terms, contacts, sums);
  }
}

constexpr ContactKernels kernels_named(const char* name) {
  return {name, leaf_keys_of, find_near, leaf_distances_of, take_kept, measure_all, forces_of};
}

}  // namespace

}  // namespace sulcus
