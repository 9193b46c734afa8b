#include "engine/heat/conduction.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

// Against closed solutions [Carslaw and Jaeger 1959; Rosenthal 1946], computed here from the
// materials alone.

namespace sulcus::conduction_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr ThermalMaterial kEnamel{0.81, 0.81 / 4.08e-7}, kDentine{0.48, 0.48 / 2.01e-7};

double diffusivity(const ThermalMaterial& m) {
  return m.conductivity_W_per_mK / m.capacity_J_per_m3K;
}

std::vector<ThermalMaterial> block(const Eigen::Vector3i& cells, const ThermalMaterial& material) {
  return std::vector<ThermalMaterial>(static_cast<std::size_t>(cells.prod()), material);
}

/// A point source of 1 W that moves along x on the face of a half space, seen from it: rise after
/// `time_s` at (ahead, beside, below), m, by the heat of every moment of its way
/// [Carslaw and Jaeger, 10.7].
double moving_source_K(const ThermalMaterial& m, double speed_m_per_s, double time_s, double ahead,
                       double beside, double below) {
  const double a = diffusivity(m);
  const double r2_side = beside * beside + below * below;
  // Over the root of the time since, in which the integrand is smooth.
  constexpr int kSteps = 500;
  const double end = std::sqrt(time_s);
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double root = (i + 0.5) / kSteps * end, since_s = root * root;
    const double x = ahead + speed_m_per_s * since_s;
    sum += std::exp(-(x * x + r2_side) / (4.0 * a * since_s)) / (since_s * root) * 2.0 * root;
  }
  const double scale = 2.0 / (m.capacity_J_per_m3K * std::pow(4.0 * kPi * a, 1.5));
  return scale * sum * end / kSteps;
}

/// The same after a long time [Rosenthal 1946].
double rosenthal_K(const ThermalMaterial& m, double speed_m_per_s, double ahead, double beside,
                   double below) {
  const double r = std::sqrt(ahead * ahead + beside * beside + below * below);
  return std::exp(-speed_m_per_s * (r + ahead) / (2.0 * diffusivity(m))) /
         (2.0 * kPi * m.conductivity_W_per_mK * r);
}

TEST(Conduction, TheTwoFormsOfTheMovingSourceAgree) {
  const double t = moving_source_K(kEnamel, 2e-3, 60.0, -0.8e-3, 0.3e-3, 0.4e-3);
  EXPECT_NEAR(t / rosenthal_K(kEnamel, 2e-3, -0.8e-3, 0.3e-3, 0.4e-3), 1.0, 1e-4);
}

/// The same of a source at a depth, by its image above the face.
double buried_source_K(const ThermalMaterial& m, double speed_m_per_s, double time_s,
                       const Eigen::Vector3d& p, double depth) {
  return 0.5 * (moving_source_K(m, speed_m_per_s, time_s, p.x(), p.y(), p.z() - depth) +
                moving_source_K(m, speed_m_per_s, time_s, p.x(), p.y(), p.z() + depth));
}

/// The largest error of a source that has moved along the middle of a face for 3 s, in dentine for
/// as much longer as it is slower, over the cells with 4 to 9 others between them and the source,
/// in parts of the warmest of them. Heat is put into cells, whose middle is half a cell deep.
double error_of_moving_source(const ThermalMaterial& material, double speed_m_per_s) {
  constexpr double kCell_m = 0.2e-3;
  const double time_s = 1.2e-6 / diffusivity(material);
  const Eigen::Vector3i cells(75, 51, 26);  // the heat stays well within
  Conduction solid(cells, kCell_m, block(cells, material), 0.0);
  // At first, and where it is at a time; counted in cells from the first's middle.
  const double first = 30.0, speed_cells = speed_m_per_s / kCell_m;
  const int steps = static_cast<int>(std::ceil(time_s / (0.6 * solid.longest_step_s())));
  const double step_s = time_s / steps;
  for (int i = 0; i < steps; ++i) {
    const double at = first + speed_cells * (i + 0.5) * step_s;
    const int cell = static_cast<int>(std::floor(at));
    const double part = at - cell;
    solid.add_heat(solid.place({cell, 25, 0}), (1.0 - part) * step_s);
    solid.add_heat(solid.place({cell + 1, 25, 0}), part * step_s);
    solid.advance(step_s, {});
  }
  const double end = first + speed_cells * time_s;
  double warmest = 0.0, error = 0.0;
  int seen = 0;
  for_each_cell(Cell::Zero(), cells, [&](const Cell& c) {
    const Eigen::Vector3d p(c.x() - end, c.y() - 25.0, c.z() + 0.5);
    const double apart = (p - Eigen::Vector3d(0, 0, 0.5)).norm();
    // A quarter of what lies round it: the rest is alike.
    if (apart < 5.0 || apart > 10.0 || c.y() < 25) return;
    const double expected =
        buried_source_K(material, speed_m_per_s, time_s, kCell_m * p, 0.5 * kCell_m);
    warmest = std::max(warmest, expected);
    error = std::max(error, std::abs(solid.temperature_C(solid.place(c)) - expected));
    ++seen;
  });
  EXPECT_GT(seen, 800);
  return error / warmest;
}

