#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sulcus::lab {

/// How a tool meets the tooth, and what of that the hand feels.
enum class ContactMethod : std::uint8_t {
  kCoupling,     // ours: smooth scaling behind a virtual coupling
  kSmooth,       // the same scaling, and the tool follows the device
  kCount,        // the paper's scaling by the count of contacts, likewise
  kNone,         // the plain penalty: every contact at its full stiffness, likewise
  kMcNeely,      // [McNeely et al. 1999]'s scaling, likewise
  kSinglePoint,  // one point instead of a burr, and its proxy on the surface
};
inline constexpr std::array<std::string_view, 6> kContactMethodNames{
    "coupling", "smooth", "count", "none", "mcneely", "single_point"};

inline std::string name_of(ContactMethod method) {
  return std::string(kContactMethodNames[static_cast<std::size_t>(method)]);
}

/// One line of stability.csv: what one run of a case measured, and the limit it is held to.
struct StabilityRow {
  std::string case_name;  // "thin_wall", ...
  ContactMethod method = ContactMethod::kCoupling;
  std::string device, hand;  // empty: a scripted trajectory
  double burr_mm = 1.0;      // diameter
  int delay = 0;             // ticks
  double push_N = 0.0;       // 0: none
  std::string quantity;      // with its unit: "force_reversal_N"
  double value = 0.0;
  std::optional<double> limit;  // none: reported only
  bool at_least = false;        // the limit is the least that passes, else the most
  bool pass() const { return !limit || (at_least ? value >= *limit : value <= *limit); }
};

/// What a row is held to; none: it is only reported.
struct RowLimit {
  std::optional<double> value;
  bool is_least = false;
};
inline RowLimit at_most(std::optional<double> value) { return {value, false}; }
inline RowLimit at_least(std::optional<double> value) { return {value, true}; }

/// A run's force over time, kept for the pictures.
struct ForceTrace {
  std::string case_name, label;  // "wall of 2 voxels"
  ContactMethod method = ContactMethod::kCoupling;
  double dt_s = 1e-3;
  std::vector<float> force_N;   // felt, before the device's limits
  std::vector<float> depth_mm;  // of the tool in the solid; empty: not measured
};

/// What a case found.
struct CaseResult {
  std::vector<StabilityRow> rows;
  std::vector<ForceTrace> traces;
};

}  // namespace sulcus::lab
