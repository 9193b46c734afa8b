#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tools/sulcus_lab/ticks/ticks_measurement.hpp"

namespace sulcus::lab {

/// One setting at one size of what is swept: cells along an axis, or bodies.
struct SweepRow {
  int size = 0;
  TickSetting setting;
  int wanted = 0;  // voxels in contact
  TickSummary summary;
};

/// The same contacts in ever larger grids: a plate of 1.5 mm, tilted by 20 degrees, that goes from
/// face to face of the grid, with the same voxels, 34.8 um, the same burr and the same poses. The
/// voxels in contact are the same to the last; what grows is the plate around them, the tree over
/// it and the strides in memory. All grids are held at once and have their turn in every
/// repetition. Fresh and kept normals.
std::vector<SweepRow> measure_cells(std::span<const int> cells, std::span<const int> contacts,
                                    const TicksPlan& plan,
                                    const std::function<void(const std::string&)>& progress);

/// More and more bodies in the broad phase, one of them touched; the others, as large, stand in a
/// row beside it. Fresh and kept normals.
std::vector<SweepRow> measure_bodies(Workpiece& workpiece, const TickGround& ground,
                                     std::span<const int> bodies, int contacts,
                                     const TicksPlan& plan,
                                     const std::function<void(const std::string&)>& progress);

/// The largest ratio of the last size's mean time to the first's, over the settings.
double growth_of(std::span<const SweepRow> rows);

}  // namespace sulcus::lab
