#include "engine/heat/conduction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/parallel.hpp"

namespace sulcus {

namespace {

double in_series(double a, double b) { return a > 0.0 && b > 0.0 ? 2.0 * a * b / (a + b) : 0.0; }

}  // namespace

Conduction::Conduction(const Eigen::Vector3i& cells, double cell_m,
                       std::span<const ThermalMaterial> materials, double start_C)
    : cells_(cells),
      cell_m_(cell_m),
      stride_y_(static_cast<std::uint32_t>(cells.x() + 2)),
      stride_z_(stride_y_ * static_cast<std::uint32_t>(cells.y() + 2)) {
  const std::size_t places = std::size_t{stride_z_} * static_cast<std::size_t>(cells.z() + 2);
  now_C_.assign(places, start_C);
  next_C_ = now_C_;
  for (auto* values : {&capacity_J_per_K_, &conductivity_, &to_x_, &to_y_, &to_z_}) {
    values->assign(places, 0.0);
  }
  const double cell_m3 = cell_m * cell_m * cell_m;
  std::size_t next = 0;
  for_each_cell(Cell::Zero(), cells, [&](const Cell& c) {
    const ThermalMaterial& material = materials[next++];
    capacity_J_per_K_[place(c)] = material.capacity_J_per_m3K * cell_m3;
    if (material.capacity_J_per_m3K > 0.0) {
      conductivity_[place(c)] = material.conductivity_W_per_mK;
    }
  });
  longest_step_s_ = std::numeric_limits<double>::infinity();
  for_each_cell(Cell::Zero(), cells, [&](const Cell& c) {
    const std::uint32_t at = place(c);
    if (!solid(at)) return;
    const auto to = [&](std::uint32_t other) {
      return in_series(conductivity_[at], conductivity_[other]) * cell_m;
    };
    to_x_[at] = to(at + 1);
    to_y_[at] = to(at + stride_y_);
    to_z_[at] = to(at + stride_z_);
    const double most = std::max(
        {to_x_[at], to_y_[at], to_z_[at], to(at - 1), to(at - stride_y_), to(at - stride_z_)});
    if (most > 0.0) {
      longest_step_s_ = std::min(longest_step_s_, capacity_J_per_K_[at] / (6.0 * most));
    }
  });
}

Cell Conduction::cell(std::uint32_t place) const {
  return {static_cast<int>(place % stride_y_) - 1,
          static_cast<int>(place % stride_z_ / stride_y_) - 1,
          static_cast<int>(place / stride_z_) - 1};
}

double Conduction::heat_above_J(double at_C) const {
  double heat_J = 0.0;
  for (std::size_t i = 0; i < now_C_.size(); ++i)
    heat_J += capacity_J_per_K_[i] * (now_C_[i] - at_C);
  return heat_J;
}

void Conduction::remove(std::uint32_t place) {
  capacity_J_per_K_[place] = conductivity_[place] = 0.0;
  to_x_[place] = to_y_[place] = to_z_[place] = 0.0;
  to_x_[place - 1] = to_y_[place - stride_y_] = to_z_[place - stride_z_] = 0.0;
}

void Conduction::advance(double seconds, std::span<const HeatExchange> exchanges) {
  const double steps = std::max(1.0, std::ceil(seconds / longest_step_s_));
  for (double done = 0.0; done < steps; ++done) step(seconds / steps, exchanges);
}

void Conduction::step(double dt_s, std::span<const HeatExchange> exchanges) {
  parallel_for(0, cells_.z(), [&](int z) {
    for (int y = 0; y < cells_.y(); ++y) {
      const std::size_t first = place(Cell(0, y, z));
      const double* const t = now_C_.data() + first;
      const double* const capacity = capacity_J_per_K_.data() + first;
      const double *const x = to_x_.data() + first, *const y_to = to_y_.data() + first,
                          *const z_to = to_z_.data() + first;
      double* const next = next_C_.data() + first;
      const auto dy = static_cast<std::ptrdiff_t>(stride_y_);
      const auto dz = static_cast<std::ptrdiff_t>(stride_z_);
      for (std::ptrdiff_t i = 0; i < cells_.x(); ++i) {
        const double in_W = x[i] * (t[i + 1] - t[i]) + x[i - 1] * (t[i - 1] - t[i]) +
                            y_to[i] * (t[i + dy] - t[i]) + y_to[i - dy] * (t[i - dy] - t[i]) +
                            z_to[i] * (t[i + dz] - t[i]) + z_to[i - dz] * (t[i - dz] - t[i]);
        // Of nothing, nothing goes in: what it is divided by does not matter.
        next[i] = t[i] + dt_s * in_W / (capacity[i] > 0.0 ? capacity[i] : 1.0);
      }
    }
  });
  std::swap(now_C_, next_C_);
  for (const HeatExchange& exchange : exchanges) {
    double& cell_C = now_C_[exchange.place];
    const double part = dt_s * exchange.conductance_W_per_K / capacity_J_per_K_[exchange.place];
    cell_C = (cell_C + part * exchange.outside_C) / (1.0 + part);
  }
}

std::size_t Conduction::memory_bytes() const {
  return (now_C_.capacity() + next_C_.capacity() + capacity_J_per_K_.capacity() +
          conductivity_.capacity() + to_x_.capacity() + to_y_.capacity() + to_z_.capacity()) *
         sizeof(double);
}

}  // namespace sulcus
