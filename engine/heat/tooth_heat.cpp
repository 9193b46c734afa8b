#include "engine/heat/tooth_heat.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "engine/heat/thermal_tissues.hpp"

namespace sulcus {

namespace {

// Conductances of a surface, W/(m2 K).
constexpr double kAir = 10.0;   // still air in a room [Lin 2014]
constexpr double kGum = 500.0;  // a bath of still water, as such teeth stand in [est.]
// A film that runs down a crown, conductivity over its thickness by Nusselt, 15 to 30 ml/min over
// 30 mm: 6,800 to 8,600 if it is whole and even [est.].
constexpr double kFilm = 5000.0;
// How far from the tip the water wets: the stream, and the cone of drops [est.].
constexpr std::array<double, 2> kWetted_m{4e-3, 6e-3};
constexpr double kWaterHeat_J_per_m3K = 4.18e6;

constexpr std::uint32_t kNone = ~std::uint32_t{0};

const std::array<Cell, 6> kFaces{Cell(1, 0, 0),  Cell(-1, 0, 0), Cell(0, 1, 0),
                                 Cell(0, -1, 0), Cell(0, 0, 1),  Cell(0, 0, -1)};

/// Through a layer of half a cell and then its face.
double through_face(double area_m2, double surface_W_per_m2K, double half_cell_m,
                    double conductivity_W_per_mK) {
  return area_m2 / (1.0 / surface_W_per_m2K + half_cell_m / conductivity_W_per_mK);
}

/// What the voxels of a model make of cells of `edge` voxels, over the box that they lie in.
struct Cells {
  Cell first = Cell::Zero();
  Eigen::Vector3i size = Eigen::Vector3i::Zero();
  // x fastest.
  std::vector<std::uint32_t> voxels, pulp_voxels;
  std::vector<ThermalMaterial> sums;

