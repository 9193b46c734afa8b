#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tools/sulcus_lab/fractions/fractions.hpp"
#include "tools/sulcus_lab/results.hpp"

namespace sulcus::lab {

namespace {

/// Surface voxels by how the surface curves at them, 1 / voxel.
struct CurvatureZone {
  std::string name;
  double from, to;
};
const CurvatureZone kCurvatureZones[] = {
    {"all", 0.0, HUGE_VAL}, {"gently curved", 0.0, 0.1}, {"strongly curved", 0.1, HUGE_VAL}};

/// Root mean square of the offset's error, mean of the normal's.
struct CtMeans {
  double offset = 0.0, normal_deg = 0.0;
};
CtMeans means_in(const CurvatureZone& zone, const CtErrors& errors) {
  CtMeans means;
  double voxels = 0.0;
  for (const CtVoxel& voxel : errors.voxels) {
    if (!(voxel.curvature >= zone.from && voxel.curvature < zone.to)) continue;
    voxels += 1.0;
    means.offset += voxel.offset_error * voxel.offset_error;
    means.normal_deg += voxel.normal_error_deg;
  }
  return {std::sqrt(means.offset / voxels), means.normal_deg / voxels};
}

void add_rows(const CtErrorsOfAll& errors, const std::string& voxels,
              std::vector<FractionRow>& rows) {
  for (std::size_t t = 0; t < 2; ++t) {
    for (const CurvatureZone& zone : kCurvatureZones) {
      FractionRow offset, normal;
      offset.quantity = "offset_error_voxels";
      normal.quantity = "normal_error_deg";
      for (std::size_t s = 0; s < 2; ++s) {
        const CtMeans means = means_in(zone, errors[t][s]);
        offset.value[s] = means.offset;
        normal.value[s] = means.normal_deg;
      }
      for (FractionRow* row : {&offset, &normal}) {
        row->shape = "ct, " + std::string(kCtTruthNames[t]);
        row->setting = voxels + ", " + zone.name;
        row->wanted = row->binary();  // to be better than
        rows.push_back(*row);
      }
    }
  }
}

}  // namespace

std::vector<FractionRow> fractions_of_ct(const FractionOptions& options) {
  std::vector<FractionRow> rows;
  if (!options.ct) return rows;
  const CtErrorsOfAll own = ct_errors(*options.ct, 1, options.progress);
  options.take_bins(ct_bins(own));
  add_rows(own, "the file's voxels", rows);
  if (options.quick) return rows;
  add_rows(ct_errors(*options.ct, 3, options.progress), "27 to one of the file's", rows);
  return rows;
}

}  // namespace sulcus::lab
