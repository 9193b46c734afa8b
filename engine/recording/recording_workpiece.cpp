#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/core/hash.hpp"
#include "engine/recording/hdf5_fixed.hpp"
#include "engine/recording/recording_layout.hpp"
#include "engine/recording/recording_parts.hpp"
#include "engine/volume/edit.hpp"
#include "engine/volume/packed_model.hpp"

namespace sulcus {
namespace {

static_assert(sizeof(LeafBits) == 64 && sizeof(LabelBlock) == 512 && sizeof(LevelBlock) == 512);
static_assert(sizeof(Eigen::Vector3f) == 12 && sizeof(std::array<std::uint32_t, 3>) == 12);

template <class T>
std::uint64_t hash_of(const std::vector<T>& values, std::uint64_t seed) {
  return hash_bytes(values.data(), values.size() * sizeof(T), seed);
}

std::array<std::uint32_t, 3> stored_cells(const VoxelGrid& grid) {
  std::array<std::uint32_t, 3> cells{};
  for (int axis = 0; axis < 3; ++axis) cells[axis] = static_cast<std::uint32_t>(grid.cells[axis]);
  return cells;
}

std::uint64_t check_of(const PackedModel& packed) {
  const auto cells = stored_cells(packed.grid);
  const std::uint8_t clipped = packed.clipped ? 1 : 0;
  std::uint64_t hash = hash_bytes(cells.data(), sizeof cells);
  hash = hash_bytes(&packed.grid.voxel_m, sizeof packed.grid.voxel_m, hash);
  hash = hash_bytes(&clipped, 1, hash);
  hash = hash_of(packed.leaves, hash);
  hash = hash_of(packed.words, hash);
  hash = hash_of(packed.leaf_labels, hash);
  hash = hash_of(packed.mixed, hash);
  hash = hash_of(packed.mixed_labels, hash);
  for (const LeafLevels& page : packed.levels) {
    hash = hash_bytes(&page.leaf, sizeof page.leaf, hash);
    hash = hash_bytes(page.levels.data(), page.levels.size(), hash);
  }
  return hash;
}

std::uint64_t check_of(const TriangleMesh& mesh) {
  return hash_of(mesh.triangles, hash_of(mesh.positions, 0));
}

/// Rising and below `end`.
void check_indices(const std::vector<std::uint32_t>& indices, std::uint64_t end, const char* name) {
  if (!is_rising_below(indices, end)) {
    throw Hdf5Error(std::string(name) + ": indices out of order or range");
  }
}

VoxelGrid read_grid_of(const Hdf5Handle& group) {
  VoxelGrid grid;
  std::uint32_t cells[3]{};
  read_attribute(group, "cells", H5T_NATIVE_UINT32, cells, 3);
  for (int axis = 0; axis < 3; ++axis) {
    if (cells[axis] == 0 || cells[axis] > kMaxCellsPerAxis || cells[axis] % kLeafEdge != 0) {
      throw Hdf5Error("cells: " + std::to_string(cells[axis]) + " is no multiple of 8 up to 1024");
    }
    grid.cells[axis] = static_cast<int>(cells[axis]);
  }
  read_attribute(group, "voxel_m", H5T_NATIVE_DOUBLE, &grid.voxel_m);
  if (!(std::isfinite(grid.voxel_m) && grid.voxel_m > 0.0)) {
    throw Hdf5Error("voxel_m: not a positive length");
  }
  return grid;
}

bool is_filled(const Hdf5Handle& group) {
  return H5Lexists(group, "levels", H5P_DEFAULT) > 0 ||
         H5Lexists(group, "levelled", H5P_DEFAULT) > 0;
}

void read_labels(const Hdf5Handle& group, std::uint64_t file_bytes, PackedModel& in) {
  const std::size_t n = in.leaves.size();
  in.leaf_labels =
      read_fixed_rows<std::uint8_t>(group, {"leaf_labels", H5T_STD_U8LE, 1, n}, file_bytes);
  if (in.leaf_labels.size() != n) throw Hdf5Error("leaf_labels: not as many as leaves");
  in.mixed = read_fixed_rows<std::uint32_t>(group, {"mixed", H5T_STD_U32LE, 1, n}, file_bytes);
  check_indices(in.mixed, n, "mixed");
  in.mixed_labels = read_fixed_rows<LabelBlock>(
      group, {"mixed_labels", H5T_STD_U8LE, sizeof(LabelBlock), n}, file_bytes);
  if (in.mixed_labels.size() != in.mixed.size()) {
    throw Hdf5Error("mixed_labels: not as many as mixed");
  }
}

void write_levels(const Hdf5Handle& group, const PackedModel& out) {
  std::vector<std::uint32_t> levelled;
  std::vector<LevelBlock> levels;
  std::uint32_t row = 0;
  for (const LeafLevels& page : out.levels) {
    while (out.leaves[row] != page.leaf) ++row;
    levelled.push_back(row);
    levels.push_back(page.levels);
  }
  write_fixed_rows(group, "levelled", H5T_STD_U32LE, levelled.data(), levelled.size());
  write_fixed_rows(group, "levels", H5T_STD_U8LE, levels.data(), levels.size(), sizeof(LevelBlock));
}

/// A voxel is solid where its level is above 0.
void read_levels(const Hdf5Handle& group, std::uint64_t file_bytes, PackedModel& in) {
  const std::size_t n = in.leaves.size();
  const auto levelled =
      read_fixed_rows<std::uint32_t>(group, {"levelled", H5T_STD_U32LE, 1, n}, file_bytes);
  check_indices(levelled, n, "levelled");
  const auto levels = read_fixed_rows<LevelBlock>(
      group, {"levels", H5T_STD_U8LE, sizeof(LevelBlock), n}, file_bytes);
  if (levels.size() != levelled.size()) throw Hdf5Error("levels: not as many as levelled");
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::uint32_t row = levelled[i];
    for (int place = 0; place < 512; ++place) {
      if ((levels[i][static_cast<std::size_t>(place)] > 0) == in.words[row].has(place)) continue;
      throw Hdf5Error("levels: of leaf " + std::to_string(in.leaves[row]) + " not as its voxels");
    }
    in.levels.push_back({in.leaves[row], levels[i]});
  }
}

}  // namespace