  std::size_t index(const Cell& c) const {
    const Cell d = c - first;
    return static_cast<std::size_t>(d.x()) +
           static_cast<std::size_t>(size.x()) *
               (static_cast<std::size_t>(d.y()) +
                static_cast<std::size_t>(size.y()) * static_cast<std::size_t>(d.z()));
  }
};

Cells cells_of(const VoxelModel& model, int edge, std::span<const ThermalMaterial> materials,
               std::optional<std::size_t> pulp) {
  Cells cells;
  Cell low = model.grid.cells, high = Cell::Zero();
  for (std::uint32_t leaf = 0; leaf < model.leaves.size(); ++leaf) {
    if (!any(model.leaves[leaf])) continue;
    const Cell origin = model.grid.leaf_origin(leaf);
    low = low.cwiseMin(origin);
    high = high.cwiseMax(origin + Cell::Constant(kLeafEdge));
  }
  if ((low.array() >= high.array()).any()) return cells;
  cells.first = low / edge;
  cells.size = (high - Cell::Ones()) / edge - cells.first + Cell::Ones();
  const std::size_t count = cells.index(cells.first + cells.size - Cell::Ones()) + 1;
  cells.voxels.assign(count, 0);
  cells.pulp_voxels.assign(count, 0);
  cells.sums.assign(count, {});
  for (std::uint32_t leaf = 0; leaf < model.leaves.size(); ++leaf) {
    const Cell origin = model.grid.leaf_origin(leaf);
    for_each_voxel(model.leaves[leaf], [&](int place) {
      const Cell voxel = origin + cell_in_leaf(place);
      const std::size_t at = cells.index(voxel / edge), tissue = model.tissue(voxel);
      ++cells.voxels[at];
      if (tissue == pulp) ++cells.pulp_voxels[at];
      cells.sums[at].conductivity_W_per_mK += materials[tissue].conductivity_W_per_mK;
      cells.sums[at].capacity_J_per_m3K += materials[tissue].capacity_J_per_m3K;
    });
  }
  return cells;
}

std::optional<std::size_t> label_of_pulp(std::span<const TissueSettings> tissues) {
  const auto found = std::ranges::find(tissues, "pulp", &TissueSettings::name);
  if (found == tissues.end()) return {};
  return static_cast<std::size_t>(found - tissues.begin());
}

}  // namespace

double PulpHeat::end_change_K() const {
  if (curve.empty()) return 0.0;
  const Point& end = curve.back();
  return end.warmest_K >= -end.coldest_K ? end.warmest_K : end.coldest_K;
}

ToothHeat::ToothHeat(const Scene& scene, const VoxelModel& start)
    : settings_(*scene.heat),
      grid_(start.grid),
      tissues_(start.tissues),
      edge_(settings_.cell_voxels(start.grid.voxel_m)) {
  std::vector<ThermalMaterial> materials;
  for (const TissueSettings& tissue : scene.tissues) {
    materials.push_back(thermal_material(tissue.name));
    voxel_energy_J_.push_back(tissue.specific_energy_J_per_m3 * grid_.voxel_volume_m3());
  }
  for (const BodySettings& body : scene.bodies) {
    const double voxel_m = body.solid.voxel_m;
    other_energy_J_.push_back(scene.tissues[body.tissue.value_or(0)].specific_energy_J_per_m3 *
                              voxel_m * voxel_m * voxel_m);
  }
  Cells cells = cells_of(start, edge_, materials, label_of_pulp(scene.tissues));
  first_ = cells.first;
  const std::uint64_t whole = static_cast<std::uint64_t>(edge_) *
                              static_cast<std::uint64_t>(edge_) * static_cast<std::uint64_t>(edge_);
  for (std::size_t i = 0; i < cells.sums.size(); ++i) {
    const bool is_solid = std::uint64_t{2} * cells.voxels[i] >= whole;
    ThermalMaterial& mean = cells.sums[i];
    mean.conductivity_W_per_mK /= std::max(1.0, static_cast<double>(cells.voxels[i]));
    mean.capacity_J_per_m3K /= std::max(1.0, static_cast<double>(cells.voxels[i]));
    if (!is_solid) mean = {};
  }
  solid_.emplace(cells.size, edge_ * grid_.voxel_m, cells.sums, settings_.start_C);
  solid_voxels_.assign(solid_->place(cells.size) + std::size_t{1}, 0);
  surface_at_.assign(solid_voxels_.size(), kNone);
  std::size_t next = 0;
  for_each_cell(Cell::Zero(), cells.size,
                [&](const Cell& c) { solid_voxels_[solid_->place(c)] = cells.voxels[next++]; });
  const auto is_pulp = [&](const Cell& c) {
    const bool inside = (c.array() >= 0).all() && (c.array() < cells.size.array()).all();
    if (!inside || !solid_->solid(solid_->place(c))) return false;
    const std::size_t at = cells.index(cells.first + c);
    return std::uint64_t{2} * cells.pulp_voxels[at] > cells.voxels[at];
  };
  for_each_cell(Cell::Zero(), cells.size, [&](const Cell& c) {
    const std::uint32_t place = solid_->place(c);
    if (!solid_->solid(place)) return;
    look_at_surface(place);
    if (is_pulp(c) && std::ranges::any_of(kFaces, [&](const Cell& step) {
          return solid_->solid(solid_->place(c + step)) && !is_pulp(c + step);
        })) {
      wall_.push_back(place);
    }
  });
  result_ = {.cell_m = solid_->cell_m(), .pulp = {}};
  if (!wall_.empty()) result_.pulp.emplace();
}

Eigen::Vector3d ToothHeat::centre_world(std::uint32_t place) const {
  const Eigen::Vector3d c = (first_ + solid_->cell(place)).cast<double>();
  return grid_.world_from_index((c.array() + 0.5) * edge_ - 0.5);
}

std::uint32_t ToothHeat::place_of(std::uint32_t voxel) const {
  return solid_->place(grid_.cell_of_linear(voxel) / edge_ - first_);
}

/// Finds out anew how a solid cell lies at the surface.
void ToothHeat::look_at_surface(std::uint32_t place) {
  const double cell_m = solid_->cell_m();
  const Cell c = solid_->cell(place);
  const Cell last = (grid_.cells - Cell::Ones()) / edge_;
  std::array<double, 3> bare{};  // faces on nothing, by axis
  int cut = 0;
  for (std::size_t side = 0; side < kFaces.size(); ++side) {
    const Cell beside = c + kFaces[side];
    if (solid_->solid(solid_->place(beside))) continue;
    const Cell of_grid = first_ + beside;
    const bool outside = (of_grid.array() < 0).any() || (of_grid.array() > last.array()).any();
    outside ? ++cut : ++bare[side / 2];
  }
  const double faces = std::sqrt(bare[0] * bare[0] + bare[1] * bare[1] + bare[2] * bare[2]);
  if (cut == 0 && faces == 0.0) return;
  if (surface_at_[place] == kNone) {
    surface_at_[place] = static_cast<std::uint32_t>(surface_.size());
    surface_.emplace_back();
  }
  const Eigen::Vector3d centre = centre_world(place);
  // The steps of a slanting face are longer than it is: their sum by direction is as long.
  surface_[surface_at_[place]] = {
      place, faces * cell_m * cell_m, cut * cell_m * cell_m,
      settings_.gum_m && centre.z() < *settings_.gum_m ? Side::kGum : Side::kMouth, centre};
}

void ToothHeat::remove_cell(std::uint32_t place) {
  solid_->remove(place);
  if (const std::uint32_t at = std::exchange(surface_at_[place], kNone); at != kNone) {
    surface_[at] = surface_.back();
    surface_.pop_back();
    if (at < surface_.size()) surface_at_[surface_[at].place] = at;
  }
  const Cell c = solid_->cell(place);
  for (const Cell& step : kFaces) {
    const std::uint32_t beside = solid_->place(c + step);
    if (solid_->solid(beside)) look_at_surface(beside);
  }
}

void ToothHeat::remove_voxels(std::span<const HeatLog::GoneVoxel> gone) {
  const std::uint64_t whole = static_cast<std::uint64_t>(edge_) *
                              static_cast<std::uint64_t>(edge_) * static_cast<std::uint64_t>(edge_);
  for (const HeatLog::GoneVoxel& voxel : gone) {
    if (voxel.body != 0) continue;
    const std::uint32_t place = place_of(voxel.voxel);
    if (solid_voxels_[place] > 0) --solid_voxels_[place];
    if (solid_->solid(place) && std::uint64_t{2} * solid_voxels_[place] < whole) remove_cell(place);
  }
}

/// To a cell, or where it has gone to all those beside it in equal parts: over a face, else over an
/// edge or a corner. False where there are none.
bool ToothHeat::give(std::uint32_t place, double heat_J) {
  if (solid_->solid(place)) {
    solid_->add_heat(place, heat_J);
    return true;
  }
  const Cell c = solid_->cell(place);
  for (const int most_steps : {1, 3}) {
    std::array<std::uint32_t, 26> beside{};
    std::size_t count = 0;
    for_each_cell(Cell::Constant(-1), Cell::Constant(2), [&](const Cell& step) {
      const int steps = step.cwiseAbs().sum();
      if (steps == 0 || steps > most_steps) return;
      const Cell there = c + step;
      const bool inside =
          (there.array() >= 0).all() && (there.array() < solid_->cells().array()).all();
      if (inside && solid_->solid(solid_->place(there))) {
        beside[count++] = solid_->place(there);
      }
    });
    for (std::size_t i = 0; i < count; ++i) {
      solid_->add_heat(beside[i], heat_J / static_cast<double>(count));
    }
    if (count > 0) return true;
  }
  return false;
}

/// Puts the heat that waits where the voxels were cut.
void ToothHeat::heat(std::span<const HeatLog::GoneVoxel> gone) {
  const auto energy_J = [&](const HeatLog::GoneVoxel& voxel) {
    if (voxel.cause != EditCause::kCut) return 0.0;
    if (voxel.body != 0) return other_energy_J_[voxel.body - std::size_t{1}];
    const Cell c = grid_.cell_of_linear(voxel.voxel);
    const std::uint8_t tissue = tissues_ ? tissues_->label(grid_.leaf_of(c), c) : std::uint8_t{0};
    return voxel_energy_J_[tissue];
  };
  double all_J = 0.0;
  for (const HeatLog::GoneVoxel& voxel : gone) all_J += energy_J(voxel);
  if (all_J <= 0.0) return;
  const double waiting_J = std::exchange(waiting_J_, 0.0);
  for (const HeatLog::GoneVoxel& voxel : gone) {
    const double heat_J = waiting_J * energy_J(voxel) / all_J;
    if (heat_J <= 0.0 || voxel.body != 0) continue;  // another body's heat is not followed
    if (give(place_of(voxel.voxel), heat_J)) {
      result_.given_J += heat_J;
    } else {
      waiting_J_ += heat_J;
    }
  }
}

void ToothHeat::set_exchanges() {
  exchanges_.clear();
  const double half_m = 0.5 * solid_->cell_m();
  const bool wet = now_.turns && settings_.water_m3_per_s > 0.0;
  const double reach_m = kWetted_m[static_cast<std::size_t>(settings_.spray)];
  const auto is_wet = [&](const SurfaceCell& cell) {
    return wet && cell.side == Side::kMouth &&
           (cell.centre_world - now_.tip_world).squaredNorm() <= reach_m * reach_m;
  };
  const auto through = [&](const SurfaceCell& cell, double surface_W_per_m2K) {
    return through_face(cell.area_m2, surface_W_per_m2K, half_m,
                        solid_->conductivity_W_per_mK(cell.place));
  };
  // The film: what comes with the water and what the cells give it leave together.
  double in_W_per_K = kWaterHeat_J_per_m3K * settings_.water_m3_per_s;
  double in_W = in_W_per_K * settings_.water_C;
  for (const SurfaceCell& cell : surface_) {
    if (!is_wet(cell)) continue;
    const double conductance = through(cell, kFilm);
    in_W_per_K += conductance;
    in_W += conductance * solid_->temperature_C(cell.place);
  }
  const double film_C = in_W_per_K > 0.0 ? in_W / in_W_per_K : settings_.water_C;
  for (const SurfaceCell& cell : surface_) {
    double conductance = 0.0, outside_C = settings_.start_C;
    if (is_wet(cell)) {
      conductance = through(cell, kFilm);
      outside_C = film_C;
    } else if (cell.side == Side::kGum) {
      conductance = through(cell, kGum);
    } else {
      conductance = through(cell, kAir);
      outside_C = settings_.air_C;
    }
    // Where the grid cuts it the tooth goes on, as warm as at the start.
    const double cut = cell.cut_area_m2 * solid_->conductivity_W_per_mK(cell.place) / half_m;
    if (conductance + cut <= 0.0) continue;
    exchanges_.push_back(
        {cell.place, conductance + cut,
         (conductance * outside_C + cut * settings_.start_C) / (conductance + cut)});
  }
}

void ToothHeat::watch_pulp(double time_s, double seconds) {
  PulpHeat::Point point{time_s, 0.0, 0.0};
  bool any_left = false;
  for (const std::uint32_t place : wall_) {
    if (!solid_->solid(place)) continue;
    const double rise_K = solid_->temperature_C(place) - settings_.start_C;
    point.warmest_K = any_left ? std::max(point.warmest_K, rise_K) : rise_K;
    point.coldest_K = any_left ? std::min(point.coldest_K, rise_K) : rise_K;
    any_left = true;
    if (rise_K > result_.pulp->greatest_rise_K) {
      result_.pulp->greatest_rise_K = rise_K;
      result_.pulp->greatest_rise_s = time_s;
      result_.pulp->greatest_rise_world = centre_world(place);
    }
  }
  if (!any_left) return;
  if (point.warmest_K > kPulpLimit_K) result_.pulp->over_limit_s += seconds;
  result_.pulp->curve.push_back(point);
}

void ToothHeat::advance(const HeatLog& log, double until_s) {
  const auto all_gone = log.gone();
  constexpr double kRounding_s = 1e-9;
  for (;
       next_stretch_ < log.stretches().size() && log.end_s(next_stretch_) <= until_s + kRounding_s;
       ++next_stretch_) {
    const HeatLog::Stretch& stretch = log.stretches()[next_stretch_];
    if (stretch.has_rows) now_ = stretch;
    const std::size_t first = next_gone_;
    while (next_gone_ < all_gone.size() && all_gone[next_gone_].stretch <= next_stretch_) {
      ++next_gone_;
    }
    const auto gone = all_gone.subspan(first, next_gone_ - first);
    remove_voxels(gone);
    waiting_J_ += settings_.tooth_share * stretch.work_J;
    heat(gone);
    set_exchanges();
    solid_->advance(log.stretch_s(), exchanges_);
    if (result_.pulp) watch_pulp(log.end_s(next_stretch_), log.stretch_s());
  }
}

std::optional<double> ToothHeat::temperature_C(const Eigen::Vector3d& p_index) const {
  const Eigen::Vector3d p = (p_index.array() + 0.5) / edge_ - 0.5 - first_.cast<double>().array();
  const Cell low = p.array().floor().cast<int>();
  double sum = 0.0, weights = 0.0;
  for_each_cell(low, low + Cell::Constant(2), [&](const Cell& c) {
    const bool inside = (c.array() >= 0).all() && (c.array() < solid_->cells().array()).all();
    if (!inside || !solid_->solid(solid_->place(c))) return;
    const double weight = (1.0 - (p - c.cast<double>()).array().abs()).max(0.0).prod() + 1e-6;
    sum += weight * solid_->temperature_C(solid_->place(c));
    weights += weight;
  });
  if (weights == 0.0) return {};
  return sum / weights;
}

std::size_t ToothHeat::memory_bytes() const {
  return solid_->memory_bytes() + solid_voxels_.capacity() * sizeof(std::uint32_t) +
         surface_at_.capacity() * sizeof(std::uint32_t) +
         surface_.capacity() * sizeof(SurfaceCell) +
         (result_.pulp ? result_.pulp->curve.capacity() * sizeof(PulpHeat::Point) : 0);
}

}  // namespace sulcus
