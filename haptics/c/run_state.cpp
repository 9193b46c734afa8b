// What SceneRun::saved holds, all numbers as the machine has them:
//
//   magic, version     u64, u64
//   start              u64   hash of the scene's text and all voxels at the start
//   force_hash, edits  u64, u64
//   last faults, dev   u64, u64; where dev is 1 the simulated device (kDevice doubles)
//   of each body       leaves u64, then (leaf u64, 8 words u64) of those that are not empty
//                      pages u64, then (leaf u64, 512 levels) of those with voxels not full
//   state              save_state, to the end but for
//   check              u64   XXH3-64 of all before it
#include <array>
#include <cstring>
#include <type_traits>

#include "engine/core/error.hpp"
#include "engine/core/hash.hpp"
#include "engine/volume/edits.hpp"
#include "haptics/c/scene_run.hpp"
#include "haptics/saved_state.hpp"

namespace sulcus {

namespace {

constexpr std::uint64_t kMagic = 0x31657461'74735553u;  // "SUstate1" by bytes
constexpr std::uint64_t kVersion = 1;
constexpr std::size_t kDevice = 29;  // numbers of SimulatedDeviceState
using DeviceNumbers = std::array<double, kDevice>;

[[noreturn]] void refuse(const std::string& found) {
  throw InputError("", "saved state", found, "one that this library saved of this scene");
}

template <class T>
void put(std::vector<std::byte>& out, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::size_t at = out.size();
  out.resize(at + sizeof value);
  std::memcpy(out.data() + at, &value, sizeof value);
}

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : left_(bytes) {}
  template <class T>
  T get() {
    if (left_.size() < sizeof(T)) refuse("an early end");
    T value;
    std::memcpy(&value, left_.data(), sizeof value);
    left_ = left_.subspan(sizeof value);
    return value;
  }
  std::span<const std::byte> rest() const { return left_; }

 private:
  std::span<const std::byte> left_;
};

DeviceNumbers numbers_of(const SimulatedDeviceState& s) {
  DeviceNumbers all{};
  std::size_t at = 0;
  const auto add = [&](const auto& values, int count) {
    for (int i = 0; i < count; ++i) all[at++] = values[i];
  };
  // Ticks are whole numbers far below 2^53.
  all[at++] = static_cast<double>(s.tick);
  add(s.position, 3);
  add(s.velocity_m_per_s, 3);
  add(s.orientation.coeffs(), 4);
  add(s.angular_rad_per_s, 3);
  add(s.held.force_N, 3);
  add(s.held.torque_Nm, 3);
  add(s.next.force_N, 3);
  add(s.next.torque_Nm, 3);
  all[at++] = static_cast<double>(s.felt_ticks);
  all[at++] = s.pushing ? 1.0 : 0.0;
  all[at++] = static_cast<double>(s.pushing_since);
  return all;
}

SimulatedDeviceState device_of(const DeviceNumbers& all) {
  SimulatedDeviceState s;
  std::size_t at = 0;
  const auto take = [&](auto& values, int count) {
    for (int i = 0; i < count; ++i) values[i] = all[at++];
  };
  s.tick = static_cast<std::uint64_t>(all[at++]);
  take(s.position, 3);
  take(s.velocity_m_per_s, 3);
  take(s.orientation.coeffs(), 4);
  take(s.angular_rad_per_s, 3);
  take(s.held.force_N, 3);
  take(s.held.torque_Nm, 3);
  take(s.next.force_N, 3);
  take(s.next.torque_Nm, 3);
  s.felt_ticks = static_cast<std::uint64_t>(all[at++]);
  s.pushing = all[at++] != 0.0;
  s.pushing_since = static_cast<std::uint64_t>(all[at++]);
  return s;
}

/// The voxels of a body as they were saved.
struct SavedVoxels {
  std::vector<LeafBits> leaves;
  std::optional<FillMap> fills;
};

void put_voxels(std::vector<std::byte>& out, const VoxelModel& model) {
  std::uint64_t count = 0;
  for (const LeafBits& leaf : model.leaves) count += any(leaf) ? 1 : 0;
  put(out, count);
  for (std::uint64_t leaf = 0; leaf < model.leaves.size(); ++leaf) {
    if (!any(model.leaves[leaf])) continue;
    put(out, leaf);
    for (const std::uint64_t word : model.leaves[leaf].words) put(out, word);
  }
  put(out, std::uint64_t{model.fills ? model.fills->pages().size() : 0});
  if (!model.fills) return;
  for (const LeafLevels& page : model.fills->pages()) {
    put(out, std::uint64_t{page.leaf});
    put(out, page.levels);
  }
}

SavedVoxels get_voxels(Reader& in, const VoxelModel& model) {
  SavedVoxels saved;
  saved.leaves.resize(model.leaves.size());
  const auto leaf_number = [&] {
    const auto leaf = in.get<std::uint64_t>();
    if (leaf >= saved.leaves.size()) refuse("a leaf beyond the grid");
    return leaf;
  };
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    LeafBits& bits = saved.leaves[leaf_number()];
    for (std::uint64_t& word : bits.words) word = in.get<std::uint64_t>();
  }
  std::vector<LeafLevels> pages;
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
    LeafLevels page;
    page.leaf = static_cast<std::uint32_t>(leaf_number());
    page.levels = in.get<LevelBlock>();
    pages.push_back(page);
  }
  if (model.fills) saved.fills.emplace(model.grid.leaf_count(), std::move(pages));
  return saved;
}

