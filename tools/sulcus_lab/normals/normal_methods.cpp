#include "tools/sulcus_lab/normals/normal_methods.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/normals/exact.hpp"
#include "engine/normals/height_map.hpp"
#include "engine/normals/ldm_paper.hpp"
#include "engine/normals/normal_method.hpp"
#include "engine/normals/weighted_sum.hpp"
#ifdef SULCUS_LAB_WITH_PCL
#include "tools/sulcus_lab/normals/pcl_normals.hpp"
#endif

namespace sulcus::lab {

namespace {

constexpr int kTrace = 12, kPaperTrace = 5;

constexpr MethodInfo kMethods[] = {
    {Method::kLdm, "ldm", kMaxNeighbourhood, 12, Window::kMap, true, 0, 0, 0},
    {Method::kLdmFast, "ldm_fast", kMaxNeighbourhood, 12, Window::kMap, true, 0, 0, 0},
    {Method::kLdmPaper, "ldm_paper", kMaxNeighbourhood, 12, Window::kMap, true, 0, 0, 0},
    {Method::kWeightedSum, "weighted_sum", 12, 12, Window::kCube, true, 20000, 4000, 4},
    {Method::kWeightedSumD2, "weighted_sum_d2", 12, 12, Window::kCube, true, 20000, 4000, 4},
    {Method::kPca, "pca", 12, 6, Window::kBallOfPoints, false, 20000, 4000, 1},
    {Method::kMls, "mls", 12, 6, Window::kBallOfPoints, false, 20000, 4000, 1},
    {Method::kExact, "exact", 12, 6, Window::kCube, true, 10000, 2000, 1},
};

/// Kept apart so that a loop holds one method's code alone.
template <class Estimate>
void for_each_cell(const VoxelSample& sample, std::vector<SurfaceEstimate>& estimates,
                   const Estimate& estimate) {
  estimates.resize(sample.cells.size());
  for (std::size_t v = 0; v < sample.cells.size(); ++v) estimates[v] = estimate(sample.cells[v]);
}

Eigen::Vector3f outward_of(const std::optional<Eigen::Vector3d>& tool_direction) {
  return tool_direction ? Eigen::Vector3f(tool_direction->cast<float>()) : Eigen::Vector3f::Zero();
}

VoxelSample queries_of(std::vector<Cell> cells, const Eigen::Vector3f& outward) {
  VoxelSample sample;
  sample.queries.reserve(cells.size());
  for (const Cell& cell : cells) sample.queries.push_back({cell, outward});
  sample.cells = std::move(cells);
  return sample;
}

}  // namespace

std::span<const MethodInfo> all_methods() { return kMethods; }

const MethodInfo& info_of(Method method) { return kMethods[static_cast<std::size_t>(method)]; }

bool is_available(Method method) {
#ifdef SULCUS_LAB_WITH_PCL
  static_cast<void>(method);
  return true;
#else
  return method != Method::kPca && method != Method::kMls;
#endif
}

Method method_named(std::string_view name) {
  std::string list;
  for (const MethodInfo& info : kMethods) {
    if (info.name == name) {
      if (is_available(info.method)) return info.method;
      throw InputError("", "--method", "'" + std::string(name) + "'",
                       "a method other than pca and mls: this program was built without PCL");
    }
    list.append(list.empty() ? "" : ", ").append(info.name);
  }
  throw InputError("", "--method", "'" + std::string(name) + "'", list);
}

std::vector<int> usual_neighbourhoods(Method method) {
  std::vector<int> all{1, 2, 3, 4, 5, 6, 8, 12};
  std::erase_if(all, [&](int ns) { return ns > info_of(method).largest_usual_ns; });
  return all;
}

double readouts(Method method, int neighbourhood) {
  const double edge = 2.0 * neighbourhood + 1.0;
  switch (info_of(method).window) {
    case Window::kMap:
      return edge * edge;
    case Window::kCube:
      return edge * edge * edge;
    case Window::kBallOfPoints:
      break;
  }
  return std::numbers::pi * std::pow(0.62 * edge, 2);
}

#ifdef SULCUS_LAB_WITH_PCL

struct NormalMethods::Cloud {
  std::vector<std::uint32_t> voxels;  // linear, rising: the cloud's order
  PclSurface surface;
};

NormalMethods::NormalMethods(const Workpiece& workpiece, bool with_cloud,
                             const std::optional<Eigen::Vector3d>& tool_direction)
    : workpiece_(workpiece), outward_(outward_of(tool_direction)) {
  if (!with_cloud) return;
  std::vector<Cell> cells;
  std::vector<std::uint32_t> voxels;
  const VoxelGrid& grid = workpiece.grid();
  for (std::uint32_t v = 0; v < grid.cell_count(); ++v) {
    const Cell cell = grid.cell_of_linear(v);
    if (!workpiece.is_surface(cell)) continue;
    voxels.push_back(v);
    cells.push_back(cell);
  }
  cloud_.reset(new Cloud{std::move(voxels), PclSurface(cells)});
}

VoxelSample NormalMethods::sample(std::vector<Cell> cells) const {
  VoxelSample sample = queries_of(std::move(cells), outward_);
  if (!cloud_) return sample;
  for (const Cell& cell : sample.cells) {
    const auto at = std::lower_bound(cloud_->voxels.begin(), cloud_->voxels.end(),
                                     workpiece_.grid().linear(cell));
    sample.points.push_back(static_cast<int>(at - cloud_->voxels.begin()));
  }
  return sample;
}

#else

struct NormalMethods::Cloud {};

NormalMethods::NormalMethods(const Workpiece& workpiece, bool,
                             const std::optional<Eigen::Vector3d>& tool_direction)
    : workpiece_(workpiece), outward_(outward_of(tool_direction)) {}

VoxelSample NormalMethods::sample(std::vector<Cell> cells) const {
  return queries_of(std::move(cells), outward_);
}

#endif

NormalMethods::~NormalMethods() = default;

void NormalMethods::estimate(Method method, int neighbourhood, const VoxelSample& sample,
                             std::vector<SurfaceEstimate>& estimates) const {
  const Workpiece& w = workpiece_;
  const int ns = neighbourhood;
  switch (method) {
    case Method::kLdm:
    case Method::kLdmFast: {
      // As a tick calls them: on a solid with fractions they read those.
      const NormalMethod of = method == Method::kLdm ? NormalMethod::kLdm : NormalMethod::kLdmFast;
      estimates.resize(sample.queries.size());
      return estimate_surfaces(w, sample.queries, {of, ns, kTrace}, estimates);
    }
    case Method::kLdmPaper:
      return for_each_cell(sample, estimates, [&](const Cell& c) {
        return estimate_ldm_paper(w, c, ns, kPaperTrace);
      });
    case Method::kWeightedSum:
      return for_each_cell(sample, estimates, [&](const Cell& c) {
        return estimate_weighted_sum(w, c, ns, WeightedSum::kAsStated);
      });
    case Method::kWeightedSumD2:
      return for_each_cell(sample, estimates, [&](const Cell& c) {
        return estimate_weighted_sum(w, c, ns, WeightedSum::kAsPlotted);
      });
    case Method::kExact:
      return for_each_cell(sample, estimates,
                           [&](const Cell& c) { return estimate_exact(w, c, ns); });
    case Method::kPca:
    case Method::kMls:
#ifdef SULCUS_LAB_WITH_PCL
      estimates = method == Method::kPca ? cloud_->surface.pca(sample.points, ns)
                                         : cloud_->surface.mls(sample.points, ns);
#endif
      return;
  }
}

}  // namespace sulcus::lab
