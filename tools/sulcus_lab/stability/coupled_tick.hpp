#pragma once

#include "tools/sulcus_lab/stability/stability_row.hpp"

namespace sulcus::lab {

/// What iterating the contact costs: burrs with some 40 and 2,000 voxels in contact slid over a
/// face at 1 to 20 mm/s, behind the coupling, and beside it the plain tick with the tool put at the
/// same poses. Rows of the case `coupled_tick`: thread CPU time, and ratios of means in one run.
CaseResult coupled_tick(bool brief);

}  // namespace sulcus::lab
