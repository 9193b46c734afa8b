#pragma once

#include <span>
#include <string_view>

#include "tools/sulcus_lab/stability/stability_row.hpp"

namespace sulcus::lab {

/// How much of a case is run.
struct CaseOptions {
  std::span<const ContactMethod> methods;
  bool brief = false;  // fewer settings, for tests: what is run is run to its limits
};

/// The twenty cases, each in the order of its methods; what does not apply to a method is left out.
/// What each does and why stands above it, and for readers of the page in case_texts.
struct StabilityCase {
  std::string_view name;
  CaseResult (*run)(const CaseOptions&);
};
std::span<const StabilityCase> stability_cases();

// cases_walls.cpp
CaseResult thin_wall(const CaseOptions& options);
CaseResult thin_wall_stiffness(const CaseOptions& options);
CaseResult tunnelling(const CaseOptions& options);
CaseResult sticking(const CaseOptions& options);
CaseResult deep_inside(const CaseOptions& options);
// cases_normals.cpp
CaseResult edge_normals(const CaseOptions& options);
CaseResult tilted_planes(const CaseOptions& options);
CaseResult opposing_faces(const CaseOptions& options);
// cases_contacts.cpp
CaseResult vanishing_voxels(const CaseOptions& options);
CaseResult count_steps(const CaseOptions& options);
CaseResult spur(const CaseOptions& options);
CaseResult wedge(const CaseOptions& options);
// cases_pressed.cpp
CaseResult buzz_case(const CaseOptions& options);
CaseResult coupling_mismatch(const CaseOptions& options);
// cases_thrown.cpp
CaseResult sample_and_hold(const CaseOptions& options);
CaseResult proxy_thrown(const CaseOptions& options);
CaseResult late_tick(const CaseOptions& options);
// cases_cutting.cpp
CaseResult loose_piece(const CaseOptions& options);
CaseResult overload(const CaseOptions& options);
CaseResult cutting_energy(const CaseOptions& options);

}  // namespace sulcus::lab
