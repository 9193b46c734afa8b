#include "haptics/saved_state.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

#include "engine/normals/normal_method.hpp"

namespace sulcus {

namespace {

// One list of fields for both directions: `Archive` is a Writer of a const state, or a Reader.
// Little-endian, as the processors that the program runs on.

constexpr std::uint32_t kLayout = 1;  // of the bytes

class Writer {
 public:
  explicit Writer(std::vector<std::byte>& bytes) : bytes_(bytes) {}
  static constexpr bool kReads = false;

  template <class T>
  void operator()(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    const auto* first = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof(T));
  }

 private:
  std::vector<std::byte>& bytes_;
};

/// Past the first thing that does not fit all values are zero.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  static constexpr bool kReads = true;

  template <class T>
  void operator()(T& value) {
    static_assert(std::is_arithmetic_v<T>);
    value = T{};
    if (!good_ || bytes_.size() < sizeof(T)) return fail();
    if constexpr (std::is_same_v<T, bool>) {
      value = bytes_.front() != std::byte{0};
    } else {
      std::memcpy(&value, bytes_.data(), sizeof(T));
    }
    bytes_ = bytes_.subspan(sizeof(T));
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) fail();
    }
  }
  template <class T>
  T take() {
    T value;
    (*this)(value);
    return value;
  }
  void fail() { good_ = false; }
  bool good() const { return good_; }
  bool whole() const { return good_ && bytes_.empty(); }

 private:
  std::span<const std::byte> bytes_;
  bool good_ = true;
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

template <class Archive, class Edge>
void edge(Archive& archive, Edge& e) {
  wrench(archive, e.sent);
  all(archive, e.ramp, e.not_finite_ticks, e.clamped_ticks, e.ramped_ticks, e.step_limited_ticks);
}

template <class Archive, class Passivity>
void passivity(Archive& archive, Passivity& p) {
  archive(p.has_reference);
  pose(archive, p.reference);
  vector(archive, p.moved.linear_m_per_s);
  vector(archive, p.moved.angular_rad_per_s);
  all(archive, p.moved.spindle_rad_per_s, p.energy_J, p.least_J, p.lossless_J);
  wrench(archive, p.contact);
  for (auto* h : {&p.asked, &p.sent, &p.held}) {
    wrench(archive, h->wrench);
    vector(archive, h->damping_N);
    archive(h->changed);
  }
  all(archive, p.given_before_J, p.dissipated_J, p.damped_ticks);
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
  edge(archive, p.edge);
  passivity(archive, p.passivity);
  buzz(archive, p.buzz);
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

void part_cut(Writer& write, const CutState& state) {
  write(state.size());
  state.for_each([&](std::uint32_t voxel, double energy_J) { all(write, voxel, energy_J); });
}

void part_cut(Reader& read, const VoxelGrid& grid, CutState& state) {
  state.clear();
  const auto count = read.take<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && read.good(); ++i) {
    const auto voxel = read.take<std::uint32_t>();
    const auto energy_J = read.take<double>();
    if (voxel >> 30 != 0 || !grid.contains(cell_of_key(voxel)) || energy_J <= 0.0) {
      return read.fail();
    }
    state.set_energy(voxel, energy_J);
  }
}

template <class Archive, class Removal>
void removal(Archive& archive, const VoxelGrid& grid, Removal& part) {
  if (!presence(archive, part)) return;
  if constexpr (Archive::kReads) {
    RemovalState nowhere(CuttingSettings{.max_cut_voxels = 1});  // for what the scene does not name
    RemovalState& to = part ? *part : nowhere;
    part_cut(archive, grid, to.part_cut);
    all(archive, to.carried_J, to.pool_J, to.work_J, to.removed_J);
    each(archive, to.removed_voxels);
  } else {
    part_cut(archive, part->part_cut);
    all(archive, part->carried_J, part->pool_J, part->work_J, part->removed_J);
    each(archive, part->removed_voxels);
  }
}

/// The leaves in their order, by which the oldest gives way; and which normals had been refined.
/// The others are found again when they are touched, and are the same then.
void kept_normals(Writer& write, const std::optional<KeptNormals>& kept) {
  if (!presence(write, kept)) return;
  write(static_cast<std::uint32_t>(kept->pages().size()));
  for (const KeptNormals::Page& page : kept->pages()) {
    all(write, page.first_key, page.touched);
    each(write, page.refined);
  }
}

void kept_normals(Reader& read, const HapticsSettings& settings, const Workpiece& solid,
                  std::optional<KeptNormals>& kept) {
  if (!presence(read, kept)) return;
  if (kept) kept->clear();
  const auto count = read.take<std::uint32_t>();
  std::vector<VoxelQuery> queries;
  std::vector<SurfaceEstimate> estimates;
  for (std::uint32_t i = 0; i < count && read.good(); ++i) {
    const auto leaf = read.take<std::uint32_t>();
    const auto touched = read.take<std::uint64_t>();
    KeptNormals::Mask refined{};
    each(read, refined);
    if (!kept) continue;
    if (leaf >> 30 != 0 || leaf != leaf_key(leaf) || !solid.grid().contains(cell_of_key(leaf))) {
      return read.fail();
    }
    kept->add_leaf(leaf, touched);
    queries.clear();
    for (int place = 0; place < 512; ++place) {
      if (!KeptNormals::is(refined, place)) continue;
      const Cell voxel = cell_of_key(leaf) + Cell(place & 7, place >> 3 & 7, place >> 6);
      if (!solid.is_surface(voxel)) return read.fail();
      queries.push_back(VoxelQuery{voxel});
    }
    estimates.resize(queries.size());
    estimate_surfaces(solid, queries, settings, estimates);
    for (std::size_t q = 0; q < queries.size(); ++q) {
      kept->keep(voxel_key(queries[q].voxel), estimates[q], true, touched);
    }
  }
}

template <class Archive, class State>
void head(Archive& archive, State& state) {
  all(archive, state.tick, state.has_pose);
  pose(archive, state.tool);
  port(archive, state.port);
  number(archive, state.spindle_rad_per_s);
  number(archive, state.load_offset_m);
}

}  // namespace

void save_state(const SimulationState& state, std::vector<std::byte>& bytes) {
  Writer write(bytes);
  write(kLayout);
  head(write, state);
  removal(write, VoxelGrid{}, state.removal);
  kept_normals(write, state.kept);
  write(static_cast<std::uint32_t>(state.neighbours.size()));
  for (const Neighbour& neighbour : state.neighbours) {
    removal(write, VoxelGrid{}, neighbour.removal);
    kept_normals(write, neighbour.kept);
    all(write, neighbour.touched_ticks, neighbour.peak_force_N);
  }
}

bool load_state(std::span<const std::byte> bytes, const HapticsSettings& settings,
                const Workpiece& workpiece, SimulationState& state) {
  Reader read(bytes);
  if (read.take<std::uint32_t>() != kLayout) return false;
  head(read, state);
  removal(read, workpiece.grid(), state.removal);
  kept_normals(read, settings, workpiece, state.kept);
  if (read.take<std::uint32_t>() != state.neighbours.size()) return false;
  for (Neighbour& neighbour : state.neighbours) {
    removal(read, neighbour.solid.grid(), neighbour.removal);
    kept_normals(read, settings, neighbour.solid, neighbour.kept);
    all(read, neighbour.touched_ticks, neighbour.peak_force_N);
  }
  return read.whole();
}

}  // namespace sulcus
