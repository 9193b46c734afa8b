#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>

#include "engine/core/hash.hpp"
#include "haptics/removal.hpp"

namespace sulcus::fields {

// One list of the fields of each part of a SimulationState, for all that goes over them: `Archive`
// is a Hasher or a saved state's Writer, of a const state, or its Reader. What is hashed is what is
// saved. Tables that have a hash of their own, part-cut voxels, cached normals and the bodies'
// voxels, are not in the lists.

/// XXH3-64 of what it is given, in its order.
class Hasher {
 public:
  static constexpr bool kReads = false;

  template <class T>
  void operator()(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    hash_ = hash_bytes(&value, sizeof(T), hash_);
  }
  template <class T>
  void since(std::uint32_t, const T& value) {
    (*this)(value);
  }
  std::uint64_t hash() const { return hash_; }

 private:
  std::uint64_t hash_ = 0;
};

template <class Archive, class... T>
void all(Archive& archive, T&... values) {
  (archive(values), ...);
}
template <class Archive, class Range>
void each(Archive& archive, Range& range) {
  for (auto& value : range) archive(value);
}
template <class Archive, class Vector>
void vector(Archive& archive, Vector& v) {
  all(archive, v.x(), v.y(), v.z());
}
template <class Archive, class P>
void pose(Archive& archive, P& p) {
  vector(archive, p.position);
  auto& q = p.orientation.coeffs();
  all(archive, q[0], q[1], q[2], q[3]);
}
template <class Archive, class W>
void wrench(Archive& archive, W& w) {
  vector(archive, w.force_N);
  vector(archive, w.torque_Nm);
}

template <class Archive, class Limiter>
void limiter(Archive& archive, Limiter& l) {
  wrench(archive, l.sent);
  all(archive, l.ramp, l.not_finite_ticks, l.clamped_ticks, l.ramped_ticks, l.step_limited_ticks);
}

template <class Archive, class Passivity>
void passivity(Archive& archive, Passivity& p) {
  archive(p.has_reference);
  pose(archive, p.reference);
  vector(archive, p.moved.linear_m_per_s);
  vector(archive, p.moved.angular_rad_per_s);
  all(archive, p.moved.spindle_rad_per_s, p.energy_J, p.least_J);
  if constexpr (requires { archive.until(3, 0.0); }) archive.until(3, 0.0);  // another reference
  wrench(archive, p.contact);
  for (auto* h : {&p.commanded, &p.sent, &p.held}) {
    wrench(archive, h->wrench);
    vector(archive, h->damping_N);
    archive(h->limited);
  }
  all(archive, p.given_before_J, p.dissipated_J, p.damped_ticks);
}

/// What the controller has beside it.
template <class Archive, class Passivity>
void trend(Archive& archive, Passivity& p) {
  auto& t = p.trend;
  for (int axis = 0; axis < 3; ++axis) {
    archive.since(3, t.direction[axis]);
    archive.since(3, t.step_m[axis]);
  }
  for (auto* value : {&t.drive_N, &t.stiffness_N_per_m, &t.stiffest_N_per_m, &t.length_m}) {
    archive.since(3, *value);
  }
  archive.since(3, t.has_stiffness);
  archive.since(3, p.credit_J);
}

template <class Archive, class Buzz>
void buzz(Archive& archive, Buzz& b) {
  archive(b.started);
  vector(archive, b.turn_N);
  vector(archive, b.furthest_N);
  all(archive, b.tick, b.seen);
  each(archive, b.swings_N);
  each(archive, b.seen_ticks);
}

template <class Archive, class Port>
void port(Archive& archive, Port& p) {
  pose(archive, p.pose);
  archive(p.has_pose);
  limiter(archive, p.limiter);
  passivity(archive, p.passivity);
  buzz(archive, p.buzz);
  archive.since(2, p.silent_ticks);
  trend(archive, p.passivity);
}

/// Whether what follows is there, and whether the state has a place for it.
template <class Archive, class T>
bool presence(Archive& archive, const std::optional<T>& part) {
  bool there = part.has_value();
  archive(there);
  return there;
}

template <class Archive, class Number>
void number(Archive& archive, Number& part) {
  if (!presence(archive, part)) return;
  double value = part.value_or(0.0);
  archive(value);
  if constexpr (Archive::kReads) {
    if (part) part = value;
  }
}

/// Energies by tissue, up to the last one that has any.
template <class Archive, class Tissues>
void tissues(Archive& archive, Tissues& by_tissue) {
  auto count = static_cast<std::uint32_t>(by_tissue.size());
  while (count > 0 && by_tissue[count - 1] == TissueEnergy{}) --count;
  archive.since(3, count);
  if constexpr (Archive::kReads) {
    if (count > by_tissue.size()) return archive.fail();
    by_tissue = {};
  }
  for (auto& tissue : std::span(by_tissue).first(count)) {
    for (auto* energy_J : {&tissue.work_J, &tissue.removed_J, &tissue.heat_J, &tissue.carried_J}) {
      archive.since(3, *energy_J);
    }
  }
}

template <class Archive, class Removal>
void removal(Archive& archive, Removal& r) {
  // Layouts 1 and 2 have, in the place of heat, what waited to be spent on other voxels: it is
  // lost.
  all(archive, r.carried_J, r.heat_J, r.work_J, r.removed_J);
  each(archive, r.removed_voxels);
  tissues(archive, r.by_tissue);
}

/// What a body beside the workpiece has suffered.
template <class Archive, class Body>
void damage(Archive& archive, Body& body) {
  all(archive, body.touched_ticks, body.peak_force_N);
}

template <class Archive, class State>
void head(Archive& archive, State& state) {
  all(archive, state.tick, state.has_pose);
  pose(archive, state.tool);
  port(archive, state.port);
  number(archive, state.spindle_rad_per_s);
  number(archive, state.load_offset_m);
}

/// The hash of a part: `list(archive)` goes over its fields.
template <class List>
std::uint64_t hash_of(const List& list) {
  Hasher hasher;
  list(hasher);
  return hasher.hash();
}

}  // namespace sulcus::fields
