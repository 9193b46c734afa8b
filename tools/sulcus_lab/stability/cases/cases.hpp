#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tools/sulcus_lab/results.hpp"
#include "tools/sulcus_lab/stability/rig.hpp"
#include "tools/sulcus_lab/stability/stability_row.hpp"

namespace sulcus::lab {

/// A case under one method: what it measures is added here.
class CaseTrial {
 public:
  CaseTrial(std::string_view case_name, ContactMethod method_of, bool is_brief, CaseResult& result)
      : method(method_of), brief(is_brief), case_name_(case_name), result_(result) {}

  const ContactMethod method;
  const bool brief;  // fewer settings, for tests: what is run is run to its limits

  template <class T>
  std::vector<T> settings(std::vector<T> if_brief, std::vector<T> all) const {
    return brief ? std::move(if_brief) : std::move(all);
  }
  /// `quantity` with its unit; `setting`: what sets the run apart from others of the case. The row,
  /// until the next is added.
  StabilityRow& add(std::string_view quantity, std::string_view setting, double value,
                    const RowLimit& limit = {});
  /// Force along a direction, and how deep the tool's tip is below z = 0.
  void trace(std::string_view label, std::span<const Felt> ticks,
             const Eigen::Vector3d& along = Eigen::Vector3d::UnitZ());
  /// Of ticks of a millisecond.
  void trace(std::string_view label, std::vector<float> force_N, std::vector<float> depth_mm = {});

 private:
  std::string_view case_name_;
  CaseResult& result_;
};

/// How much of a case is run.
struct CaseOptions {
  std::span<const ContactMethod> methods;
  bool brief = false;
};

/// The methods that a case applies to.
enum class CaseMethods {
  kAll,
  kBurrs,     // not the single point, which has one contact and no burr that cuts
  kCoupling,  // if it is among those that are asked for
  kOurs,      // no method of contact is compared
};

/// What a case does and why stands above its function, and for readers of the page in case_texts.
struct StabilityCase {
  std::string_view name;
  CaseMethods methods;
  void (*run)(CaseTrial&);
};
/// The harness, the twenty in their order, and what is measured besides.
std::span<const StabilityCase> stability_cases();
/// One of them by its name; rows in the order of the methods.
CaseResult run_case(std::string_view name, const CaseOptions& options);

// cases_walls.cpp
void thin_wall(CaseTrial& trial);
void thin_wall_stiffness(CaseTrial& trial);
void tunnelling(CaseTrial& trial);
void sticking(CaseTrial& trial);
void deep_inside(CaseTrial& trial);
// cases_normals.cpp
void edge_normals(CaseTrial& trial);
void tilted_planes(CaseTrial& trial);
void opposing_faces(CaseTrial& trial);
// cases_contacts.cpp
void vanishing_voxels(CaseTrial& trial);
void count_steps(CaseTrial& trial);
void spur(CaseTrial& trial);
void wedge(CaseTrial& trial);
// cases_pressed.cpp
void buzz_case(CaseTrial& trial);
void coupling_mismatch(CaseTrial& trial);
// cases_thrown.cpp
void sample_and_hold(CaseTrial& trial);
void proxy_thrown(CaseTrial& trial);
void late_tick(CaseTrial& trial);
// cases_cutting.cpp
void loose_piece(CaseTrial& trial);
void overload(CaseTrial& trial);
void cutting_energy(CaseTrial& trial);
// wall_loop.cpp, clinical_pushes.cpp, coupled_tick.cpp
void harness(CaseTrial& trial);
void pressed_off_axis(CaseTrial& trial);
void clinical_pushes(CaseTrial& trial);
void coupled_tick(CaseTrial& trial);

}  // namespace sulcus::lab
