#include "haptics/saved_state.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

#include "haptics/state_fields.hpp"

namespace sulcus {

namespace {

// The lists of fields are in state_fields. Little-endian, as the processors that the program runs
// on.

constexpr std::uint32_t kLayout = 3;  // of the bytes; 1 and 2 are read too

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
  /// One that the layouts from one on do not have any more.
  template <class T>
  void until(std::uint32_t layout, T value) {
    if (layout_ < layout) (*this)(value);
  }
  void set_layout(std::uint32_t layout) { layout_ = layout; }
  std::uint32_t layout() const { return layout_; }
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

void part_cut(Reader& read, const Workpiece& solid, CutState& state) {
  state.clear();
  const auto count = read.take<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && read.good(); ++i) {
    const auto voxel = read.take<std::uint32_t>();
    const auto energy_J = read.take<double>();
    if (voxel >> 30 != 0 || !solid.grid().contains(cell_of_key(voxel)) ||
        !solid.solid(cell_of_key(voxel)) || energy_J <= 0.0) {
      return read.fail();
    }
    state.set_energy(voxel, energy_J);
  }
}

void removal(Writer& write, const Workpiece&, const std::optional<RemovalState>& part) {
  if (!fields::presence(write, part)) return;
  part_cut(write, part->part_cut);
  fields::removal(write, *part);
}

void removal(Reader& read, const Workpiece& solid, std::optional<RemovalState>& part) {
  if (!fields::presence(read, part)) return;
  RemovalState nowhere(CuttingSettings{.max_cut_voxels = 1});  // for what the scene does not name
  RemovalState& to = part ? *part : nowhere;
  part_cut(read, solid, to.part_cut);
  fields::removal(read, to);
  if (read.layout() >= 3) return;
  // Tissues are counted from here on; what their voxels have stored is work done on them.
  const std::array<double, 256> stored_J = to.stored_by_tissue_J(solid);
  for (std::size_t tissue = 0; tissue < stored_J.size(); ++tissue) {
    to.by_tissue[tissue].work_J = stored_J[tissue];
  }
}

/// The cached normals that a state had before its third layout. They are found again.
void skip_normal_cache(Reader& read) {
  if (!read.take<bool>()) return;
  const auto leaves = read.take<std::uint32_t>();
  for (std::uint32_t i = 0; i < leaves && read.good(); ++i) {
    read.take<std::uint32_t>();
    for (int words = 0; words < 9; ++words) read.take<std::uint64_t>();
  }
}

/// What all bodies have.
void body(Writer& write, const Body& body) { removal(write, body.solid, body.removal); }
void body(Reader& read, Body& body) {
  removal(read, body.solid, body.removal);
  if (read.layout() < 3) skip_normal_cache(read);
  if (body.normal_cache) body.normal_cache->clear();
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

bool load_state(std::span<const std::byte> bytes, SimulationState& state) {
  Reader read(bytes);
  const auto layout = read.take<std::uint32_t>();
  if (layout < 1 || layout > kLayout) return false;
  read.set_layout(layout);
  fields::head(read, state);
  body(read, state.workpiece());
  if (read.take<std::uint32_t>() != state.others().size()) return false;
  for (Body& other : std::span(state.bodies).subspan(1)) {
    body(read, other);
    fields::damage(read, other);
  }
  return read.whole();
}

}  // namespace sulcus
