#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/sulcus_lab/fractions/ct_errors.hpp"
#include "tools/sulcus_lab/fractions/fraction_row.hpp"

namespace sulcus::lab {

struct FractionOptions {
  bool quick = false;        // what takes seconds, for tests
  std::optional<CtFile> ct;  // none: nothing is measured of grey values
  /// Is given what is being done; what is slow has several steps.
  std::function<void(const std::string&)> progress = [](const std::string&) {};
  /// Is given the lines of a chart of the errors of a CT.
  std::function<void(std::span<const CtBin>)> take_bins = [](std::span<const CtBin>) {};
};

/// What is measured on surfaces of whole voxels and on the same with fractions, side by side.
struct FractionMeasurement {
  std::string_view name;
  std::vector<FractionRow> (*measure)(const FractionOptions&);
  bool has_quick_half;    // else with `quick` it is left out
  bool needs_ct = false;  // else without one it is left out
};

/// In the order of the table.
std::span<const FractionMeasurement> fraction_measurements();

// Each of them. All throw InputError as the scenes and shapes that they load.

/// Mean errors of ldm at NS 6 where the normals are known.
std::vector<FractionRow> fractions_of_normals(const FractionOptions& options);
/// A burr slides 0.1 mm deep over planes that are nearly along the grid, and does not cut.
std::vector<FractionRow> fractions_of_planes(const FractionOptions& options);
/// The net force on the molar against that of the continuous surface.
std::vector<FractionRow> fractions_of_net_force(const FractionOptions& options);
/// The grain of the force while scenes cut straight on.
std::vector<FractionRow> fractions_of_grain(const FractionOptions& options);
/// What a burr that cuts all that it meets removes, against the volume that it sweeps.
std::vector<FractionRow> fractions_of_sweeps(const FractionOptions& options);
/// What a constant push removes in coarse voxels and in fine ones.
std::vector<FractionRow> fractions_of_pushes(const FractionOptions& options);
/// The fitted surface and its normal against the surface in the grey values of a CT; no row without
/// one.
std::vector<FractionRow> fractions_of_ct(const FractionOptions& options);
/// The triangles that are exported and drawn against shapes in closed form.
std::vector<FractionRow> fractions_of_surfaces(const FractionOptions& options);
/// Memory of the molar.
std::vector<FractionRow> fractions_of_memory(const FractionOptions& options);
/// Ticks with normals found anew, kept, and while cutting.
std::vector<FractionRow> fractions_of_ticks(const FractionOptions& options);

}  // namespace sulcus::lab
