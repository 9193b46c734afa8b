#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tools/sulcus_lab/fractions/fractions.hpp"
#include "tools/sulcus_lab/normals/normals_measurement.hpp"
#include "tools/sulcus_lab/truth/truth_shapes.hpp"

namespace sulcus::lab {

namespace {

constexpr MethodRun kNormalsRuns[] = {{Method::kLdm, 6}};

/// Where mean errors are wanted, degrees.
struct WantedNormals {
  std::string_view shape, zone;
  double wanted_deg;
  bool quick;
};
constexpr WantedNormals kWantedNormals[] = {
    {"sphere", "all", 0.03, true},        {"torus", "all", 0.10, true},
    {"planes", "all", 0.01, true},        {"molar", "all", 0.35, false},
    {"rotated_cube", "face", 0.01, true}, {"rotated_cube", "near", 0.08, true},
    {"rotated_cube", "edge", 4.0, true},  {"molar_cut", "near", 1.0, false},
    {"molar_cut", "edge", 8.0, false}};

std::array<std::vector<NormalsRow>, 2> normals_of_shape(const std::string& shape,
                                                        const FractionOptions& options) {
  std::array<std::vector<NormalsRow>, 2> rows;
  for (std::size_t s = 0; s < rows.size(); ++s) {
    options.progress("normals: " + shape + ", " + std::string(kSurfaceNames[s]));
    rows[s] =
        measure_normals(truth_shapes(shape, kBothSurfaces[s]), kNormalsRuns, options.progress);
  }
  return rows;
}

}  // namespace

std::vector<FractionRow> fractions_of_normals(const FractionOptions& options) {
  std::vector<FractionRow> rows;
  std::map<std::string, std::array<std::vector<NormalsRow>, 2>> measured;
  for (const WantedNormals& wanted : kWantedNormals) {
    if (options.quick && !wanted.quick) continue;
    const std::string shape(wanted.shape);
    if (!measured.contains(shape)) measured[shape] = normals_of_shape(shape, options);
    FractionRow& row = rows.emplace_back();
    row.quantity = "normal_error_deg";
    row.shape = shape;
    row.setting = wanted.zone;
    row.wanted = wanted.wanted_deg;
    for (std::size_t s = 0; s < 2; ++s) {
      for (const NormalsRow& found : measured[shape][s]) {
        if (found.zone != wanted.zone) continue;
        row.value[s] = found.mean_deg;
        row.ns[s] = found.ns_per_normal;
      }
    }
  }
  return rows;
}

}  // namespace sulcus::lab
