#include "engine/normals/normal_method.hpp"

#include "engine/normals/exact.hpp"
#include "engine/normals/ldm.hpp"
#include "engine/normals/ldm_fast.hpp"
#include "engine/normals/ldm_filled.hpp"
#include "engine/normals/ldm_paper.hpp"
#include "engine/normals/map_kernels.hpp"
#include "engine/normals/quadric_filter.hpp"
#include "engine/normals/weighted_sum.hpp"
#include "engine/normals/window_filter.hpp"

namespace sulcus {

void prepare_normals() noexcept {
  map_kernels();
  quadric_filter(1, lanes_of(1));
  window_filter(2);
}

void estimate_surfaces(const Workpiece& workpiece, std::span<const VoxelQuery> queries,
                       const NormalSettings& settings,
                       std::span<SurfaceEstimate> estimates) noexcept {
  if (queries.empty()) return;
  const int ns = settings.neighbourhood, trace = settings.trace;
  const auto one_by_one = [&](const auto& estimate) {
    for (std::size_t k = 0; k < queries.size(); ++k) estimates[k] = estimate(queries[k].voxel);
  };
  if (workpiece.has_fills() && use_tool(settings.normals)) {
    return estimate_ldm_filled(workpiece, queries, ns, trace, estimates);
  }
  switch (settings.normals) {
    case NormalMethod::kLdm:
      return estimate_ldm(workpiece, queries, ns, trace, estimates);
    case NormalMethod::kLdmFast:
      return estimate_ldm_fast(workpiece, queries, ns, trace, estimates);
    case NormalMethod::kLdmPaper:
      return one_by_one([&](const Cell& c) { return estimate_ldm_paper(workpiece, c, ns, trace); });
    case NormalMethod::kWeightedSum:
      return one_by_one([&](const Cell& c) {
        return estimate_weighted_sum(workpiece, c, ns, WeightedSum::kAsStated);
      });
    case NormalMethod::kWeightedSumD2:
      return one_by_one([&](const Cell& c) {
        return estimate_weighted_sum(workpiece, c, ns, WeightedSum::kAsPlotted);
      });
    case NormalMethod::kExact:
      return one_by_one([&](const Cell& c) { return estimate_exact(workpiece, c, ns); });
  }
}

SurfaceEstimate estimate_surface(const Workpiece& workpiece, const Cell& voxel,
                                 const NormalSettings& settings,
                                 const Eigen::Vector3f& outward) noexcept {
  const VoxelQuery query{voxel, outward};
  SurfaceEstimate estimate;
  estimate_surfaces(workpiece, std::span(&query, 1), settings, std::span(&estimate, 1));
  return estimate;
}

}  // namespace sulcus
