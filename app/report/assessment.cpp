#include "app/report/assessment.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "app/terminal/terminal.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

namespace {

using Json = nlohmann::ordered_json;

Json millimetres(const Eigen::Vector3d& place_m) {
  const Eigen::Vector3d mm = place_m / kMillimetre;
  return Json::array({mm.x(), mm.y(), mm.z()});
}

Json limit_json(const std::optional<MeasureLimit>& limit) {
  if (!limit) return nullptr;
  const auto end = [](const std::optional<double>& v) { return v ? Json(*v) : Json(nullptr); };
  return Json::array({end(limit->low), end(limit->high)});
}

std::string limit_text(const MeasureLimit& limit) {
  if (limit.low && limit.high) return formatted("%g to %g", *limit.low, *limit.high);
  return limit.low ? formatted(">= %g", *limit.low) : formatted("<= %g", *limit.high);
}

}  // namespace

std::optional<double> value_of(const Assessment& assessment, std::string_view name) {
  const auto found = std::ranges::find(assessment.measures, name, &AssessedMeasure::name);
  if (found == assessment.measures.end()) return {};
  return found->value;
}

std::string assessment_json(const Assessment& assessment) {
  Json measures = Json::array();
  for (const AssessedMeasure& measure : assessment.measures) {
    const Json position = measure.position_m ? millimetres(*measure.position_m) : Json(nullptr);
    measures.push_back({{"name", measure.name},
                        {"value", measure.value},
                        {"unit", measure.unit},
                        {"limit", limit_json(measure.limit)},
                        {"met", measure.limit ? Json(measure.met()) : Json(nullptr)},
                        {"position_mm", position},
                        {"tick", measure.tick ? Json(*measure.tick) : Json(nullptr)},
                        {"time_s", measure.time_s ? Json(*measure.time_s) : Json(nullptr)}});
    if (measure.met() || !measure.moment) continue;
    Json& row = measures.back();
    row["moment"] = {{"force_N", measure.moment->force_N},
                     {"burr_angle_deg", measure.moment->burr_angle_deg},
                     {"tip_mm", millimetres(measure.moment->tip_m)}};
    if (!measure.picture.empty()) row["picture"] = measure.picture;
    if (!measure.film.empty()) row["film"] = measure.film;
  }
  const Json all{{"subject", assessment.subject},
                 {"mark", assessment.mark ? Json(*assessment.mark) : Json(nullptr)},
                 {"measures", measures},
                 {"not_measured", assessment.not_measured}};
  return all.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::vector<std::string> assessment_lines(const Assessment& assessment) {
  std::vector<std::string> lines;
  for (const AssessedMeasure& measure : assessment.measures) {
    std::string line =
        formatted("  %-22s %9.3f %-4s", measure.name.c_str(), measure.value, measure.unit.c_str());
    if (measure.limit) {
      line += formatted("  %-14s %s", limit_text(*measure.limit).c_str(),
                        measure.met() ? "met" : "NOT MET");
      if (!measure.met() && measure.time_s) line += formatted(", at %.2f s", *measure.time_s);
      if (!measure.met() && measure.position_m) {
        const Eigen::Vector3d mm = *measure.position_m / kMillimetre;
        line += formatted(", at %.2f %.2f %.2f mm", mm.x(), mm.y(), mm.z());
      }
    }
    lines.push_back(std::move(line));
  }
  for (const std::string& name : assessment.not_measured) {
    lines.push_back(formatted("  %-22s not there to be measured", name.c_str()));
  }
  if (assessment.mark) lines.push_back(formatted("  %-22s %9.0f of 100", "mark", *assessment.mark));
  return lines;
}

}  // namespace sulcus
