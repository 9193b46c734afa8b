#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "engine/recording/earlier_run.hpp"
#include "engine/recording/hdf5_handle.hpp"
#include "engine/volume/grid.hpp"

namespace sulcus {

// The part of a recording that says what came before its first tick, only where it goes on from
// another. Written before readers are let in, as the solids are.
//
//   /earlier    attributes as the layout has them
//     edits         rows as of /edits, compressed
//     workpiece     as /workpiece, of the leaves that these are of alone: the rest is as in
//     /workpiece

/// Throws Hdf5Error.
void write_earlier(const Hdf5Handle& file, const EarlierRun& earlier);
/// `now`: the recording's own workpiece at its start; `grids`: of all bodies, the workpiece's
/// first. `file_bytes` bounds what the file can hold. None where the recording says nothing of it.
/// Throws Hdf5Error, also where the edits do not make `now` of what was before.
std::optional<EarlierRun> read_earlier(const Hdf5Handle& file, const VoxelModel& now,
                                       std::span<const VoxelGrid> grids, std::uint64_t file_bytes);

}  // namespace sulcus