// As long as heat is faster than the source: edge * speed / diffusivity is a quarter here. (At a
// half, in shorter steps, it is up to 2.8 %.)
TEST(Conduction, AMovingSourceOnAHalfSpaceIsWithinTwoPercentFourCellsAway) {
  EXPECT_LT(error_of_moving_source(kEnamel, 0.5e-3), 0.02);
  EXPECT_LT(error_of_moving_source(kDentine, 0.25e-3), 0.02);
}

/// Rise in a slab whose one face was brought from 0 to 1 and held there, nothing passing the other;
/// `depth`: from the held face, in parts of the thickness [Carslaw and Jaeger, 3.4].
double slab_rise(double depth, double fourier) {
  double rise = 1.0;
  for (int n = 0; n < 400; ++n) {
    const double b = (n + 0.5) * kPi;
    rise -= 2.0 / b * std::sin(b * depth) * std::exp(-b * b * fourier);
  }
  return rise;
}

TEST(Conduction, ASlabWithOneFaceHeldIsWithinTwoPercentFourCellsAway) {
  for (const ThermalMaterial& material : {kEnamel, kDentine}) {
    for (const double cell_m : {0.15e-3, 0.2e-3, 0.3e-3}) {
      const int depth = 24;
      const Eigen::Vector3i cells(1, 1, depth);
      Conduction slab(cells, cell_m, block(cells, material), 0.0);
      // From the held face to the middle of the first cell.
      const HeatExchange held{slab.place({0, 0, 0}), 2.0 * material.conductivity_W_per_mK * cell_m,
                              1.0};
      const double thick_m = depth * cell_m;
      double time_s = 0.0;
      for (const double until_s : {1.0, 3.0, 10.0, 30.0}) {
        slab.advance(until_s - time_s, std::span(&held, 1));
        time_s = until_s;
        for (int z = 4; z < depth; ++z) {
          const double expected =
              slab_rise((z + 0.5) / depth, diffusivity(material) * time_s / (thick_m * thick_m));
          const double found = slab.temperature_C(slab.place({0, 0, z}));
          EXPECT_NEAR(found, expected, 0.02) << cell_m << " m, " << time_s << " s, cell " << z;
        }
      }
    }
  }
}

// Through two layers in series the same heat flows, and the temperature between them follows.
TEST(Conduction, TwoLayersConductInSeries) {
  const Eigen::Vector3i cells(20, 1, 1);
  std::vector<ThermalMaterial> materials(20, kEnamel);
  std::fill(materials.begin() + 8, materials.end(), kDentine);
  const double cell_m = 0.2e-3;
  Conduction bar(cells, cell_m, materials, 20.0);
  const std::vector<HeatExchange> ends{
      {bar.place({0, 0, 0}), 2.0 * kEnamel.conductivity_W_per_mK * cell_m, 50.0},
      {bar.place({19, 0, 0}), 2.0 * kDentine.conductivity_W_per_mK * cell_m, 20.0}};
  bar.advance(400.0, ends);
  const double enamel = 8.0 / kEnamel.conductivity_W_per_mK;
  const double dentine = 12.0 / kDentine.conductivity_W_per_mK;
  const double per_cell = 30.0 / (enamel + dentine);
  EXPECT_NEAR(bar.temperature_C(bar.place({7, 0, 0})),
              50.0 - 7.5 / kEnamel.conductivity_W_per_mK * per_cell, 1e-6);
  EXPECT_NEAR(bar.temperature_C(bar.place({8, 0, 0})),
              20.0 + 11.5 / kDentine.conductivity_W_per_mK * per_cell, 1e-6);
}

