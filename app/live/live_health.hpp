#pragma once

#include <cstdint>
#include <string>

#include "app/session/feed.hpp"
#include "app/session/run_statistics.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/fault.hpp"

namespace sulcus {

/// How the ticks of a run keep their time while it goes on, and what is wrong with them. Of the
/// thread that takes its reports.
class LiveHealth {
 public:
  explicit LiveHealth(double rate_hz) : rate_hz_(rate_hz) {}

  void add(const TickReport& report) {
    tick_us_.add(report.record.step_us);
    late_us_.add(report.record.late_us);
    missed_ +=
        static_cast<std::uint64_t>(1e-6 * static_cast<double>(report.record.late_us) * rate_hz_);
    if (report.record.faults != 0) {
      last_fault_tick_ = report.record.tick;
      faults_ = report.record.faults;
    }
    last_tick_ = report.record.tick;
  }

  /// One line for a panel.
  std::string timing() const {
    return formatted("tick p99 %.0f us, late p99 %.1f ms, %llu missed", tick_us_.quantile(0.99),
                     1e-3 * late_us_.quantile(0.99), static_cast<unsigned long long>(missed_));
  }
  /// What was wrong in the last second, by its names; empty where nothing was.
  std::string faults() const {
    if (faults_ == 0 || static_cast<double>(last_tick_ - last_fault_tick_) > rate_hz_) return "";
    std::string names;
    for (const FaultInfo& fault : kFaults) {
      if ((faults_ & fault.bit) == 0) continue;
      if (!names.empty()) names += ", ";
      names += fault.name;
    }
    return names;
  }

 private:
  double rate_hz_;
  Distribution tick_us_, late_us_;
  std::uint64_t missed_ = 0, faults_ = 0, last_fault_tick_ = 0, last_tick_ = 0;
};

}  // namespace sulcus
