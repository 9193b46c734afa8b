#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/sulcus_lab/ticks/ticks_floor.hpp"
#include "tools/sulcus_lab/ticks/ticks_measurement.hpp"
#include "tools/sulcus_lab/ticks/ticks_sweeps.hpp"

namespace sulcus::lab {

/// What ticks is left with of one row of ticks.csv.
struct TickRow {
  TickSetting setting;
  int wanted = 0;
  TickSummary summary;
  std::array<StageTimes, kStageCount> stages{};
  double pca_us = 0.0;  // of as many normals by PCL's PCA; NaN without PCL
};
std::vector<TickRow> rows_of(const TicksGroup& group);

/// Where and what was measured at one number of contacts.
struct TickPlace {
  int wanted = 0;
  int cells = 0;  // of the molar, along an axis
  double diameter_m = 0.0, depth_m = 0.0, specific_energy_J_per_m3 = 0.0;
  double contacts = 0.0;  // mean of the poses
  int least = 0, most = 0;
  double pca_ns = 0.0;  // per normal; NaN without PCL
  TickFloor fresh, kept;
};

/// A ratio that the issue sets a bound to.
struct TickRatio {
  std::string what;
  double value, must, aim;  // aim: NaN where there is none
  bool at_most;             // else at least

  bool met() const { return at_most ? value <= must : value >= must; }
};
/// Those whose rows were measured.
std::vector<TickRatio> tick_ratios(std::span<const TickRow> rows, std::span<const SweepRow> cells,
                                   std::span<const SweepRow> bodies);

// Lines of the tables, without their ends.
inline constexpr const char* kTicksHeader = "method,cache,contacts,us_mean,us_p50,us_p99,us_max";
std::string ticks_line(const TickRow& row);
inline constexpr const char* kStagesHeader = "method,cache,contacts,stage,us_mean,us_p99";
std::vector<std::string> stage_lines(const TickRow& row);
inline constexpr const char* kSweepColumns =
    ",method,cache,contacts,contacts_mean,us_mean,us_p50,us_p99,us_max";
std::string sweep_line(const SweepRow& row);
inline constexpr const char* kFoundHeader =
    "method,cache,contacts,contacts_mean,contacts_min,contacts_max,removed_per_tick,ticks_that_cut,"
    "us_p999,instructions_per_tick,pca_us,pca_to_mean,pca_to_p99";
std::string found_line(const TickRow& row);
inline constexpr const char* kFloorHeader =
    "cache,contacts,cells,burr_mm,depth_mm,surface_bytes,field_bytes,column_bytes,kept_bytes,"
    "record_"
    "bytes,"
    "gb_per_s,floor_us";
std::vector<std::string> floor_lines(const TickPlace& place);

/// The tables, for a terminal.
void print_rows(std::span<const TickRow> rows);
void print_place(const TickPlace& place);
void print_sweep(const char* what, std::span<const SweepRow> rows);
void print_ratios(std::span<const TickRatio> ratios);

}  // namespace sulcus::lab
