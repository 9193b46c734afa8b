#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/core/triangle_mesh.hpp"
#include "engine/recording/earlier_run.hpp"
#include "engine/recording/hdf5_handle.hpp"
#include "engine/recording/recording_header.hpp"
#include "engine/volume/grid.hpp"
#include "engine/volume/input_geometry.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

// The parts of a recording that never change, as the layout has them: they are written before
// readers are let in, so they may be compressed. All throw Hdf5Error. `file_bytes` bounds what the
// file can hold, and so the memory taken.

void write_header(const Hdf5Handle& file, const RecordingHeader& header);

/// @throws InputError where `file` is no recording, or one of a newer version; Hdf5Error where it
/// is damaged.
RecordingHeader read_header(const Hdf5Handle& file, const std::string& path,
                            std::uint64_t file_bytes);

/// A solid as a group: "workpiece", "goal" or one of the bodies. Labels of leaves without a solid
/// voxel are not kept: nothing can come to be there.
void write_model(const Hdf5Handle& parent, const char* name, const VoxelModel& model);
VoxelModel read_model(const Hdf5Handle& parent, const char* name, std::uint64_t file_bytes);

void write_bodies(const Hdf5Handle& file, std::span<const VoxelModel* const> models);
void write_input(const Hdf5Handle& file, const InputGeometry& input);
void write_burr(const Hdf5Handle& file, const TriangleMesh& mesh_tool);
void write_earlier(const Hdf5Handle& file, const EarlierRun& earlier);

/// The grids alone, checked: the workpiece's, then those of the other bodies.
std::vector<VoxelGrid> read_grids(const Hdf5Handle& file);
/// Which of them carry fractions.
std::vector<bool> read_which_are_filled(const Hdf5Handle& file);
/// Of the bodies besides the workpiece.
std::vector<VoxelModel> read_bodies(const Hdf5Handle& file, std::uint64_t file_bytes);
/// None where no goal names a file. Throws also where it is on another grid than the workpiece.
std::optional<VoxelModel> read_goal(const Hdf5Handle& file, std::uint64_t file_bytes);
/// None where the workpiece is a built-in shape, and in a recording made before they had it.
std::optional<InputGeometry> read_input(const Hdf5Handle& file);
/// Empty where the scene generates the burr.
std::optional<TriangleMesh> read_burr(const Hdf5Handle& file, std::uint64_t file_bytes);

/// `now`: the recording's own workpiece at its start; `grids` and `filled`: of all bodies, the
/// workpiece's first. None where the recording says nothing of what came before it. Throws also
/// where the edits do not make `now` of what was before.
std::optional<EarlierRun> read_earlier(const Hdf5Handle& file, const VoxelModel& now,
                                       std::span<const VoxelGrid> grids,
                                       const std::vector<bool>& filled, std::uint64_t file_bytes);

}  // namespace sulcus
