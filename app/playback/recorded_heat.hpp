#pragma once

#include <optional>
#include <string>

#include "engine/heat/heat_log.hpp"
#include "engine/heat/tooth_heat.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/scene/scene.hpp"
#include "engine/scene/section.hpp"
#include "engine/surface/colour_scale.hpp"
#include "engine/volume/voxel_model.hpp"
#include "engine/volume/voxel_values.hpp"

namespace sulcus {

/// What a recording says of heat: the log that its run made of the same rows.
HeatLog recorded_heat_log(const RecordingReader& reader);

/// The temperature of a recorded tooth, from its start on.
class RecordedHeat {
 public:
  /// `start`: the workpiece before the first row. `option`: what asks for it. InputError where the
  /// recording's scene has no [heat].
  RecordedHeat(const RecordingReader& reader, const Scene& scene, const VoxelModel& start,
               const std::string& option);

  /// Goes on to a time of the run.
  void advance(double time_s) { tooth_.advance(log_, time_s); }
  /// Goes on to the end.
  void advance_to_end();
  const ToothHeat& tooth() const { return tooth_; }

 private:
  HeatLog log_;
  ToothHeat tooth_;
};

/// About the start, so that what is warmer stands apart from what is cooler; it ends at twice the
/// pulp's limit above and below.
ColourScale temperature_scale(const HeatSettings& heat);

/// Temperatures, C, of the voxels at the surface of `now`, the workpiece at the same time, and of
/// those that a section may show.
VoxelValues temperatures(const ToothHeat& tooth, const VoxelModel& now,
                         const std::optional<Section>& section);

}  // namespace sulcus
