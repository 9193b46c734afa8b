#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/import/volumes/grey_histogram.hpp"
#include "engine/import/volumes/medical_volume.hpp"

namespace sulcus {

/// The largest solid part of a volume, as a scene would take it.
struct SolidFacts {
  std::uint64_t voxels = 0;  // of the largest part; of a mask, of all
  std::size_t parts = 0;
  Eigen::AlignedBox3i box_index;   // of its voxels, both ends inside
  Eigen::AlignedBox3d box_file_m;  // of its surface along the file's axes, a voxel wide around it
  Eigen::Vector3d top_file_m = Eigen::Vector3d::Zero();  // middle of its highest row
};

/// What inspect says of a volume, and what its picture shows.
struct VolumeFacts {
  std::vector<LabelCount> labels;                   // empty: grey values
  GreyHistogram histogram;                          // of grey values
  std::optional<double> two_classes;                // Otsu's threshold between air and solid
  std::vector<double> three_classes;                // his two between air, dentine and enamel
  std::optional<double> solid_above, enamel_above;  // those of them that are suggested
  std::optional<std::array<double, 2>> ramp;        // between empty and full, of fractions
  std::optional<SolidFacts> solid;                  // none: all of one value, or no value above 0

  /// From which the picture's outline is drawn: a mask's lies half way.
  double outline() const { return solid_above.value_or(0.5); }
};

/// Of a voxel, whose axes may be sheared.
double voxel_volume_mm3(const MedicalVolume& volume);

/// Parallel nowhere; a volume of 512^3 takes seconds.
VolumeFacts volume_facts(const MedicalVolume& volume);

enum class SpacingFrom : std::uint8_t { kFile, kUser };

/// The command that cuts it, to be given to a shell as it is: the shipped scene for a volume, a
/// tissue for each value of a label map, a grid that just holds the solid, and a way for the burr,
/// down on its highest place. `spacing`: where it is not the file's, it has to be given again.
std::string cutting_command(const MedicalVolume& volume, const VolumeFacts& facts,
                            SpacingFrom spacing);

/// Draws three sections through the middle of the solid (of the volume, where there is none) in
/// true proportion and at one scale, with the outline at the threshold, and the histogram of grey
/// values with the thresholds marked. False where gnuplot cannot.
bool draw_volume(const MedicalVolume& volume, const VolumeFacts& facts,
                 const std::string& file_png);

}  // namespace sulcus
