#pragma once

#include <cstddef>

#include "tools/sulcus_lab/ticks/ticks_path.hpp"

namespace sulcus::lab {

/// What a tick cannot do without: bytes that it has to touch, each counted once however often it is
/// asked for, and the time to read as many.
struct TickFloor {
  double surface = 0.0;  // the surface bits of the leaves that hold contacts, 64 bytes each
  double field = 0.0;    // the field's samples at the corners around each contact's centre, 4 each
  double columns = 0.0;  // fresh: the column words that hold a contact's map, 4 each
  double kept = 0.0;     // kept: normal and offset of each contact, 16 bytes
  double records = 0.0;  // what the stages hand on of each contact
  double gb_per_s = 0.0;
  double us = 0.0;

  double bytes() const { return surface + field + columns + kept + records; }
};

/// At the path's first pose, by counting the distinct leaves, samples and words. The map is the one
/// of NS 6: 13 x 13 columns along the largest component of the normal, 12 voxels up and down.
/// Samples at the contacts' closest points, half a voxel away, are mostly the same and not counted
/// again. The bandwidth is read_gb_per_s over as many bytes.
TickFloor tick_floor(const Workpiece& workpiece, const TickPath& path, int wanted, bool fresh);

/// Reading that many bytes over and over, thread CPU time, best of several: from whichever cache
/// holds them.
double read_gb_per_s(std::size_t bytes);

}  // namespace sulcus::lab
