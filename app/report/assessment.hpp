#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "engine/core/triangle_mesh.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/scene/assessment_table.hpp"

namespace sulcus {

/// What the hand did at the tick that decided a measure.
struct AssessedMoment {
  double force_N = 0.0;
  double burr_angle_deg = 0.0;  // against the path of insertion
  Eigen::Vector3d tip_m{0, 0, 0};
};

/// One figure of a preparation, as assessment.json has it.
struct AssessedMeasure {
  std::string name, unit;
  double value = 0.0;
  std::optional<MeasureLimit> limit;
  std::optional<Eigen::Vector3d> position_m;  // where it is decided, world space
  std::optional<std::uint64_t> tick;          // which made it so
  std::optional<double> time_s;
  std::optional<AssessedMoment> moment;  // where the tick is among those that are known
  std::string picture, film;             // of that moment: files, where they were drawn

  bool met() const { return !limit || limit->met(value); }
};

struct Assessment {
  std::string subject;                    // the file or files
  std::vector<AssessedMeasure> measures;  // in the order of measure_names()
  std::vector<std::string> not_measured;  // of the limits: the preparation has no such thing
  // 0 to 100: the share of the weights that is met. Of what was not measured only depth, a cavity's
  // isthmus and walls and a crown's margin count, as not met.
  std::optional<double> mark;
};

/// Of a recording, from the first tooth on, also where it goes on from another: what the hand did
/// there needs that other one. None where nothing was removed that is deeper than 0.05 mm.
/// InputError where the recording does not hold its run.
std::optional<Assessment> assessment_if_cut(const RecordingReader& reader, const std::string& path,
                                            const AssessmentSettings& settings);
/// The same; InputError also where nothing was removed.
Assessment assess_recording(const RecordingReader& reader, const std::string& path,
                            const AssessmentSettings& settings);

/// A tooth that no recording made: closed surfaces, m, in one space.
struct ScannedTooth {
  struct Surface {
    std::string file;
    TriangleMesh mesh;
  };
  Surface before, after;
  std::optional<Surface> plan;  // the tooth as it should have become
};
/// InputError where the surfaces do not overlie, where nothing was removed, and where the plan
/// removes nothing.
Assessment assess_scanned(const ScannedTooth& tooth, const AssessmentSettings& settings);

/// Of a measure; none where it was not measured.
std::optional<double> value_of(const Assessment& assessment, std::string_view name);

/// assessment.json.
std::string assessment_json(const Assessment& assessment);

/// As a table for a terminal, line by line.
std::vector<std::string> assessment_lines(const Assessment& assessment);

}  // namespace sulcus
