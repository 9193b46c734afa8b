#pragma once

#include <numbers>

namespace sulcus {

// SI inside; files and commands carry the unit in the key. A value read is multiplied, a value
// written divided: `radius_m = radius_mm * kMillimetre`.
inline constexpr double kMillimetre = 1e-3;                                    // m
inline constexpr double kMillisecond = 1e-3;                                   // s
inline constexpr double kNewtonPerMillimetre = 1e3;                            // N/m
inline constexpr double kJoulePerMm3 = 1e9;                                    // J/m^3
inline constexpr double kMillilitrePerMinute = 1e-6 / 60.0;                    // m^3/s
inline constexpr double kDegree = std::numbers::pi / 180.0;                    // rad
inline constexpr double kRevolutionPerMinute = 2.0 * std::numbers::pi / 60.0;  // rad/s
inline constexpr double kMebibyte = 1024.0 * 1024.0;                           // bytes

}  // namespace sulcus
