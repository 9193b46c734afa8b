#include "tools/sulcus_lab/ticks/ticks_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <limits>

#include "engine/core/units.hpp"
#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/statistics.hpp"

namespace sulcus::lab {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kManyFrom = 1000;  // contacts from which the cost of one must not grow

[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...) {
  char buffer[256];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

std::string key_of(const TickSetting& setting, int wanted) {
  return std::string(method_name(setting)) + "," + std::string(cache_name(setting)) + "," +
         std::to_string(wanted) + ",";
}

std::string named(const TickSetting& setting) {
  return std::string(method_name(setting)) + ", " + std::string(cache_name(setting));
}

std::string times_of(const TickSummary& s) {
  return text("%.3f,%.3f,%.3f,%.3f", s.us_mean, s.us_p50, s.us_p99, s.us_max);
}

/// The row of a setting with so many contacts; null where it was not measured.
const TickRow* find(std::span<const TickRow> rows, const TickSetting& setting, int wanted) {
  for (const TickRow& row : rows) {
    if (row.setting == setting && row.wanted == wanted) return &row;
  }
  return nullptr;
}

constexpr NormalMethod kOurs[] = {NormalMethod::kLdmFast, NormalMethod::kLdm};

/// Time per contact of the most contacts to that of the fewest from kManyFrom on.
void add_cost_growth(std::span<const TickRow> rows, const TickSetting& setting,
                     std::vector<TickRatio>& ratios) {
  const TickRow *first = nullptr, *last = nullptr;
  for (const TickRow& row : rows) {
    if (row.setting != setting || row.wanted < kManyFrom) continue;
    if (!first || row.wanted < first->wanted) first = &row;
    if (!last || row.wanted > last->wanted) last = &row;
  }
  if (first == last) return;
  const auto cost = [](const TickRow& row) { return row.summary.us_mean / row.summary.contacts; };
  ratios.push_back({"4: time per contact, " + std::to_string(last->wanted) + " to " +
                        std::to_string(first->wanted) + ", " + named(setting),
                    cost(*last) / cost(*first), 1.0, kNone, true});
}

}  // namespace

std::vector<TickRow> rows_of(const TicksGroup& group) {
  std::vector<TickRow> rows;
  for (const TickRun& run : group.runs) {
    const double pca_us = group.pca_ns ? 1e-3 * *group.pca_ns * run.summary.contacts : kNone;
    rows.push_back({run.setting, group.wanted, run.summary, run.stages, pca_us});
  }
  return rows;
}

std::vector<TickRatio> tick_ratios(std::span<const TickRow> rows, std::span<const SweepRow> cells,
                                   std::span<const SweepRow> bodies) {
  std::vector<TickRatio> ratios;
  const auto against_pca = [&](const char* what, const TickSetting& setting, int wanted,
                               double TickSummary::*time, double must, double aim) {
    const TickRow* row = find(rows, setting, wanted);
    if (!row || !std::isfinite(row->pca_us)) return;
    ratios.push_back(
        {what + (", " + named(setting)), row->pca_us / (row->summary.*time), must, aim, false});
  };
  for (const NormalMethod method : kOurs) {
    against_pca("1: PCA / mean at 10,000", {method, TickCache::kFresh}, 10000,
                &TickSummary::us_mean, 60, 180);
  }
  for (const NormalMethod method : kOurs) {
    against_pca("2: PCA / mean at 10,000", {method, TickCache::kKept}, 10000, &TickSummary::us_mean,
                220, 450);
  }
  for (const NormalMethod method : kOurs) {
    const TickSetting cutting{method, TickCache::kCutting};
    against_pca("2: PCA / p99 at 10,000", cutting, 10000, &TickSummary::us_p99, 45, kNone);
    if (const TickRow* row = find(rows, cutting, 10000)) {
      ratios.push_back({"2: p99.9 / median at 10,000, " + named(cutting),
                        row->summary.us_p999 / row->summary.us_p50, 6, kNone, true});
    }
  }
  for (const NormalMethod method : kOurs) {
    against_pca("3: PCA / mean at 350", {method, TickCache::kCutting}, 350, &TickSummary::us_mean,
                20, 50);
  }
  if (!cells.empty()) ratios.push_back({"4: more cells", growth_of(cells), 1.3, kNone, true});
  if (!bodies.empty()) ratios.push_back({"4: more bodies", growth_of(bodies), 1.1, kNone, true});
  for (const NormalMethod method : kOurs) {
    for (const TickCache cache : {TickCache::kFresh, TickCache::kKept, TickCache::kCutting}) {
      add_cost_growth(rows, {method, cache}, ratios);
    }
  }
  return ratios;
}

std::string ticks_line(const TickRow& row) {
  return key_of(row.setting, row.wanted) + times_of(row.summary);
}

std::vector<std::string> stage_lines(const TickRow& row) {
  std::vector<std::string> lines;
  for (std::size_t s = 0; s < row.stages.size(); ++s) {
    lines.push_back(key_of(row.setting, row.wanted) + text("%s,%.3f,%.3f", kStageNames[s],
                                                           row.stages[s].us_mean,
                                                           row.stages[s].us_p99));
  }
  return lines;
}

std::string sweep_line(const SweepRow& row) {
  return std::to_string(row.size) + "," + key_of(row.setting, row.wanted) +
         text("%.1f,", row.summary.contacts) + times_of(row.summary);
}

std::string found_line(const TickRow& row) {
  const TickSummary& s = row.summary;
  return key_of(row.setting, row.wanted) +
         text("%.1f,%d,%d,%.3f,%.4f,%.3f,", s.contacts, s.least, s.most, s.removed,
              s.ticks_that_cut, s.us_p999) +
         number_cell("%.0f", s.instructions > 0.0 ? s.instructions : kNone) + "," +
         number_cell("%.2f", row.pca_us) + "," + number_cell("%.2f", row.pca_us / s.us_mean) + "," +
         number_cell("%.2f", row.pca_us / s.us_p99);
}

std::vector<std::string> floor_lines(const TickPlace& place) {
  std::vector<std::string> lines;
  for (const bool fresh : {true, false}) {
    const TickFloor& f = fresh ? place.fresh : place.kept;
    lines.push_back(text("%s,%d,%d,%.3f,%.4f,%.0f,%.0f,%.0f,%.0f,%.0f,%.2f,%.3f",
                         fresh ? "fresh" : "kept", place.wanted, place.cells,
                         place.diameter_m / kMillimetre, place.depth_m / kMillimetre, f.surface,
                         f.field, f.columns, f.kept, f.records, f.gb_per_s, f.us));
  }
  return lines;
}

void print_rows(std::span<const TickRow> rows) {
  std::printf("%-10s %-8s %9s %9s %9s %9s %9s %9s %9s %8s %8s\n", "", "", "contacts", "us mean",
              "p50", "p99", "p99.9", "max", "ns each", "removed", "PCA /");
  for (const TickRow& row : rows) {
    const TickSummary& s = row.summary;
    std::printf("%-10s %-8s %9.1f %9.2f %9.2f %9.2f %9.2f %9.2f %9.1f %8.2f %8s\n",
                std::string(method_name(row.setting)).c_str(),
                std::string(cache_name(row.setting)).c_str(), s.contacts, s.us_mean, s.us_p50,
                s.us_p99, s.us_p999, s.us_max, 1e3 * s.us_mean / s.contacts, s.removed,
                number_cell("%.1f", row.pca_us / s.us_mean).c_str());
    if (s.faults != 0) {
      std::printf("  fault bits %llu\n", static_cast<unsigned long long>(s.faults));
    }
  }
  std::fflush(stdout);
}

void print_place(const TickPlace& place) {
  std::printf("\n%d contacts, %d^3: a round burr of %.2f mm, %.3f mm deep: %.1f, %d to %d.",
              place.wanted, place.cells, place.diameter_m / kMillimetre,
              place.depth_m / kMillimetre, place.contacts, place.least, place.most);
  if (std::isfinite(place.pca_ns)) std::printf(" PCA: %.0f ns a normal.", place.pca_ns);
  std::printf(
      "\nCutting: %.3g J/mm3. At least %.0f bytes a contact fresh, %.0f kept: %.2f, %.2f us\n",
      place.specific_energy_J_per_m3 * 1e-9, place.fresh.bytes() / place.contacts,
      place.kept.bytes() / place.contacts, place.fresh.us, place.kept.us);
}

void print_sweep(const char* what, std::span<const SweepRow> rows) {
  if (rows.empty()) return;
  std::printf("\n%-8s %-10s %-8s %9s %9s %9s\n", what, "", "", "contacts", "us mean", "p99");
  for (const SweepRow& row : rows) {
    std::printf("%-8d %-10s %-8s %9.1f %9.2f %9.2f\n", row.size,
                std::string(method_name(row.setting)).c_str(),
                std::string(cache_name(row.setting)).c_str(), row.summary.contacts,
                row.summary.us_mean, row.summary.us_p99);
  }
}

void print_ratios(std::span<const TickRatio> ratios) {
  if (ratios.empty()) return;
  std::printf("\n%-62s %9s %9s %9s\n", "", "found", "must", "aim");
  for (const TickRatio& ratio : ratios) {
    std::printf("%-62s %9.2f %9s %9s%s\n", ratio.what.c_str(), ratio.value,
                text("%s %g", ratio.at_most ? "<=" : ">=", ratio.must).c_str(),
                number_cell("%g", ratio.aim).c_str(), ratio.met() ? "" : "  not met");
  }
}

}  // namespace sulcus::lab