/// A lump of both materials with holes, in which heat is put and from which cells are taken.
std::vector<double> stirred(Conduction& lump) {
  std::mt19937 random(7);
  const Eigen::Vector3i& n = lump.cells();
  const auto any_place = [&] {
    return lump.place({static_cast<int>(random() % static_cast<unsigned>(n.x())),
                       static_cast<int>(random() % static_cast<unsigned>(n.y())),
                       static_cast<int>(random() % static_cast<unsigned>(n.z()))});
  };
  double taken_J = 0.0, given_J = 0.0;
  for (int round = 0; round < 200; ++round) {
    const std::uint32_t warm = any_place(), gone = any_place();
    if (lump.solid(warm)) {
      lump.add_heat(warm, 1e-3);
      given_J += 1e-3;
    }
    if (lump.solid(gone)) {
      const double before_J = lump.heat_above_J(37.0);
      lump.remove(gone);
      taken_J += before_J - lump.heat_above_J(37.0);
    }
    lump.advance(0.02, {});
  }
  EXPECT_NEAR(lump.heat_above_J(37.0) + taken_J, given_J, 1e-9 * given_J);
  std::vector<double> temperatures;
  for_each_cell(Cell::Zero(), n,
                [&](const Cell& c) { temperatures.push_back(lump.temperature_C(lump.place(c))); });
  return temperatures;
}

Conduction lump_with_holes() {
  const Eigen::Vector3i cells(23, 17, 19);
  std::vector<ThermalMaterial> materials = block(cells, kEnamel);
  std::mt19937 random(3);
  for (ThermalMaterial& m : materials) {
    const unsigned kind = random() % 4;
    m = kind == 0 ? ThermalMaterial{} : kind == 1 ? kDentine : kEnamel;
  }
  return Conduction(cells, 0.2e-3, materials, 37.0);
}

TEST(Conduction, HeatIsNeitherMadeNorLost) {
  Conduction lump = lump_with_holes();
  const std::vector<double> temperatures = stirred(lump);
  EXPECT_GT(*std::ranges::max_element(temperatures), 37.5);
}

TEST(Conduction, IsTheSameForAnyNumberOfThreads) {
  std::vector<std::vector<double>> results;
  for (const int threads : {1, 2, 5}) {
    tbb::task_arena(threads).execute([&] {
      Conduction lump = lump_with_holes();
      results.push_back(stirred(lump));
    });
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

// However well a cell is cooled, no step swings past what cools it.
TEST(Conduction, NoConductanceMakesAStepUnstable) {
  const Eigen::Vector3i cells(6, 6, 6);
  Conduction cube(cells, 0.2e-3, block(cells, kEnamel), 37.0);
  std::vector<HeatExchange> all;
  for_each_cell(Cell::Zero(), cells, [&](const Cell& c) {
    all.push_back({cube.place(c), 1e6, 10.0});
  });
  cube.advance(0.5, all);
  for (const HeatExchange& e : all) EXPECT_NEAR(cube.temperature_C(e.place), 10.0, 1e-6);
}

TEST(Conduction, PlacesAreThoseOfCells) {
  const Eigen::Vector3i cells(3, 4, 5);
  const Conduction cube(cells, 0.2e-3, block(cells, kEnamel), 37.0);
  for_each_cell(Cell(-1, -1, -1), cells + Cell::Ones(), [&](const Cell& c) {
    EXPECT_EQ(cube.cell(cube.place(c)), c);
    const bool inside = (c.array() >= 0).all() && (c.array() < cells.array()).all();
    EXPECT_EQ(cube.solid(cube.place(c)), inside);
  });
}

}  // namespace
}  // namespace sulcus::conduction_test