void write_model(const Hdf5Handle& parent, const char* name, const VoxelModel& model) {
  const PackedModel out = pack(model);
  const auto cells = stored_cells(out.grid);
  const std::uint8_t clipped = out.clipped ? 1 : 0;
  const auto group = create_group(parent, name);
  write_attribute(group, "cells", H5T_STD_U32LE, cells.data(), 3);
  write_attribute(group, "voxel_m", H5T_IEEE_F64LE, &out.grid.voxel_m);
  write_attribute(group, "clipped", H5T_STD_U8LE, &clipped);
  write_check(group, check_of(out));
  write_fixed_rows(group, "leaves", H5T_STD_U32LE, out.leaves.data(), out.leaves.size());
  write_fixed_rows(group, "words", H5T_STD_U64LE, out.words.data(), out.words.size(), 8);
  if (out.filled) write_levels(group, out);
  if (!out.labelled) return;
  write_fixed_rows(group, "leaf_labels", H5T_STD_U8LE, out.leaf_labels.data(),
                   out.leaf_labels.size());
  write_fixed_rows(group, "mixed", H5T_STD_U32LE, out.mixed.data(), out.mixed.size());
  write_fixed_rows(group, "mixed_labels", H5T_STD_U8LE, out.mixed_labels.data(),
                   out.mixed_labels.size(), sizeof(LabelBlock));
}

void write_bodies(const Hdf5Handle& file, std::span<const VoxelModel* const> models) {
  if (models.empty()) return;
  const auto group = create_group(file, "bodies");
  for (std::size_t i = 0; i < models.size(); ++i) {
    write_model(group, std::to_string(i).c_str(), *models[i]);
  }
}

VoxelModel read_model(const Hdf5Handle& parent, const char* name, std::uint64_t file_bytes) {
  const auto group = open_group(parent, name);
  PackedModel in;
  in.grid = read_grid_of(group);
  const std::uint32_t leaf_count = in.grid.leaf_count();
  std::uint8_t clipped = 0;
  read_attribute(group, "clipped", H5T_NATIVE_UINT8, &clipped);
  in.clipped = clipped != 0;
  in.leaves =
      read_fixed_rows<std::uint32_t>(group, {"leaves", H5T_STD_U32LE, 1, leaf_count}, file_bytes);
  check_indices(in.leaves, leaf_count, "leaves");
  in.words = read_fixed_rows<LeafBits>(group, {"words", H5T_STD_U64LE, 8, leaf_count}, file_bytes);
  if (in.words.size() != in.leaves.size()) throw Hdf5Error("words: not as many as leaves");
  in.labelled = H5Lexists(group, "leaf_labels", H5P_DEFAULT) > 0;
  if (in.labelled) read_labels(group, file_bytes, in);
  in.filled = is_filled(group);
  if (in.filled) read_levels(group, file_bytes, in);
  verify_check(group, name, check_of(in));
  return unpack(in);
}

namespace {

/// visit(the group of all, name in it).
template <class Visit>
void for_each_body(const Hdf5Handle& file, const Visit& visit) {
  const auto group = open_group_if(file, "bodies");
  if (!group.valid()) return;
  for (std::size_t body = 0; body < kMaxBodies; ++body) {
    const std::string name = std::to_string(body);
    if (H5Lexists(group, name.c_str(), H5P_DEFAULT) <= 0) return;
    visit(group, name);
  }
}

}  // namespace

