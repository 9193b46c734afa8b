#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "engine/assessment/placed_figure.hpp"
#include "engine/core/triangle_mesh.hpp"
#include "engine/scene/assessment_table.hpp"

namespace sulcus {

enum class ToothSide : std::uint8_t { kMesial, kDistal, kBuccal, kLingual };

/// The shape of what was cut, as an examiner measures it. Lengths along the path of insertion or
/// across it. None: the preparation has no such thing.
struct PreparationShape {
  double removed_mm3 = 0.0;
  /// Of the largest floor, or of a crown's occlusal face: how far it lies below the tooth as it
  /// was; the mean, at its deepest place and its shallowest. Flatness: RMS from its best plane.
  std::optional<PlacedFigure> depth_mm, greatest_depth_mm, least_depth_mm, floor_flatness_um;
  /// Between walls that face each other, above 0 where the shape opens outward; its place is that
  /// of the wall that is most unlike the others.
  std::optional<PlacedFigure> convergence_deg;
  /// The taper of the walls of each side, by ToothSide, above 0 where they open outward; its place
  /// is that of the wall that is most unlike the others of the side. None also where the path of
  /// insertion lies within 30 degrees of the direction of the side.
  std::array<std::optional<PlacedFigure>, 4> wall_deg;
  /// Ra of the walls, the mean, and that of the roughest patch, at it.
  std::optional<PlacedFigure> roughness_um, greatest_roughness_um;
  /// What is hidden, along the path of insertion, by tooth above it, by area across the path.
  PlacedFigure undercut_mm2;
  /// Of a cavity halfway down: the widest disc that fits, and the widest that can be moved through
  /// all of it.
  std::optional<PlacedFigure> width_mm, isthmus_mm;
  /// Of a crown's finish line: the median of its width, at its narrowest place.
  std::optional<PlacedFigure> margin_mm;
  /// How steeply the finish line falls away from the wall, the median, at its steepest place. 0: a
  /// shoulder across the path.
  std::optional<PlacedFigure> margin_slope_deg;
  /// From a cavity's walls through the tooth to its outside, across the path: the least. Where they
  /// are thicker than is looked at, 6 mm and more: that.
  std::optional<PlacedFigure> wall_left_mm;
};

struct ShapeSettings {
  AssessedKind kind = AssessedKind::kCavity;
  Eigen::Vector3d insertion{0, 0, 1};  // out of the tooth, a unit vector
  /// Out of the tooth to these sides, unit vectors.
  Eigen::Vector3d mesial{1, 0, 0}, buccal{0, -1, 0};
  /// Overhangs that reach out less are roughness; so are those of less than two rays.
  double least_overhang_mm = 0.08;
  double pitch_mm = 0.02;  // between rays
};

inline ShapeSettings shape_settings(const AssessmentSettings& settings) {
  return {.kind = settings.kind,
          .insertion = settings.insertion,
          .mesial = settings.mesial,
          .buccal = settings.buccal,
          .pitch_mm = settings.voxel_mm};
}

/// Compares closed surfaces of a tooth before and after, in metres, in one space. They may be of
/// different resolution; what differs by less than 0.05 mm is taken for the same. None where
/// nothing was removed. On rays along the path of insertion that stand `pitch_mm` apart, or where
/// the cut is large, so far that there are at most 2 million; walls by fits (cut_walls.hpp).
std::optional<PreparationShape> preparation_shape(const TriangleMesh& before,
                                                  const TriangleMesh& after,
                                                  const ShapeSettings& settings);

}  // namespace sulcus
