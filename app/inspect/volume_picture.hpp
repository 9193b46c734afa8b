#pragma once

#include <string>

#include "app/inspect/volume_facts.hpp"
#include "engine/import/volumes/medical_volume.hpp"

namespace sulcus {

/// Draws three sections through the middle of the solid (of the volume, where there is none) in
/// true proportion and at one scale, with the outline at the threshold, and the histogram of grey
/// values with the thresholds marked. False where gnuplot cannot.
bool draw_volume(const MedicalVolume& volume, const VolumeFacts& facts,
                 const std::string& file_png);

}  // namespace sulcus
