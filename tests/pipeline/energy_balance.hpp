#pragma once

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

// What a summary says of energies, for tests.

namespace sulcus::test {

/// Removed, stored and heat are the work, in all and of each tissue of each body; and what all
/// tissues have is what there is in all; unless, as where a run goes on from an earlier build's,
/// tissues were not counted from its first tick on.
inline void expect_energies_balance(const nlohmann::json& summary, bool tissues_from_start = true) {
  const double work_J = summary["tangential_work_J"], heat_J = summary["heat_J"];
  const double rounding = tissues_from_start ? 1e-9 : 1e-6;
  EXPECT_GT(work_J, 0.0);
  EXPECT_GE(heat_J, 0.0);
  EXPECT_NEAR(
      summary["removed_energy_J"].get<double>() + summary["stored_energy_J"].get<double>() + heat_J,
      work_J, rounding * work_J);
  double work_of_all_J = 0.0, heat_of_all_J = 0.0;
  const auto add = [&](const nlohmann::json& tissues) {
    for (const auto& [name, energy] : tissues.items()) {
      const double own_J = energy["work"];
      EXPECT_NEAR(energy["removed"].get<double>() + energy["stored"].get<double>() +
                      energy["heat"].get<double>(),
                  own_J, rounding * own_J)
          << name;
      work_of_all_J += own_J;
      heat_of_all_J += energy["heat"].get<double>();
    }
  };
  add(summary["tissue_energy_J"]);
  for (const auto& body : summary.value("bodies", nlohmann::json::array())) {
    if (body.contains("tissue_energy_J")) add(body["tissue_energy_J"]);
  }
  if (!tissues_from_start) return;
  EXPECT_NEAR(work_of_all_J, work_J, 1e-9 * work_J);
  EXPECT_NEAR(heat_of_all_J, heat_J, 1e-9 * work_J);
}

}  // namespace sulcus::test