/// Brings a solid to what was saved, voxel by voxel that is different. A page without room is given
/// some first.
void set_voxels(const SavedVoxels& saved, Workpiece& solid) {
  for (std::uint32_t leaf = 0; leaf < solid.grid().leaf_count(); ++leaf) {
    const bool has_page =
        saved.fills && (saved.fills->page(leaf) || solid.model().fills->page(leaf));
    if (saved.leaves[leaf] == solid.model().leaves[leaf] && !has_page) continue;
    const Cell first = solid.grid().leaf_origin(leaf);
    for (int place = 0; place < 512; ++place) {
      const Cell cell = first + cell_in_leaf(place);
      const FillLevel now = solid.level(cell);
      FillLevel then = 0;
      if (saved.leaves[leaf].has(place)) {
        then = saved.fills ? saved.fills->level(leaf, place) : kFullLevel;
      }
      if (now == then) continue;
      if (then == 0) {
        solid.remove(cell);
      } else if (now != 0) {
        set_level(solid, cell, then);
      } else {
        if (saved.fills && !solid.model().fills->has_room()) {
          solid.reserve_fills(more_leaves(*solid.model().fills));
        }
        solid.put_back(cell, then);
      }
    }
  }
}

}  // namespace

std::vector<std::byte> SceneRun::saved() const {
  std::vector<std::byte> out;
  put(out, kMagic);
  put(out, kVersion);
  put(out, start_hash_);
  put(out, force_hash_);
  put(out, edits_.end());
  put(out, std::uint64_t{last_.faults});
  put(out, std::uint64_t{simulated_ ? 1u : 0u});
  if (simulated_) put(out, numbers_of(simulated_->state()));
  for (const Body& body : state_.bodies) put_voxels(out, body.solid.model());
  save_state(state_, out);
  put(out, hash_bytes(out.data(), out.size()));
  return out;
}

void SceneRun::restore(std::span<const std::byte> bytes) {
  constexpr std::size_t kCheck = sizeof(std::uint64_t);
  if (bytes.size() < kCheck) refuse("nothing");
  const auto inside = bytes.first(bytes.size() - kCheck);
  if (Reader(bytes.last(kCheck)).get<std::uint64_t>() != hash_bytes(inside.data(), inside.size())) {
    refuse("damaged bytes");
  }
  Reader in(inside);
  if (in.get<std::uint64_t>() != kMagic || in.get<std::uint64_t>() != kVersion) {
    refuse("another layout");
  }
  if (in.get<std::uint64_t>() != start_hash_) refuse("the state of another scene");
  const auto force_hash = in.get<std::uint64_t>();
  const auto edits = in.get<std::uint64_t>();
  const auto faults = static_cast<std::uint32_t>(in.get<std::uint64_t>());
  std::optional<SimulatedDeviceState> device;
  if (in.get<std::uint64_t>() != 0) device = device_of(in.get<DeviceNumbers>());
  if (device.has_value() != simulated_.has_value()) refuse("the state of another device");
  std::vector<SavedVoxels> voxels;
  voxels.reserve(state_.bodies.size());
  for (const Body& body : state_.bodies) voxels.push_back(get_voxels(in, body.solid.model()));

  // What was checked to be whole and of this scene is taken.
  for (std::size_t i = 0; i < voxels.size(); ++i) set_voxels(voxels[i], state_.bodies[i].solid);
  if (!load_state(in.rest(), state_)) throw std::runtime_error("a state that cannot be taken");
  if (device) simulated_->set_state(*device);
  scratch_.clear_results();
  scratch_.edits.clear();
  last_ = {};
  last_.tick = state_.tick == 0 ? 0 : state_.tick - 1;
  last_.faults = faults;
  last_.tool = state_.tool;
  force_hash_ = force_hash;
  edits_.begin_at(edits);
}

}  // namespace sulcus
