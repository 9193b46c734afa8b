#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/hash.hpp"
#include "engine/recording/hdf5_fixed.hpp"
#include "engine/recording/recording_format.hpp"
#include "engine/recording/recording_parts.hpp"
#include "engine/volume/edits.hpp"
#include "engine/volume/packed_model.hpp"

namespace sulcus {

namespace {

constexpr std::uint64_t kMaxNameBytes = 1 << 16;
constexpr hsize_t kMaxEdits = std::uint64_t{1} << 34;  // 16 bodies of 1024^3 voxels

/// use(name of the attribute, number of the measures), in the layout's order.
template <class Measures, class Use>
void for_each_count(Measures& m, const Use& use) {
  use("ticks", m.ticks);
  use("ticks_in_contact", m.ticks_in_contact);
  use("limited_ticks", m.limited_ticks);
  use("buzz_ticks", m.buzz_ticks);
  use("silent_ticks", m.silent_ticks);
  use("jumped_ticks", m.jumped_ticks);
  use("long_step_ticks", m.long_step_ticks);
  use("inside_ticks", m.inside_ticks);
}

template <class Measures, class Use>
void for_each_force(Measures& m, const Use& use) {
  use("peak_force_N", m.peak_force_N);
  use("force_in_contact_sum_N", m.force_in_contact_sum_N);
}

std::uint64_t check_of(const EarlierRun& earlier) {
  std::uint64_t hash = hash_bytes(earlier.recording.data(), earlier.recording.size());
  hash = hash_bytes(earlier.scene_sha256.data(), earlier.scene_sha256.size(), hash);
  const auto add = [&](const char*, const auto& value) {
    hash = hash_bytes(&value, sizeof value, hash);
  };
  for_each_count(earlier.measures, add);
  for_each_force(earlier.measures, add);
  return hash;
}

/// The leaves of the workpiece that edits are of, and nothing else of it.
VoxelModel touched_leaves(const VoxelModel& start, std::span<const Edit> edits) {
  VoxelModel touched = start;
  touched.leaves = ZeroedArray<LeafBits>(start.leaves.size());
  for (const Edit& edit : edits) {
    if (edit.body != 0) continue;
    const std::uint32_t leaf = start.grid.leaf_of(start.grid.cell_of_linear(edit.voxel));
    touched.leaves[leaf] = start.leaves[leaf];
  }
  if (!start.fills) return touched;
  std::vector<LeafLevels> pages = start.fills->pages();
  std::erase_if(pages, [&](const LeafLevels& page) { return !any(touched.leaves[page.leaf]); });
  touched.fills.emplace(start.grid.leaf_count(), std::move(pages));
  return touched;
}

/// Levels of `now`, of some leaves those of `touched`.
FillMap fills_as_they_were(const VoxelModel& now, const VoxelModel& touched) {
  std::vector<LeafLevels> pages = now.fills->pages();
  std::erase_if(pages, [&](const LeafLevels& page) { return any(touched.leaves[page.leaf]); });
  const std::vector<LeafLevels>& were = touched.fills->pages();
  pages.insert(pages.end(), were.begin(), were.end());
  return {now.grid.leaf_count(), std::move(pages)};
}

/// `now` with some of its leaves as they were, tissues of what has gone since among it.
VoxelModel as_it_was(const VoxelModel& now, const VoxelModel& touched) {
  if (touched.grid.cells != now.grid.cells || !touched.tissues != !now.tissues) {
    throw Hdf5Error("earlier/workpiece: another grid or tissues than of the workpiece");
  }
  if (touched.fills.has_value() != now.fills.has_value()) {
    throw Hdf5Error("earlier/workpiece: with fill levels, or the workpiece has them alone");
  }
  VoxelModel start = now;
  if (now.fills) start.fills = fills_as_they_were(now, touched);
  std::shared_ptr<TissueMap> tissues;
  if (now.tissues) tissues = std::make_shared<TissueMap>(now.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < now.leaves.size(); ++leaf) {
    const VoxelModel& from = any(touched.leaves[leaf]) ? touched : now;
    start.leaves[leaf] = from.leaves[leaf];
    if (!tissues) continue;
    if (const LabelBlock* block = from.tissues->block(leaf)) {
      tissues->set_block(leaf, *block, from.leaves[leaf]);
    } else {
      tissues->set_uniform(leaf, from.tissues->uniform_label(leaf));
    }
  }
  start.tissues = std::move(tissues);
  return start;
}

/// `intact(row)`: whether one can be, by itself.
template <class Row, class Intact>
std::vector<Edit> read_edits(const Hdf5Handle& group, const Intact& intact,
                             std::uint64_t file_bytes) {
  const std::string name = kRowTable<Row>.name;
  const Hdf5Handle type = row_type<Row>();
  const auto rows = read_fixed_rows<Row>(group, {name.c_str(), type, 1, kMaxEdits}, file_bytes);
  std::vector<Edit> edits;
  edits.reserve(rows.size());
  for (const Row& row : rows) {
    if (!intact(row) || (!edits.empty() && row.tick < edits.back().tick)) {
      throw Hdf5Error("earlier/" + name + ": row " + std::to_string(edits.size()) + " is damaged");
    }
    edits.push_back(unpacked(row));
  }
  return edits;
}

template <class Row, class Pack>
void write_edits(const Hdf5Handle& group, std::span<const Edit> edits, bool gone,
                 const Pack& pack_row) {
  std::vector<Row> rows;
  for (const Edit& edit : edits) {
    if (edit.is_gone() == gone) rows.push_back(pack_row(edit));
  }
  write_fixed_rows(group, kRowTable<Row>.name, row_type<Row>(), rows.data(), rows.size());
}

bool same_levels(const VoxelModel& a, const VoxelModel& b) {
  const auto equal = [](const LeafLevels& x, const LeafLevels& y) {
    return x.leaf == y.leaf && x.levels == y.levels;
  };
  return a.leaves == b.leaves && std::ranges::equal(pack(a).levels, pack(b).levels, equal);
}

/// Each edit takes a voxel that is there or lowers its level, and what is left is `now`.
void check_edits(VoxelModel model, std::span<const Edit> edits, const VoxelModel& now) {
  for (const Edit& edit : edits) {
    if (edit.body != 0) continue;
    const FillLevel level = model.level(model.grid.cell_of_linear(edit.voxel));
    if (level == 0) throw Hdf5Error("earlier/edits: a voxel removed that is not there");
    if (edit.level >= level) throw Hdf5Error("earlier/fills: a level that does not fall");
    apply_edit(edit, model);
  }
  if (now.fills ? !same_levels(model, now) : model.leaves != now.leaves) {
    throw Hdf5Error("earlier/edits: they do not lead to the workpiece");
  }
}

}  // namespace

void write_earlier(const Hdf5Handle& file, const EarlierRun& earlier) {
  const auto group = create_group(file, "earlier");
  write_text_attribute(group, "recording", earlier.recording);
  write_text_attribute(group, "scene_sha256", earlier.scene_sha256);
  for_each_count(earlier.measures, [&](const char* name, const std::uint64_t& count) {
    write_attribute(group, name, H5T_STD_U64LE, &count);
  });
  for_each_force(earlier.measures, [&](const char* name, const double& force) {
    write_attribute(group, name, H5T_IEEE_F64LE, &force);
  });
  write_check(group, check_of(earlier));
  write_edits<EditRow>(group, earlier.edits, true, packed);
  const auto lowers = [](const Edit& edit) { return !edit.is_gone(); };
  if (earlier.start.fills || std::ranges::any_of(earlier.edits, lowers)) {
    write_edits<FillRow>(group, earlier.edits, false, packed_fill);
  }
  write_model(group, "workpiece", touched_leaves(earlier.start, earlier.edits));
}

std::optional<EarlierRun> read_earlier(const Hdf5Handle& file, const VoxelModel& now,
                                       std::span<const VoxelGrid> grids,
                                       const std::vector<bool>& filled, std::uint64_t file_bytes) {
  const auto group = open_group_if(file, "earlier");
  if (!group.valid()) return {};
  EarlierRun earlier;
  earlier.recording = read_text_attribute(group, "recording", kMaxNameBytes);
  earlier.scene_sha256 = read_text_attribute(group, "scene_sha256", kMaxNameBytes);
  for_each_count(earlier.measures, [&](const char* name, std::uint64_t& count) {
    read_attribute(group, name, H5T_NATIVE_UINT64, &count);
  });
  for_each_force(earlier.measures, [&](const char* name, double& force) {
    read_attribute(group, name, H5T_NATIVE_DOUBLE, &force);
    if (!std::isfinite(force)) throw Hdf5Error("earlier: a force that is not finite");
  });
  verify_check(group, "earlier", check_of(earlier));
  const auto gone_intact = [&](const EditRow& row) { return is_intact(row, grids); };
  const auto fill_intact = [&](const FillRow& row) { return is_intact(row, grids, filled); };
  earlier.edits = read_edits<EditRow>(group, gone_intact, file_bytes);
  if (now.fills || H5Lexists(group, "fills", H5P_DEFAULT) > 0) {
    earlier.edits =
        in_order(read_edits<FillRow>(group, fill_intact, file_bytes), std::move(earlier.edits));
  }
  earlier.start = as_it_was(now, read_model(group, "workpiece", file_bytes));
  check_edits(earlier.start, earlier.edits, now);
  return earlier;
}

}  // namespace sulcus
