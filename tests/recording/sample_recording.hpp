#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/core/hash.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/recording/recording_writer.hpp"

namespace sulcus::sample {

// A recording whose every row follows from its number, so that any prefix of it can be checked.

inline RecordingHeader header() {
  return {"title = \"Größe\"\n[workpiece]\nshape = \"molar\"\n", std::string(64, 'a'), "test build",
          1000.0, 0x0123456789abcdefu};
}

/// A ball of two tissues, in leaves that are full, mixed, part full and empty.
inline VoxelModel make_workpiece() {
  VoxelModel model;
  model.grid.cells = {64, 48, 32};
  model.grid.voxel_m = 34.8e-6;
  model.leaves.resize(model.grid.leaf_count());
  model.clipped = true;
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    LabelBlock labels{};
    for (int v = 0; v < 512; ++v) {
      const Cell in_leaf(v & 7, v >> 3 & 7, v >> 6);
      const Cell c = model.grid.leaf_origin(leaf) + in_leaf;
      const double r = (c.cast<double>() - model.grid.origin_index()).norm();
      if (r < 20.0) model.set(c, true);
      labels[v] = r < 9.0 ? 3 : 1;
    }
    tissues->set_block(leaf, labels, model.leaves[leaf]);
  }
  model.tissues = tissues;
  return model;
}
inline const VoxelModel& workpiece() {
  static const VoxelModel model = make_workpiece();
  return model;
}

inline TriangleMesh burr() {
  return {{{0, 0, 0}, {1e-3f, 0, 0}, {0, 1e-3f, 0}, {0, 0, 1e-3f}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

inline std::uint64_t edits_of(std::uint64_t tick) { return tick % 7; }

inline std::uint64_t edits_end(std::uint64_t tick) {
  const std::uint64_t rest = tick % 7;
  return tick / 7 * 21 + rest * (rest + 1) / 2;
}

inline std::vector<Edit> edits(std::uint64_t tick) {
  std::vector<Edit> out(edits_of(tick));
  for (std::uint32_t i = 0; i < out.size(); ++i) {
    const std::uint64_t random = hash_bytes(&tick, sizeof tick, i);
    out[i] = {tick, static_cast<std::uint32_t>(random % (64 * 48 * 32)), 0,
              static_cast<EditCause>(random % 3)};
  }
  return out;
}

inline TickRecord tick(std::uint64_t number) {
  TickRecord row;
  row.tick = number;
  row.time_s = 1e-3 * static_cast<double>(number);
  for (int i = 0; i < 3; ++i) {
    row.device_position_m[i] = row.time_s + i;
    row.tool_position_m[i] = row.time_s - i;
    row.force_N[i] = row.time_s * i;
    row.torque_Nm[i] = -row.time_s * i;
    row.contact_force_N[i] = 2 * row.time_s;
    row.contact_torque_Nm[i] = 3 * row.time_s;
  }
  row.contacts = static_cast<std::uint32_t>(number * 3);
  row.removed = static_cast<std::uint32_t>(edits_of(number));
  row.step_us = static_cast<float>(number % 100);
  row.edits_end = edits_end(number);
  seal(row);
  return row;
}

inline StateHash state_hash(std::uint64_t tick) { return {tick, tick * 7919, tick * 104729}; }

/// Ticks `first` to `last`, with their edits and a state hash every 10.
inline void append(RecordingWriter& writer, std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t t = first; t <= last; ++t) {
    writer.append_edits(edits(t));
    const TickRecord row = tick(t);
    writer.append_ticks({&row, 1});
    if (t % 10 == 0) writer.append_state_hash(state_hash(t));
  }
}

inline bool same(const Edit& a, const Edit& b) {
  return a.tick == b.tick && a.voxel == b.voxel && a.body == b.body && a.cause == b.cause;
}

inline auto bits(const TickRecord& row) {
  return std::bit_cast<std::array<std::byte, sizeof(TickRecord)>>(row);
}

/// Every row that the reader gives is the one that was written.
inline void expect_true_prefix(const RecordingReader& reader) {
  const auto rows = reader.ticks();
  ASSERT_EQ(rows.size(), reader.tick_count());
  std::vector<Edit> expected;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_TRUE(bits(rows[i]) == bits(tick(i + 1))) << "row " << i;
    for (const Edit& edit : edits(i + 1)) expected.push_back(edit);
  }
  const auto read = reader.edits();
  ASSERT_EQ(read.size(), expected.size());
  for (std::size_t i = 0; i < read.size(); ++i) ASSERT_TRUE(same(read[i], expected[i])) << i;
  for (const StateHash& hash : reader.state_hashes()) {
    const StateHash written = state_hash(hash.tick);
    ASSERT_EQ(hash.tick % 10, 0u);
    ASSERT_LE(hash.tick, rows.size());
    ASSERT_EQ(hash.volume, written.volume);
    ASSERT_EQ(hash.state, written.state);
  }
}

inline void expect_same_header(const RecordingHeader& read) {
  const RecordingHeader written = header();
  EXPECT_EQ(read.scene_toml, written.scene_toml);
  EXPECT_EQ(read.scene_sha256, written.scene_sha256);
  EXPECT_EQ(read.build, written.build);
  EXPECT_EQ(read.rate_hz, written.rate_hz);
  EXPECT_EQ(read.workpiece_hash, written.workpiece_hash);
}

inline void expect_same_workpiece(const VoxelModel& read, const VoxelModel& written) {
  ASSERT_EQ(read.grid.cells, written.grid.cells);
  EXPECT_EQ(read.grid.voxel_m, written.grid.voxel_m);
  EXPECT_EQ(read.clipped, written.clipped);
  ASSERT_EQ(read.leaves, written.leaves);
  ASSERT_EQ(read.tissues == nullptr, written.tissues == nullptr);
  if (!read.tissues) return;
  for (std::uint32_t leaf = 0; leaf < read.grid.leaf_count(); ++leaf) {
    const LabelBlock* a = read.tissues->block(leaf);
    const LabelBlock* b = written.tissues->block(leaf);
    ASSERT_EQ(a == nullptr, b == nullptr) << "leaf " << leaf;
    if (a) {
      ASSERT_EQ(*a, *b) << "leaf " << leaf;
    } else {
      ASSERT_EQ(read.tissues->uniform_label(leaf), written.tissues->uniform_label(leaf));
    }
  }
}

/// A folder of its own for each test, removed afterwards.
class RecordingTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name =
        (std::filesystem::temp_directory_path() / "sulcus_recording_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name = "recording.h5") const {
    return (folder_ / name).string();
  }
  /// A recording of `ticks` ticks, closed.
  std::string write_whole(std::uint64_t ticks) const {
    const TriangleMesh mesh = burr();
    RecordingWriter writer(path(), header(), workpiece(), &mesh);
    append(writer, 1, ticks);
    writer.close();
    return path();
  }

  std::filesystem::path folder_;
};

}  // namespace sulcus::sample
