#include "haptics/saved_state.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

#include "engine/normals/normal_method.hpp"
#include "haptics/state_fields.hpp"

namespace sulcus {

namespace {

// The lists of fields are in state_fields. Little-endian, as the processors that the program runs
// on.

constexpr std::uint32_t kLayout = 2;  // of the bytes; 1, without what has come since, is read too

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
  template <class T>
  void since(std::uint32_t, const T& value) {
    (*this)(value);
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
  /// A field that the layouts before one do not have.
  template <class T>
  void since(std::uint32_t layout, T& value) {
    value = T{};
    if (layout_ >= layout) (*this)(value);
  }
  void set_layout(std::uint32_t layout) { layout_ = layout; }
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
  std::uint32_t layout_ = kLayout;
};

void part_cut(Writer& write, const CutState& state) {
  write(state.size());
  state.for_each(
      [&](std::uint32_t voxel, double energy_J) { fields::all(write, voxel, energy_J); });
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
  if (!fields::presence(archive, part)) return;
  if constexpr (Archive::kReads) {
    RemovalState nowhere(CuttingSettings{.max_cut_voxels = 1});  // for what the scene does not name
    RemovalState& to = part ? *part : nowhere;
    part_cut(archive, grid, to.part_cut);
    fields::removal(archive, to);
  } else {
    part_cut(archive, part->part_cut);
    fields::removal(archive, *part);
  }
}

/// The leaves in their order, by which the oldest is evicted, and which normals had been refined.
/// The others are the same when they are found again.
void normal_cache(Writer& write, const std::optional<NormalCache>& cache) {
  if (!fields::presence(write, cache)) return;
  write(static_cast<std::uint32_t>(cache->pages().size()));
  for (const NormalCache::Page& page : cache->pages()) {
    fields::all(write, page.first_key, page.touched);
    fields::each(write, page.refined);
  }
}

void normal_cache(Reader& read, const HapticsSettings& settings, const Workpiece& solid,
                  std::optional<NormalCache>& cache) {
  if (!fields::presence(read, cache)) return;
  if (cache) cache->clear();
  const auto count = read.take<std::uint32_t>();
  std::vector<VoxelQuery> queries;
  std::vector<SurfaceEstimate> estimates;
  for (std::uint32_t i = 0; i < count && read.good(); ++i) {
    const auto leaf = read.take<std::uint32_t>();
    const auto touched = read.take<std::uint64_t>();
    NormalCache::Mask refined{};
    fields::each(read, refined);
    if (!cache) continue;
    if (leaf >> 30 != 0 || leaf != leaf_key(leaf) || !solid.grid().contains(cell_of_key(leaf))) {
      return read.fail();
    }
    cache->add_leaf(leaf, touched);
    queries.clear();
    for (int place = 0; place < 512; ++place) {
      if (!NormalCache::is(refined, place)) continue;
      const Cell voxel = cell_of_key(leaf) + Cell(place & 7, place >> 3 & 7, place >> 6);
      if (!solid.is_surface(voxel)) return read.fail();
      queries.push_back(VoxelQuery{voxel});
    }
    estimates.resize(queries.size());
    estimate_surfaces(solid, queries, settings, estimates);
    for (std::size_t q = 0; q < queries.size(); ++q) {
      cache->keep(voxel_key(queries[q].voxel), estimates[q], NormalTier::kRefined, touched);
    }
  }
}

/// What all bodies have.
void body(Writer& write, const Body& body) {
  removal(write, body.solid.grid(), body.removal);
  normal_cache(write, body.normal_cache);
}
void body(Reader& read, const HapticsSettings& settings, Body& body) {
  removal(read, body.solid.grid(), body.removal);
  normal_cache(read, settings, body.solid, body.normal_cache);
}

}  // namespace

void save_state(const SimulationState& state, std::vector<std::byte>& bytes) {
  Writer write(bytes);
  write(kLayout);
  fields::head(write, state);
  body(write, state.workpiece());
  write(static_cast<std::uint32_t>(state.others().size()));
  for (const Body& other : state.others()) {
    body(write, other);
    fields::damage(write, other);
  }
}

bool load_state(std::span<const std::byte> bytes, const HapticsSettings& settings,
                SimulationState& state) {
  Reader read(bytes);
  const auto layout = read.take<std::uint32_t>();
  if (layout < 1 || layout > kLayout) return false;
  read.set_layout(layout);
  fields::head(read, state);
  body(read, settings, state.workpiece());
  if (read.take<std::uint32_t>() != state.others().size()) return false;
  for (Body& other : std::span(state.bodies).subspan(1)) {
    body(read, settings, other);
    fields::damage(read, other);
  }
  return read.whole();
}

}  // namespace sulcus
