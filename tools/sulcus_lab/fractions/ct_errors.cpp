#include "tools/sulcus_lab/fractions/ct_errors.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <tbb/parallel_for.h>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/import/build_workpiece.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "engine/normals/normal_method.hpp"
#include "engine/volume/workpiece.hpp"
#include "tools/sulcus_lab/truth/grey_surface.hpp"

namespace sulcus::lab {

using Eigen::Vector3d;

namespace {

/// The edge of a file's voxels; any where it does not say, since all is measured in voxels.
double edge_of(const MedicalVolume& volume) {
  constexpr double kAny_m = 1e-4, kTolerance = 1e-5;
  if (!volume.spacing_known) return kAny_m;
  const double edge_m = volume.spacing_m.x();
  const bool square = (volume.direction.transpose() * volume.direction).isIdentity(kTolerance) &&
                      (volume.spacing_m.array() - edge_m).abs().maxCoeff() < kTolerance * edge_m;
  if (!square) {
    throw InputError(volume.file, "spacing", "voxels that are not cubes",
                     "cubes, which the workpiece's own can be");
  }
  return edge_m;
}

std::vector<Cell> surface_cells(const Workpiece& workpiece) {
  std::vector<Cell> cells;
  for_each_cell(Cell::Zero(), workpiece.grid().cells, [&](const Cell& c) {
    if (workpiece.is_surface(c)) cells.push_back(c);
  });
  return cells;
}

std::vector<SurfaceEstimate> estimates_at(const Workpiece& workpiece,
                                          const std::vector<Cell>& cells) {
  std::vector<VoxelQuery> queries;
  queries.reserve(cells.size());
  for (const Cell& cell : cells) queries.push_back({.voxel = cell});
  std::vector<SurfaceEstimate> estimates(cells.size());
  estimate_surfaces(workpiece, queries, NormalSettings(), estimates);
  return estimates;
}

double angle_deg(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

using Truth = std::vector<std::optional<GreySurfacePoint>>;

Truth truth_at(const GreySurface& surface, const std::vector<Vector3d>& centres) {
  Truth truth(centres.size());
  tbb::parallel_for(std::size_t{0}, centres.size(),
                    [&](std::size_t v) { truth[v] = surface.closest_point(centres[v]); });
  return truth;
}

double median_slope(const Truth& truth) {
  std::vector<double> slopes;
  for (const auto& at : truth) {
    if (at) slopes.push_back(at->slope);
  }
  if (slopes.empty()) return 0.0;
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::ranges::nth_element(slopes, middle);
  return *middle;
}

/// What one surface is judged by: its voxels, what ldm says at them, and both truths there.
struct CtSurface {
  Eigen::Matrix3d lattice_from_index;
  double steps_per_voxel = 1.0;
  std::vector<Cell> cells;
  std::vector<SurfaceEstimate> estimates;
  std::array<Truth, 2> truths;
};

CtErrors errors_of(const CtSurface& found, std::size_t t, const GreySurface& surface) {
  constexpr double kFlat = 0.1;
  const double least_slope = kFlat * median_slope(found.truths[t]), steps = found.steps_per_voxel;
  CtErrors errors;
  for (std::size_t v = 0; v < found.cells.size(); ++v) {
    const auto &truth = found.truths[t][v], &smoothed = found.truths[1][v];
    const SurfaceEstimate& estimate = found.estimates[v];
    if (!truth || !smoothed || truth->slope < least_slope) {
      ++errors.flat;
    } else if (surface.is_thin(*truth, kThin * steps)) {
      ++errors.thin;
    } else if (!estimate.defined) {
      ++errors.undefined;
    } else {
      const Vector3d normal = found.lattice_from_index * estimate.normal.cast<double>();
      errors.voxels.push_back({found.cells[v], smoothed->curvature * steps,
                               estimate.offset - truth->offset / steps,
                               angle_deg(normal, truth->normal)});
    }
  }
  return errors;
}

CtSurface surface_of(const CtFile& file, SurfaceKind kind, int finer,
                     const std::array<GreySurface, 2>& truths) {
  const CtModel ct = load_ct(file, kind, finer);
  const Workpiece workpiece{VoxelModel(ct.model)};
  CtSurface found;
  found.lattice_from_index = ct.lattice_from_index.linear();
  found.steps_per_voxel = ct.steps_per_voxel();
  found.cells = surface_cells(workpiece);
  found.estimates = estimates_at(workpiece, found.cells);
  std::vector<Vector3d> centres;
  centres.reserve(found.cells.size());
  for (const Cell& cell : found.cells) {
    centres.emplace_back(ct.lattice_from_index * cell.cast<double>());
  }
  for (std::size_t t = 0; t < 2; ++t) found.truths[t] = truth_at(truths[t], centres);
  return found;
}

}  // namespace

CtModel load_ct(const CtFile& file, SurfaceKind surface, int finer) {
  const MedicalVolume volume = read_medical_volume(file.path);
  const double edge_m = edge_of(volume);
  Scene scene;
  scene.tissues.resize(1);
  WorkpieceSettings& w = scene.workpiece;
  w.file = file.path;
  w.solid_above = file.solid_above;
  w.surface = surface;
  w.voxel_m = edge_m / finer;
  w.spacing_m = Vector3d::Constant(edge_m);
  // Room for all of the file however its solid's middle is rounded to whole voxels.
  w.cells = (finer * volume.sizes / kLeafEdge + Cell::Constant(2)) * kLeafEdge;
  ImportNotes notes;
  VoxelModel model = build_workpiece(scene, nullptr, &notes);
  Eigen::Affine3d world_from_index = Eigen::Affine3d::Identity();
  world_from_index.linear() *= w.voxel_m;
  world_from_index.translation() = model.grid.world_from_index(Vector3d::Zero());
  const InputGeometry& input = *notes.input;
  return {std::move(model),
          input.file_from_lattice().inverse() * input.file_from_world * world_from_index};
}

CtErrorsOfAll ct_errors(const CtFile& file, int finer,
                        const std::function<void(const std::string&)>& progress) {
  const MedicalVolume volume = read_medical_volume(file.path);
  const GreySpline through(volume, GreyTruth::kThrough), smoothed(volume, GreyTruth::kSmoothed);
  const std::array<GreySurface, 2> truths{GreySurface(through, file.solid_above),
                                          GreySurface(smoothed, file.solid_above)};
  CtErrorsOfAll errors;
  for (std::size_t s = 0; s < 2; ++s) {
    progress("ct: " + std::string(kSurfaceNames[s]));
    const CtSurface found = surface_of(file, kBothSurfaces[s], finer, truths);
    for (std::size_t t = 0; t < 2; ++t) errors[t][s] = errors_of(found, t, truths[t]);
  }
  return errors;
}

std::vector<CtBin> ct_bins(const CtErrorsOfAll& errors) {
  struct Axis {
    std::string_view quantity;
    double from, step;
    int count;
    double CtVoxel::*of;
  };
  constexpr Axis kAxes[] = {
      {"offset_error_voxels", -0.5, 0.02, 50, &CtVoxel::offset_error},
      {"normal_error_deg", 0.0, 0.5, 48, &CtVoxel::normal_error_deg},
  };
  std::vector<CtBin> bins;
  for (const Axis& axis : kAxes) {
    for (std::size_t t = 0; t < 2; ++t) {
      const std::size_t first = bins.size();
      for (int b = 0; b < axis.count; ++b) {
        bins.push_back({axis.quantity, kCtTruthNames[t], axis.from + b * axis.step,
                        axis.from + (b + 1) * axis.step});
      }
      for (std::size_t s = 0; s < 2; ++s) {
        const std::vector<CtVoxel>& voxels = errors[t][s].voxels;
        for (const CtVoxel& voxel : voxels) {
          const double bin = std::floor((voxel.*axis.of - axis.from) / axis.step);
          if (!(bin >= 0.0 && bin < axis.count)) continue;
          bins[first + static_cast<std::size_t>(bin)].share_pct[s] +=
              100.0 / static_cast<double>(voxels.size());
        }
      }
    }
  }
  return bins;
}

}  // namespace sulcus::lab
