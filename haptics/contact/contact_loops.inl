// The loops of contact_kernels.hpp, written once and compiled for each instruction set by the files
// that include this.

#include <type_traits>

#include "haptics/contact/contact_kernels.hpp"
#include "haptics/contact/field_lanes.inl"

namespace sulcus {

namespace {

/// Lanes of the first `count`.
alignas(64) constexpr std::int32_t kLaneNumbers[16] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                       8, 9, 10, 11, 12, 13, 14, 15};
inline IntLanes first_lanes(std::size_t count) {
  return load(kLaneNumbers) < static_cast<std::int32_t>(count);
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
    const IntLanes near = (distance_m < reach_m) & first_lanes(count - k);
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
struct LoadedQuads {
  Lanes of[4];
};
inline LoadedQuads load_quads(const float* const* from) {
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
  LoadedQuads all;
  for (int lane = 0; lane < kLaneCount; ++lane) {
    for (int q = 0; q < 4; ++q) all.of[q][lane] = from[lane][q];
  }
  return all;
#endif
}

inline std::uint64_t take_cached(const float* const (&kept)[kCachedBlock], std::size_t count,
                                 float voxel_m, const ContactArrays& contacts,
                                 const BlockArrays& block, std::size_t first) noexcept {
  std::uint64_t away = 0;
  for (std::size_t k = 0; k < count; k += kLaneCount) {
    const LoadedQuads v = load_quads(kept + k);
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

/// How many, and the deepest.
inline void add_counts(const IntLanes& counts, const Lanes& deepest, MeasureLanes& lanes) {
  for (int lane = 0; lane < kLaneCount; ++lane) {
    lanes.counted += static_cast<std::uint32_t>(counts[lane]);
    if (deepest[lane] > lanes.deepest_m) lanes.deepest_m = deepest[lane];
  }
}

/// Sums of NormalSpread, in lanes.
struct SpreadSums {
  explicit SpreadSums(const MeasureLanes& lanes) : near(load(lanes.near)) {
    for (int a = 0; a < 3; ++a) normal[a] = load(lanes.normal[a]);
    for (int entry = 0; entry < 6; ++entry) products[entry] = load(lanes.products[entry]);
  }
  void add_normals(const Lanes& weight, const Lanes3& n) {
    add(near, weight);
    const Lanes along_axes[3] = {n.x, n.y, n.z};
    for (int a = 0, entry = 0; a < 3; ++a) {
      const Lanes scaled = weight * along_axes[a];
      add(normal[a], scaled);
      for (int b = a; b < 3; ++b) add(products[entry++], scaled * along_axes[b]);
    }
  }
  void store_to(MeasureLanes& lanes) const {
    store(near, lanes.near);
    for (int a = 0; a < 3; ++a) store(normal[a], lanes.normal[a]);
    for (int entry = 0; entry < 6; ++entry) store(products[entry], lanes.products[entry]);
  }

  DoubleLanes near, normal[3], products[6];
};

}  // namespace

}  // namespace sulcus

#include "haptics/contact/potential_loops.inl"

namespace sulcus {

namespace {

inline void measure_all(const ContactFrame& frame, const ForceSettings& settings,
                        const ContactArrays& contacts, const BlockArrays& block,
                        MeasureLanes& lanes) noexcept {
  if (settings.potential) return measure_points(frame, settings, contacts, block, lanes);
  const float half_voxel_m = 0.5f * frame.voxel_m, per_voxel = 1.0f / frame.voxel_m;
  const float full_cosine = 1.0f / settings.fade_below;
  const bool spreads = settings.at_surface && settings.spread_reach_m > 0.0f;
  DoubleLanes weights = load(lanes.weights);
  SpreadSums spread(lanes);
  IntLanes counts{};
  Lanes deepest{};
  for (std::size_t k = 0; k < contacts.size; k += kLaneCount) {
    const Lanes3 d = voxels(frame, contacts.keys + k);
    Lanes3 normal = load3(contacts, Contacts::kNormal, k);
    const Lanes distance_m = load(block.of[ContactBlock::kDistance] + k);
    const IntLanes known = dot(normal, normal) > 0.0f;
    const IntLanes there =
        first_lanes(contacts.size - k);  // what fills up the last group weighs nothing
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
      // Where the method gives no normal the tool hint is taken, and the voxel's own face.
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
        const Lanes share = settings.weighs_depth ? depth * per_voxel * fade : Lanes{} + 1.0f;
        weight = where(there & (depth > 0.0f) & (cosine > 0.0f), share);
        if (spreads) {
          store3(away * turned, contacts, Contacts::kToolNormal, k);
          const Lanes reached =
              larger(Lanes{}, smaller(Lanes{} + 1.0f, 1.0f + depth / settings.spread_reach_m));
          spread.add_normals(where(there & (known | tells) & (cosine > 0.0f), reached * fade),
                             normal);
        }
      } else {
        weight = where(there & (depth > 0.0f), Lanes{} + 1.0f);
      }
      // Known normals are there already; of many contacts a store costs more than the test.
      if (any(~known)) store3(normal, contacts, Contacts::kNormal, k);
    } else {
      weight = where(there & (depth > 0.0f), Lanes{} + 1.0f);
    }
    store(along, contacts.of[Contacts::kAlong] + k);
    store(depth, contacts.of[Contacts::kDepth] + k);
    store(weight, contacts.of[Contacts::kWeight] + k);
    add(weights, weight);
    counts -= weight > 0.0f;
    deepest = larger(deepest, where(weight > 0.0f, depth));
  }
  add_counts(counts, deepest, lanes);
  store(weights, lanes.weights);
  spread.store_to(lanes);
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

template <bool kPotential, bool kCutting, bool kStiffness>
inline void add_forces(const ContactFrame& frame, const ForceTerms& terms,
                       const ContactArrays& contacts, ForceSums& sums) {
  DoubleLanes wrench_sums[6] = {}, stiffness_sums[21] = {}, tangential_sums[6] = {};
  DoubleLanes weight_sums[6] = {};
  const Lanes3 to_tip = constant(terms.axis_m), linear = constant(terms.linear),
               turning = constant(terms.turning);
  for (std::size_t k = 0; k < contacts.size; k += kLaneCount) {
    Lanes3 normal = load3(contacts, Contacts::kNormal, k);
    // Computed again: of many contacts loads and stores cost more.
    const Lanes3 arm = constant(frame.arm_m) + (voxels(frame, contacts.keys + k) +
                                                normal * load(contacts.of[Contacts::kAlong] + k)) *
                                                   (Lanes{} + frame.voxel_m);
    if (terms.blend_normals) {
      normal = turned_to(normal, load3(contacts, Contacts::kToolNormal, k), terms.edge_blend);
      store3(normal, contacts, Contacts::kNormal, k);
    }
    const Lanes depth = load(contacts.of[Contacts::kDepth] + k);
    const Lanes weight = load(contacts.of[Contacts::kWeight] + k);
    const Lanes stiffness = of_tissues(terms.stiffness_N_per_m, contacts.tissues + k) * weight;
    const Lanes normal_force = stiffness * depth;
    // What the weight adds to a sum that divides, for each metre deeper.
    const Lanes per_depth = where(weight > 0.0f, weight / depth);
    Lanes3 direction = normal;
    Lanes push = normal_force;
    if constexpr (kPotential) {
      direction = load3(contacts, Contacts::kToolNormal, k);
      push = static_cast<float>(potential::kPushPerShare) * normal_force -
             terms.push_per_weight * per_depth;
    }
    Lanes3 force = direction * push;  // eq. 1
    Lanes power{};
    if constexpr (kCutting) {
      const Lanes3 velocity = linear + cross(turning, arm + to_tip);
      const Lanes3 sliding = velocity + normal * -dot(velocity, normal);
      const Lanes squared = dot(sliding, sliding);
      const Lanes speed = larger(square_root(squared), Lanes{} + terms.friction_speed_m_per_s);
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
    const Lanes3 turn = cross(arm, direction);
    const Lanes row[6] = {direction.x, direction.y, direction.z,
                          turn.x,      turn.y,      turn.z};  // of the Jacobian
    Lanes along_row = stiffness;
    if constexpr (kPotential) {
      along_row =
          static_cast<float>(potential::kPushPerShare * (potential::kDepthPower + 1)) * stiffness -
          static_cast<float>(potential::kDepthPower - 1) * terms.push_per_weight *
              where(weight > 0.0f, per_depth / depth);
      const Lanes3 p =
          field_from_voxels(frame, voxels(frame, contacts.keys + k) +
                                       normal * load(contacts.of[Contacts::kAlong] + k));
      add_turning(curvature_at(frame, p), arm, push, stiffness_sums);
    }
    int entry = 0;
    for (int a = 0; a < 6; ++a) {
      add(weight_sums[a], per_depth * row[a]);
      const Lanes scaled = along_row * row[a];
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
  const auto add = [&](auto law, auto cutting, auto stiffness) {
    add_forces<law.value, cutting.value, stiffness.value>(frame, terms, contacts, sums);
  };
  const auto with = [](bool is, const auto& next) {
    is ? next(std::true_type()) : next(std::false_type());
  };
  with(terms.potential, [&](auto law) {
    with(terms.cutting, [&](auto cutting) {
      with(terms.with_stiffness, [&](auto stiffness) { add(law, cutting, stiffness); });
    });
  });
}

constexpr ContactKernels kernels_named(const char* name) {
  return {name, leaf_keys_of, find_near, leaf_distances_of, take_cached, measure_all, forces_of};
}

}  // namespace

}  // namespace sulcus
