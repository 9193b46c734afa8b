#pragma once

#include <string>

#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"

namespace sulcus {

/// What inspect says of a burr.
struct BurrFacts {
  double diameter_m = 0.0;     // the largest of the head
  double length_m = 0.0;       // of all that is modelled
  double field_error_m = 0.0;  // the largest that was found, near the surface
};

/// Generated: the field's error against the exact distance in a plane through the axis, within four
/// samples of the surface, half way between samples too. From a file: its value at the mesh's
/// vertices, where it should be 0.
BurrFacts burr_facts(const Burr& burr, const BurrSettings& settings);

/// Loads a scene's burr, prints size, field and error, and draws it where `picture_png` names a
/// file. Errors as load_burr; std::runtime_error where gnuplot cannot.
void show_burr(const Scene& scene, const std::string& picture_png);

/// A name for the picture and the first line: "round, 1.4 mm".
std::string burr_title(const BurrSettings& settings, const BurrFacts& facts);

/// Draws the field in a plane through the axis: all of the burr, and its head, with lines of equal
/// distance, the surface (what cuts apart from what does not), the true outline in white over it,
/// diameter and length. False where gnuplot cannot.
bool draw_burr(const Burr& burr, const BurrFacts& facts, const BurrSettings& settings,
               const std::string& file_png);

}  // namespace sulcus