std::vector<VoxelGrid> read_grids(const Hdf5Handle& file) {
  std::vector<VoxelGrid> grids{read_grid_of(open_group(file, "workpiece"))};
  for_each_body(file, [&](const Hdf5Handle& bodies, const std::string& name) {
    grids.push_back(read_grid_of(open_group(bodies, name.c_str())));
  });
  return grids;
}

std::vector<bool> read_which_are_filled(const Hdf5Handle& file) {
  std::vector<bool> filled{is_filled(open_group(file, "workpiece"))};
  for_each_body(file, [&](const Hdf5Handle& bodies, const std::string& name) {
    filled.push_back(is_filled(open_group(bodies, name.c_str())));
  });
  return filled;
}

std::vector<VoxelModel> read_bodies(const Hdf5Handle& file, std::uint64_t file_bytes) {
  std::vector<VoxelModel> models;
  for_each_body(file, [&](const Hdf5Handle& bodies, const std::string& name) {
    models.push_back(read_model(bodies, name.c_str(), file_bytes));
  });
  return models;
}

std::optional<VoxelModel> read_goal(const Hdf5Handle& file, std::uint64_t file_bytes) {
  if (H5Lexists(file, "goal", H5P_DEFAULT) <= 0) return {};
  VoxelModel goal = read_model(file, "goal", file_bytes);
  if (goal.grid.cells != read_grid_of(open_group(file, "workpiece")).cells) {
    throw Hdf5Error("goal: on another grid than the workpiece");
  }
  return goal;
}

namespace {

/// Calls `use(name, first, count)` for each attribute of /input that holds numbers of an
/// InputGeometry, in the layout's order, which is theirs.
template <class Use>
void for_each_input_attribute(const Use& use) {
  std::size_t first = 0;
  for (const StoredField& field : find_stored_part("/input")->fields) {
    if (field.type != StoredType::kF64) continue;  // the check
    use(std::string(field.name).c_str(), first, hsize_t{field.count});
    first += field.count;
  }
  if (first != InputGeometry::kNumbers) throw std::logic_error("/input: not as its numbers");
}

}  // namespace

void write_input(const Hdf5Handle& file, const InputGeometry& input) {
  const auto group = create_group(file, "input");
  const auto numbers = input.numbers();
  for_each_input_attribute([&](const char* name, std::size_t first, hsize_t count) {
    write_attribute(group, name, H5T_IEEE_F64LE, numbers.data() + first, count);
  });
  write_check(group, hash_bytes(numbers.data(), sizeof numbers));
}

std::optional<InputGeometry> read_input(const Hdf5Handle& file) {
  const auto group = open_group_if(file, "input");
  if (!group.valid()) return std::nullopt;
  std::array<double, InputGeometry::kNumbers> numbers{};
  for_each_input_attribute([&](const char* name, std::size_t first, hsize_t count) {
    read_attribute(group, name, H5T_NATIVE_DOUBLE, numbers.data() + first, count);
  });
  verify_check(group, "input", hash_bytes(numbers.data(), sizeof numbers));
  std::optional<InputGeometry> input = InputGeometry::of(numbers);
  if (!input) throw Hdf5Error("input: numbers that are no geometry");
  return input;
}

void write_burr(const Hdf5Handle& file, const TriangleMesh& mesh_tool) {
  const auto group = create_group(file, "burr");
  write_check(group, check_of(mesh_tool));
  write_fixed_rows(group, "positions", H5T_IEEE_F32LE, mesh_tool.positions.data(),
                   mesh_tool.positions.size(), 3);
  write_fixed_rows(group, "triangles", H5T_STD_U32LE, mesh_tool.triangles.data(),
                   mesh_tool.triangles.size(), 3);
}

std::optional<TriangleMesh> read_burr(const Hdf5Handle& file, std::uint64_t file_bytes) {
  const auto group = open_group_if(file, "burr");
  if (!group.valid()) return std::nullopt;
  constexpr hsize_t kMaxRows = 1u << 28;  // a mesh of 3 GiB
  TriangleMesh mesh;
  mesh.positions = read_fixed_rows<Eigen::Vector3f>(
      group, {"positions", H5T_IEEE_F32LE, 3, kMaxRows}, file_bytes);
  mesh.triangles = read_fixed_rows<std::array<std::uint32_t, 3>>(
      group, {"triangles", H5T_STD_U32LE, 3, kMaxRows}, file_bytes);
  verify_check(group, "burr", check_of(mesh));
  for (const Eigen::Vector3f& p : mesh.positions) {
    if (!p.allFinite()) throw Hdf5Error("burr/positions: a value that is not finite");
  }
  for (const auto& triangle : mesh.triangles) {
    for (std::uint32_t corner : triangle) {
      if (corner >= mesh.positions.size()) throw Hdf5Error("burr/triangles: a corner out of range");
    }
  }
  return mesh;
}

}  // namespace sulcus
