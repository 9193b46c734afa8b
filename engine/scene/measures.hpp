#pragma once

#include <array>

#include "engine/scene/assessment_table.hpp"

namespace sulcus {

/// All measures (measure_names). Lengths along the path of insertion or across it. At most, unless
/// a range or "at least" is said.
inline constexpr std::array kMeasures{
    MeasureName{"depth_mm", "mm",
                "of the floor below the tooth as it was, mean; of a crown: of its top", false},
    MeasureName{"greatest_depth_mm", "mm", "where the floor is deepest", false},
    MeasureName{"floor_flatness_um", "um", "RMS of the floor from its best plane", false},
    MeasureName{"convergence_deg", "deg", "between opposite walls; above 0: it opens outward",
                false},
    MeasureName{"wall_mesial_deg", "deg", "of the mesial walls; above 0: they open outward", false},
    MeasureName{"wall_distal_deg", "deg", "of the distal walls, likewise", false},
    MeasureName{"wall_buccal_deg", "deg", "of the buccal walls, likewise", false},
    MeasureName{"wall_lingual_deg", "deg", "of the lingual walls, likewise", false},
    MeasureName{"undercut_mm2", "mm2", "hidden by tooth above it, by area across the insertion",
                false},
    MeasureName{"isthmus_mm", "mm", "of a cavity halfway down: what goes through all of it", false},
    MeasureName{"width_mm", "mm", "of a cavity halfway down, where it is widest", false},
    MeasureName{"margin_mm", "mm", "of a crown's finish line, median", false},
    MeasureName{
        "margin_slope_deg", "deg",
        "of a crown's finish line; 0: a shoulder across the insertion, above 0: falls outward",
        false},
    MeasureName{"roughness_um", "um", "Ra of the walls, mean", false},
    MeasureName{"greatest_roughness_um", "um", "Ra of the walls, where they are roughest", false},
    MeasureName{"wall_left_mm", "mm", "from a cavity to the tooth's outside, across; at least",
                true},
    MeasureName{"dentine_over_pulp_mm", "mm", "left over the pulp; at least", true},
    MeasureName{"pulp_removed_mm3", "mm3", "of the pulp", false},
    MeasureName{"caries_left_mm3", "mm3", "of the caries", false},
    MeasureName{"sound_removed_mm3", "mm3", "of all tissues but caries and pulp", false},
    MeasureName{"neighbour_removed_mm3", "mm3", "of other bodies", false},
    MeasureName{"over_mm", "mm", "greatest cut beyond the goal", false},
    MeasureName{"under_mm", "mm", "greatest that is missing of the goal", false},
    MeasureName{"goal_error_mm", "mm", "of the cut from the goal's wall, mean", false},
    MeasureName{"goal_error_95_mm", "mm", "what 95 % of the cut lies within", false},
    MeasureName{"within_tolerance", "", "share of the cut within tolerance_mm; at least", true},
    MeasureName{"dice", "", "of what was removed and the goal; at least", true},
    MeasureName{"time_s", "s", "of the run", false},
    MeasureName{"contact_s", "s", "in contact", false},
    MeasureName{"strokes", "", "contacts of 0.05 s and more", false},
    MeasureName{"stroke_s", "s", "of a stroke, mean", false},
    MeasureName{"stroke_mm", "mm", "way of the tip in a stroke, mean", false},
    MeasureName{"strokes_per_s", "/s", "from the first contact to the last", false},
    MeasureName{"path_mm", "mm", "way of the tip", false},
    MeasureName{"pauses", "", "of a second and more without contact, between contacts", false},
    MeasureName{"longest_pause_s", "s", "of the pauses", false},
    MeasureName{"smoothness", "", "log dimensionless jerk of the strokes, mean; at least", true},
    MeasureName{"force_N", "N", "greatest", false},
    MeasureName{"mean_force_N", "N", "while in contact", false},
    MeasureName{"median_force_N", "N", "while in contact", false},
    MeasureName{"p95_force_N", "N", "what 95 % of the contact does not exceed", false},
    MeasureName{"over_force_s", "s", "of force above that of force_N", false},
    MeasureName{"burr_angle_deg", "deg", "of the burr against the insertion in contact, mean",
                false},
    MeasureName{"greatest_burr_angle_deg", "deg", "of the burr against the insertion in contact",
                false},
    MeasureName{"enamel_mm3_per_s", "mm3/s", "of enamel, in the time spent on it", false},
    MeasureName{"dentine_mm3_per_s", "mm3/s", "of dentine, in the time spent on it", false},
    MeasureName{"caries_mm3_per_s", "mm3/s", "of caries, in the time spent on it", false},
    MeasureName{"burrs", "", "that were used", false},
};

}  // namespace sulcus
