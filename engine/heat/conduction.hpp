#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/volume/grid.hpp"

namespace sulcus {

/// What conducts heat, and how much of it a volume takes up.
struct ThermalMaterial {
  double conductivity_W_per_mK = 0.0;
  double capacity_J_per_m3K = 0.0;  // 0: nothing is there
};

/// How a cell gives heat to what is outside of the solid: conductance (outside - cell), W.
struct HeatExchange {
  std::uint32_t place = 0;  // Conduction::place
  double conductance_W_per_K = 0.0;
  double outside_C = 0.0;
};

/// Heat conduction in a solid of cubic cells,
///
///   capacity dT/dt = div (conductivity grad T),
///
/// by finite volumes: one temperature to a cell, between two cells the conductivity at which both
/// conduct as in series (the harmonic mean). Nothing passes a face without a cell behind it. Steps
/// are explicit and at most edge^2 / (6 diffusivity), which is stable, and the step at which the
/// errors of time and of space cancel along an axis. What a cell exchanges with the outside is
/// taken implicitly, so that no conductance makes a step unstable.
///
/// A step runs on oneTBB: every cell is computed alone, from the temperatures before the step, so
/// that the result is the same for any number of threads. Used by one thread at a time.
class Conduction {
 public:
  /// `materials`: of cells[0] x cells[1] x cells[2] cells, x fastest; `cell_m`: their edge. All of
  /// it is at `start_C`. 56 bytes a cell.
  Conduction(const Eigen::Vector3i& cells, double cell_m,
             std::span<const ThermalMaterial> materials, double start_C);

  /// Where a cell is kept, or one beside the grid, in which nothing is.
  std::uint32_t place(const Cell& c) const {
    return static_cast<std::uint32_t>(c.x() + 1) +
           stride_y_ * static_cast<std::uint32_t>(c.y() + 1) +
           stride_z_ * static_cast<std::uint32_t>(c.z() + 1);
  }
  Cell cell(std::uint32_t place) const;
  const Eigen::Vector3i& cells() const { return cells_; }
  double cell_m() const { return cell_m_; }

  bool solid(std::uint32_t place) const { return capacity_J_per_K_[place] > 0.0; }
  double temperature_C(std::uint32_t place) const { return now_C_[place]; }
  /// Of a solid cell.
  double conductivity_W_per_mK(std::uint32_t place) const { return conductivity_[place]; }
  /// Heat of all cells above a temperature, J.
  double heat_above_J(double at_C) const;

  /// Takes a cell out of the solid, with the heat that is in it.
  void remove(std::uint32_t place);
  /// To a solid cell.
  void add_heat(std::uint32_t place, double heat_J) {
    now_C_[place] += heat_J / capacity_J_per_K_[place];
  }
  double longest_step_s() const { return longest_step_s_; }
  /// Goes on by a time, in equal steps. `exchanges`: of solid cells, each cell at most once; as
  /// they are, all the time.
  void advance(double seconds, std::span<const HeatExchange> exchanges);

  std::size_t memory_bytes() const;

 private:
  void step(double dt_s, std::span<const HeatExchange> exchanges);

  Eigen::Vector3i cells_;
  double cell_m_, longest_step_s_;
  std::uint32_t stride_y_, stride_z_;  // of places; there is a layer of empty cells all round
  std::vector<double> now_C_, next_C_, capacity_J_per_K_, conductivity_;
  std::vector<double> to_x_, to_y_, to_z_;  // W/K from a cell to the next along an axis
};

}  // namespace sulcus
