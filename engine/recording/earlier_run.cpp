#include "engine/recording/earlier_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sulcus {

void RunMeasures::add(const TickRecord& row, const PortRecord* port) {
  const double(&f)[3] = row.force_N;
  const double force_N = std::sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  ++ticks;
  if (row.contacts > 0) {
    ++ticks_in_contact;
    peak_force_N = std::max(peak_force_N, force_N);
    force_in_contact_sum_N += force_N;
  }
  if (port && !std::equal(f, f + 3, port->asked_force_N)) ++limited_ticks;
  for (const auto& [count, fault] :
       {std::pair{&buzz_ticks, kFaultBuzz}, std::pair{&silent_ticks, kFaultDeviceSilent},
        std::pair{&jumped_ticks, kFaultDeviceJumped},
        std::pair{&long_step_ticks, kFaultStepTooLong},
        std::pair{&inside_ticks, kFaultToolInside}}) {
    if (row.faults & fault) ++*count;
  }
}

}  // namespace sulcus
