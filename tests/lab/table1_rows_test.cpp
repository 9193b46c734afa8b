#include "tools/sulcus_lab/table1/table1_rows.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace sulcus::lab::table1_rows_test {
namespace {

using Eigen::Vector3d;

/// A wrench along x, force in N and torque in mN m.
Wrench along_x(double force_N, double torque_mNm) {
  return {force_N * Vector3d::UnitX(), 1e-3 * torque_mNm * Vector3d::UnitX()};
}

/// Two compared ticks of four.
Table1Run small_run() {
  Table1Run run;
  run.contacts = {3, 9, 4, 0};
  run.leaves_mean = 2.0;
  run.tested_mean = 50.0;
  run.tick_us_mean = 10.0;
  run.removed_voxels = 7;
  run.compared = {{0, 3, along_x(1.0, 10.0), along_x(1.3, 10.0), along_x(1.0, 12.0)},
                  {2, 4, along_x(2.0, 20.0), along_x(1.6, 21.0), along_x(2.0, 20.0)}};
  run.by_axes = {0, 1, 2, 4};
  run.normals = 7;
  run.ours_us = 14.0;
  run.exact_us = 354.0;
  return run;
}

const Table1Row& row_of(const std::vector<Table1Row>& rows, std::string_view quantity) {
  const auto at = std::find_if(rows.begin(), rows.end(),
                               [&](const Table1Row& row) { return row.quantity == quantity; });
  if (at == rows.end()) {
    ADD_FAILURE() << "no row " << quantity;
    return rows.front();
  }
  return *at;
}

TEST(Table1Rows, ErrorsOfMagnitudesAndOfVectors) {
  const Table1Run run = small_run();
  const WrenchErrors errors =
      wrench_errors(run.compared, &ComparedTick::ours, &ComparedTick::exact);
  EXPECT_NEAR(errors.force_rmse_N, std::sqrt((0.09 + 0.16) / 2), 1e-12);
  EXPECT_NEAR(errors.torque_rmse_mNm, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(errors.force_max_N, 0.4, 1e-12);
  EXPECT_EQ(errors.force_max_tick, 2u);
  EXPECT_NEAR(errors.torque_max_mNm, 1.0, 1e-12);
  EXPECT_NEAR(errors.force_bias_N, 0.05, 1e-12);
}

TEST(Table1Rows, ATurnedForceIsSeenByTheVectorsAlone) {
  ComparedTick tick;
  tick.ours.force_N = Vector3d::UnitX();
  tick.exact.force_N = Vector3d::UnitY();
  const ComparedTick ticks[] = {tick};
  const WrenchErrors errors = wrench_errors(ticks, &ComparedTick::ours, &ComparedTick::exact);
  EXPECT_EQ(errors.force_rmse_N, 0.0);
  EXPECT_NEAR(errors.force_vector_rmse_N, std::sqrt(2.0), 1e-12);
}

TEST(Table1Rows, CountsAndTimes) {
  const std::vector<Table1Row> rows = table1_rows("probing", small_run());
  EXPECT_EQ(row_of(rows, "voxels_in_contact_mean").ours, 4.0);
  EXPECT_EQ(row_of(rows, "voxels_in_contact_max").ours, 9.0);
  EXPECT_EQ(row_of(rows, "voxels_in_contact_max_tick").ours, 1.0);
  EXPECT_EQ(row_of(rows, "voxels_removed").ours, 7.0);
  EXPECT_EQ(row_of(rows, "voxels_uni_directional_mean").ours, 0.5);
  EXPECT_EQ(row_of(rows, "voxels_tri_directional_mean").ours, 2.0);
  // The tick of 10 us with 340 us more of normals in two ticks.
  EXPECT_EQ(row_of(rows, "tick_mean_us").ours, 10.0);
  EXPECT_EQ(row_of(rows, "tick_mean_us").exact, 180.0);
  EXPECT_EQ(row_of(rows, "speed_ratio").ours, 18.0);
  EXPECT_EQ(row_of(rows, "normal_mean_us").ours, 2.0);
}

TEST(Table1Rows, ThePaperStandsBesideItsOwnExperimentsOnly) {
  const Table1Run run = small_run();
  const auto filled = [&](std::string_view experiment) {
    const std::vector<Table1Row> rows = table1_rows(experiment, run);
    return std::count_if(rows.begin(), rows.end(),
                         [](const Table1Row& row) { return std::isfinite(row.paper); });
  };
  EXPECT_EQ(filled("probing"), 9);   // the seven of its table, two of the text
  EXPECT_EQ(filled("cutting"), 14);  // and five more of the text
  EXPECT_EQ(filled("probing_smooth"), 0);
  EXPECT_EQ(row_of(table1_rows("cutting", run), "force_rmse_N").paper, 0.15);
  EXPECT_EQ(row_of(table1_rows("probing", run), "torque_rmse_mNm").paper, 5.01);
}

TEST(Table1Rows, ErrorsAgainstTheTruthWhereItIsKnown) {
  Table1Run run = small_run();
  const auto has_truth = [](const std::vector<Table1Row>& rows) {
    return std::any_of(rows.begin(), rows.end(),
                       [](const Table1Row& row) { return row.quantity.starts_with("truth_"); });
  };
  EXPECT_FALSE(has_truth(table1_rows("probing", run)));
  run.has_truth = true;
  const std::vector<Table1Row> rows = table1_rows("probing", run);
  EXPECT_EQ(row_of(rows, "truth_force_rmse_N").ours, 0.0);
  EXPECT_NEAR(row_of(rows, "truth_force_rmse_N").exact, std::sqrt((0.09 + 0.16) / 2), 1e-12);
  EXPECT_NEAR(row_of(rows, "truth_torque_difference_max_mNm").ours, 2.0, 1e-12);
}

}  // namespace
}  // namespace sulcus::lab::table1_rows_test
