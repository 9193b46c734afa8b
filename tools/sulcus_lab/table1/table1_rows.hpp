#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/sulcus_lab/table1/table1_experiment.hpp"

namespace sulcus::lab {

/// A line of `table1.csv`; NaN: nothing there.
struct Table1Row {
  std::string experiment, quantity;
  double paper, ours, exact;
};

/// How far two columns of wrenches lie apart. Magnitudes are compared as in [Kim and Park 2019,
/// VI-B]; `vector` differences see a turned force too.
struct WrenchErrors {
  double force_rmse_N = 0.0, torque_rmse_mNm = 0.0;                // of magnitudes
  double force_vector_rmse_N = 0.0, torque_vector_rmse_mNm = 0.0;  // of the vectors
  double force_max_N = 0.0, torque_max_mNm = 0.0;                  // of magnitudes
  std::uint64_t force_max_tick = 0;
  double force_bias_N = 0.0;  // mean of (magnitude less the other's)
};
WrenchErrors wrench_errors(std::span<const ComparedTick> ticks, Wrench ComparedTick::*of,
                           Wrench ComparedTick::*against);

/// The rows of one experiment: those of the paper's Table 1 in its order, then those that its text
/// gives, then ours. The paper's figures are filled in for the experiments `probing` and `cutting`.
std::vector<Table1Row> table1_rows(std::string_view experiment, const Table1Run& run);

}  // namespace sulcus::lab
