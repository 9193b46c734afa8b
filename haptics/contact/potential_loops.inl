// The loops of contact_loops.inl for potential.hpp: surface points with areas, and how the burr's
// gradient turns along with it. Written once and compiled for each instruction set.

#include "haptics/contact/potential.hpp"

namespace sulcus {

namespace {

inline Lanes depth_power(const Lanes& depth) {
  Lanes power = depth;
  for (int n = 1; n < potential::kDepthPower; ++n) power = power * depth;
  return power;
}

/// Depth and weight of every contact, a d^p in voxels, with the tool's outward direction there,
/// which is as long as the gradient, and the sums of weights and K w d^2.
inline void measure_points(const ContactFrame& frame, const ForceSettings& settings,
                           const ContactArrays& contacts, const BlockArrays& block,
                           MeasureLanes& lanes) noexcept {
  const float half_voxel_m = 0.5f * frame.voxel_m, per_voxel = 1.0f / frame.voxel_m;
  DoubleLanes weights = load(lanes.weights), energy = load(lanes.energy);
  IntLanes counts{};
  Lanes deepest{};
  for (std::size_t k = 0; k < contacts.size; k += kLaneCount) {
    const Lanes3 d = voxels(frame, contacts.keys + k);
    const Lanes3 normal = load3(contacts, Contacts::kNormal, k);
    const IntLanes known = dot(normal, normal) > 0.0f;
    const Lanes offset = load(block.of[ContactBlock::kOffset] + k) * per_voxel;
    const Lanes along = where(known, larger(Lanes{} - 1.0f, smaller(Lanes{} + 1.0f, offset)));
    Lanes3 gradient;
    const Lanes value = sample(frame, field_from_voxels(frame, d + normal * along), gradient);
    const Lanes3 outward = to_world(frame, gradient) * (Lanes{} - 1.0f);
    const Lanes depth = known ? -value : half_voxel_m - value;
    const Lanes largest = larger(abs(normal.x), larger(abs(normal.y), abs(normal.z)));
    const Lanes area = known ? 1.0f / largest : Lanes{} + 1.0f;
    const IntLanes in = first_lanes(contacts.size - k) & (depth > 0.0f);
    const Lanes weight = where(in, area * depth_power(depth * per_voxel));
    const Lanes stiffness = of_tissues(settings.stiffness_N_per_m, contacts.tissues + k);
    add(weights, weight);
    add(energy, stiffness * weight * (depth * depth));
    counts -= in;
    deepest = larger(deepest, where(in, depth));
    if (any(~known)) {
      // Friction is along the surface: across the tool's direction where it has no normal.
      const Lanes length = square_root(dot(outward, outward));
      const Lanes per_length = where(~known & (length > 0.0f), 1.0f / length);
      store3(normal + outward * per_length, contacts, Contacts::kNormal, k);
    }
    store3(outward, contacts, Contacts::kToolNormal, k);
    store(along, contacts.of[Contacts::kAlong] + k);
    store(depth, contacts.of[Contacts::kDepth] + k);
    store(weight, contacts.of[Contacts::kWeight] + k);
  }
  add_counts(counts, deepest, lanes);
  store(weights, lanes.weights);
  store(energy, lanes.energy);
}

/// Second derivative of the burr's distance at points of field space, 1/m, world axes: xx, xy, xz,
/// yy, yz, zz. From the gradients there and one sample further along each axis: between samples the
/// field has none.
struct Curvature {
  Lanes of[6];
};
[[gnu::always_inline]] inline Curvature curvature_at(const ContactFrame& f, const Lanes3& p) {
  Lanes3 here, next[3];
  sample(f, p, here);
  const Lanes one = Lanes{} + 1.0f;
  sample(f, {p.x + one, p.y, p.z}, next[0]);
  sample(f, {p.x, p.y + one, p.z}, next[1]);
  sample(f, {p.x, p.y, p.z + one}, next[2]);
  const Lanes per_m = Lanes{} + 1.0f / f.spacing_m;
  Lanes h[3][3]{};  // world
  for (int j = 0; j < 3; ++j) {
    const Lanes3 column = to_world(f, (next[j] + here * (Lanes{} - 1.0f)) * per_m);
    const Lanes along[3] = {column.x, column.y, column.z};
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) h[a][b] = h[a][b] + along[a] * f.world_from_tool[b][j];
    }
  }
  Curvature c;
  for (int a = 0, entry = 0; a < 3; ++a) {
    for (int b = a; b < 3; ++b) c.of[entry++] = 0.5f * (h[a][b] + h[b][a]);
  }
  return c;
}
inline Lanes3 operator*(const Curvature& c, const Lanes3& v) {
  return {c.of[0] * v.x + c.of[1] * v.y + c.of[2] * v.z,
          c.of[1] * v.x + c.of[3] * v.y + c.of[4] * v.z,
          c.of[2] * v.x + c.of[4] * v.y + c.of[5] * v.z};
}

/// Adds what pushes make of the stiffness where the tool's gradient turns: a point that the tool
/// moves over by m sees m' H m / 2 less depth. Arms held.
inline void add_turning(const Curvature& curvature, const Lanes3& arm, const Lanes& push,
                        DoubleLanes (&stiffness_sums)[21]) {
  const Lanes zero{}, one = Lanes{} + 1.0f;
  const Lanes3 moved[6] = {{one, zero, zero},     {zero, one, zero},     {zero, zero, one},
                           {zero, -arm.z, arm.y}, {arm.z, zero, -arm.x}, {-arm.y, arm.x, zero}};
  int entry = 0;
  for (int a = 0; a < 6; ++a) {
    const Lanes3 turned = curvature * moved[a];
    for (int b = a; b < 6; ++b) add(stiffness_sums[entry++], -push * dot(turned, moved[b]));
  }
}

}  // namespace

}  // namespace sulcus
