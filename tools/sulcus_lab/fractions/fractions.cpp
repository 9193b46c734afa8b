#include "tools/sulcus_lab/fractions/fractions.hpp"

namespace sulcus::lab {

std::span<const FractionMeasurement> fraction_measurements() {
  static const FractionMeasurement kAll[] = {
      {"normals", fractions_of_normals, true},      {"planes", fractions_of_planes, true},
      {"net_force", fractions_of_net_force, false}, {"grain", fractions_of_grain, true},
      {"sweeps", fractions_of_sweeps, true},        {"pushes", fractions_of_pushes, false},
      {"surface", fractions_of_surfaces, true},     {"ct", fractions_of_ct, true, true},
      {"memory", fractions_of_memory, false},       {"ticks", fractions_of_ticks, false}};
  return kAll;
}

}  // namespace sulcus::lab
