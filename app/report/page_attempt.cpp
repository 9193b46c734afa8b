#include "app/report/page_attempt.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "app/playback/edit_cursor.hpp"
#include "app/playback/recorded_film.hpp"
#include "app/report/measures_table.hpp"
#include "app/report/page/curves.hpp"
#include "app/report/page/page_fields.hpp"
#include "app/report/page/page_solid.hpp"
#include "engine/core/base64.hpp"
#include "engine/core/units.hpp"
#include "engine/outcome/goal.hpp"

namespace sulcus {

namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kBurrPoses = 600;

template <class Values>
std::string bytes_text(const Values& values) {
  using Value = typename Values::value_type;
  static_assert(std::is_trivially_copyable_v<Value>);
  std::vector<std::uint8_t> bytes(values.size() * sizeof(Value));
  if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return base64(bytes);
}

Json numbers(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

/// Positions in 65,535 steps over a box, the same for all meshes that are to fit together.
class MeshPacker {
 public:
  void see(const TriangleMesh& mesh) {
    for (const Eigen::Vector3f& p : mesh.positions) box_.extend(p.cast<double>());
  }
  Json packed(const PageSurface& surface) const {
    std::vector<std::array<std::uint16_t, 3>> positions;
    positions.reserve(surface.mesh.positions.size());
    for (const Eigen::Vector3f& p : surface.mesh.positions) {
      const Eigen::Vector3d steps = (p.cast<double>() - box_.min()) / step_m();
      positions.push_back({step_of(steps.x()), step_of(steps.y()), step_of(steps.z())});
    }
    std::vector<std::array<std::int8_t, 3>> normals;
    normals.reserve(surface.normals.size());
    for (const Eigen::Vector3f& n : surface.normals) {
      std::array<std::int8_t, 3> packed_normal{};
      for (std::size_t k = 0; k < 3; ++k) {
        const float part = n[static_cast<Eigen::Index>(k)];
        packed_normal[k] = static_cast<std::int8_t>(std::lround(127.0f * part));
      }
      normals.push_back(packed_normal);
    }
    const bool small = positions.size() <= 65536;
    std::vector<std::array<std::uint16_t, 3>> short_indices;
    if (small) {
      short_indices.reserve(surface.mesh.triangles.size());
      for (const auto& [a, b, c] : surface.mesh.triangles) {
        short_indices.push_back({static_cast<std::uint16_t>(a), static_cast<std::uint16_t>(b),
                                 static_cast<std::uint16_t>(c)});
      }
    }
    return {{"positions", bytes_text(positions)},
            {"normals", bytes_text(normals)},
            {"indices", small ? bytes_text(short_indices) : bytes_text(surface.mesh.triangles)},
            {"index_bytes", small ? 2 : 4}};
  }
  Json low() const { return numbers(box_.min() / kMillimetre); }
  double step_mm() const { return step_m() / kMillimetre; }

 private:
  static std::uint16_t step_of(double steps) {
    return static_cast<std::uint16_t>(std::lround(std::clamp(steps, 0.0, 65535.0)));
  }
  double step_m() const {
    return box_.isEmpty() ? 1.0 : std::max(box_.sizes().maxCoeff(), 1e-9) / 65535.0;
  }
  Eigen::AlignedBox3d box_;
};

/// As three.js has a matrix, by columns, mm.
Json matrix_json(const Pose& pose) {
  const Eigen::Matrix3d r = pose.orientation.toRotationMatrix();
  const Eigen::Vector3d p = pose.position / kMillimetre;
  return Json::array({r(0, 0), r(1, 0), r(2, 0), 0, r(0, 1), r(1, 1), r(2, 1), 0, r(0, 2), r(1, 2),
                      r(2, 2), 0, p.x(), p.y(), p.z(), 1});
}

Json fields_json(const PageFields& fields, const VoxelGrid& grid) {
  return {{"low", numbers(grid.centre_world(fields.first) / kMillimetre)},
          {"step", fields.step * grid.voxel_m / kMillimetre},
          {"samples", {fields.samples.x(), fields.samples.y(), fields.samples.z()}},
          {"goal_step", PageFields::kGoalStep_m / kMillimetre},
          {"depth_step", PageFields::kDepthStep_m / kMillimetre},
          {"tissue_goal", bytes_text(fields.tissue_goal)},
          {"cut_depth", bytes_text(fields.cut_depth)}};
}

/// One recording, on its way to a page.
class AttemptMaker {
 public:
  AttemptMaker(const RecordingReader& reader, const std::string& path, const Assessment* assessment,
               const AssessmentSettings& settings, std::size_t moments)
      : film_(reader, path),
        assessment_(assessment),
        settings_(settings),
        rate_hz_(film_.scene().haptics.rate_hz) {
    bodies_ = film_.bodies();
    if (const EarlierRun* earlier = film_.earlier()) {
      bodies_.front().model = earlier->start;
      // Of the other bodies the recording holds what they were at its own start.
      std::ranges::copy_if(earlier->edits, std::back_inserter(edits_),
                           [](const Edit& edit) { return edit.body == 0; });
    }
    const std::vector<Edit> own = recorded_edits(reader, film_.rows().size() - 1);
    edits_.insert(edits_.end(), own.begin(), own.end());
    if (film_.scene().goal) {
      const std::optional<VoxelModel> from_file = reader.goal();
      target_ =
          target_of_goal(film_.scene(), bodies_.front().model, from_file ? &*from_file : nullptr);
    }
    find_moments(std::max<std::size_t>(moments, 1));
  }

  Json make() {
    Json attempt{{"title", film_.scene().title},
                 {"end_s", film_.rows().back().time_s},
                 {"mark", nullptr},
                 {"kind", kAssessedKindNames[static_cast<std::size_t>(settings_.kind)]}};
    if (assessment_ && assessment_->mark) attempt["mark"] = *assessment_->mark;
    attempt["tissues"] = tissues();
    attempt["moments"] = moments();
    attempt["pins"] = pins();
    attempt["bodies"] = Json::array();
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
      attempt["bodies"].push_back(body_json(body));
    }
    attempt["plan"] = target_ ? mesh_json(page_surface(*target_)) : Json(nullptr);
    attempt["burr"] = burr();
    return attempt;
  }

 private:
  using MomentAt = std::pair<std::size_t, double>;  // edits made by then; its time, s

  double time_of(std::uint64_t tick) const { return static_cast<double>(tick) / rate_hz_; }

  void find_moments(std::size_t count) {
    std::vector<MomentAt> all{{0, 0.0}, {edits_.size(), film_.rows().back().time_s}};
    for (std::size_t n = 1; n < count && !edits_.empty(); ++n) {
      all.push_back(at_tick(edits_[edits_.size() * n / count].tick));
    }
    // Also where a push cuts nothing, between two others.
    for (const AssessedMeasure* measure : not_met()) {
      if (measure->tick) all.push_back(at_tick(*measure->tick));
    }
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    for (const auto& [end, time_s] : all) {
      ends_.push_back(end);
      times_s_.push_back(time_s);
    }
  }
  MomentAt at_tick(std::uint64_t tick) const {
    const auto end = std::ranges::upper_bound(edits_, tick, {}, &Edit::tick);
    return {static_cast<std::size_t>(end - edits_.begin()), time_of(tick)};
  }
  /// Of one of them, its number.
  std::size_t number_of(const MomentAt& moment) const {
    std::size_t number = 0;
    while (number + 1 < ends_.size() && MomentAt(ends_[number], times_s_[number]) < moment) {
      ++number;
    }
    return number;
  }

  std::vector<const AssessedMeasure*> not_met() const {
    std::vector<const AssessedMeasure*> wrong;
    if (!assessment_) return wrong;
    for (const AssessedMeasure& measure : assessment_->measures) {
      if (!measure.met()) wrong.push_back(&measure);
    }
    return wrong;
  }

  Json tissues() const {
    Json all = Json::array();
    for (const TissueLook& look : bodies_.front().looks) {
      Json rgb = Json::array();
      for (const float part : look.colour) rgb.push_back(screen_byte(static_cast<double>(part)));
      all.push_back({{"name", look.name}, {"colour", rgb}});
    }
    return all;
  }

  Json moments() const {
    Json all = Json::array();
    double removed_mm3 = 0.0;
    std::size_t at = 0;
    for (std::size_t m = 0; m < ends_.size(); ++m) {
      for (; at < ends_[m]; ++at) {
        if (!edits_[at].is_gone()) continue;
        removed_mm3 += bodies_[edits_[at].body].model.grid.voxel_volume_m3() * 1e9;
      }
      const double share =
          edits_.empty() ? 1.0 : static_cast<double>(ends_[m]) / static_cast<double>(edits_.size());
      all.push_back({{"time_s", times_s_[m]}, {"share", share}, {"removed_mm3", removed_mm3}});
    }
    return all;
  }

  Json pins() const {
    Json all = Json::array();
    for (const AssessedMeasure* measure : not_met()) {
      std::size_t moment = ends_.size() - 1;
      if (measure->tick) {
        moment = number_of(at_tick(*measure->tick));
        all.push_back({{"time_s", time_of(*measure->tick)}});
      } else {
        all.push_back({{"time_s", nullptr}});
      }
      Json& pin = all.back();
      pin["moment"] = moment;
      pin["name"] = measure->name;
      pin["title"] = measure_title(*measure);
      pin["text"] = plain_number(measure->value) + " " + unit_title(measure->unit) + ", to be " +
                    limit_title(*measure->limit);
      pin["at"] = measure->position_m ? numbers(*measure->position_m / kMillimetre) : Json(nullptr);
    }
    return all;
  }

  Json body_json(std::size_t body) const {
    const RenderedBody& rendered = bodies_[body];
    const VoxelSet* const target = body == 0 && target_ ? &*target_ : nullptr;
    const PageSolid solid =
        page_solid(rendered.model, rendered.looks.size(), edits_, body, ends_, target);
    MeshPacker packer;
    for (const PageSurface& surface : solid.still) packer.see(surface.mesh);
    for (const PageSurface& surface : solid.moving) packer.see(surface.mesh);
    Json still = Json::array(), moving = Json::array();
    for (std::size_t t = 0; t < solid.still.size(); ++t) {
      if (solid.still[t].mesh.triangles.empty()) continue;
      still.push_back(packer.packed(solid.still[t]));
      Json rgb = Json::array();
      for (const float part : rendered.looks[t].colour) {
        rgb.push_back(screen_byte(static_cast<double>(part)));
      }
      still.back()["colour"] = rgb;
    }
    for (const PageSurface& surface : solid.moving) moving.push_back(packer.packed(surface));
    Json fields = nullptr;
    if (!solid.box.isEmpty()) {
      const Pose& pose = rendered.world_from_grid;
      fields = fields_json(page_fields(rendered.model, solid.box,
                                       {.looks = rendered.looks,
                                        .edits = edits_,
                                        .body = body,
                                        .target = target,
                                        .kind = settings_.kind,
                                        .insertion = pose.inverse_direction(settings_.insertion)}),
                           rendered.model.grid);
      fields["has_goal"] = target != nullptr;
    }
    return {{"low", packer.low()},
            {"step", packer.step_mm()},
            {"matrix", matrix_json(rendered.world_from_grid)},
            {"still", still},
            {"moving", moving},
            {"shown", solid.shown},
            {"fields", fields}};
  }

  static Json mesh_json(const PageSurface& surface) {
    MeshPacker packer;
    packer.see(surface.mesh);
    Json mesh = packer.packed(surface);
    mesh["low"] = packer.low();
    mesh["step"] = packer.step_mm();
    return mesh;
  }

  Json burr() const {
    const TriangleMesh& mesh = film_.burr().mesh_tool;
    if (mesh.triangles.empty()) return nullptr;
    MeshPart few = simplified(mesh, 0.2 * kMostPageError_m);
    const std::vector<Eigen::Vector3f> normals = smoothed_normals(mesh, 0);
    PageSurface surface;
    for (const std::uint32_t v : few.vertex_of) surface.normals.push_back(normals[v]);
    surface.mesh = std::move(few.mesh);
    Json json = mesh_json(surface);
    const std::vector<TickRecord>& rows = film_.rows();
    std::vector<std::array<float, 8>> poses;
    const std::size_t count = std::min(kBurrPoses, rows.size());
    poses.reserve(count);
    for (std::size_t n = 0; n < count; ++n) {
      const TickRecord& row = rows[(rows.size() - 1) * n / std::max<std::size_t>(count - 1, 1)];
      const double *p = row.tool_position_m, *q = row.tool_orientation;
      std::array<float, 8> pose{static_cast<float>(row.time_s)};
      for (std::size_t k = 0; k < 3; ++k) pose[1 + k] = static_cast<float>(p[k] / kMillimetre);
      for (std::size_t k = 0; k < 4; ++k) pose[4 + k] = static_cast<float>(q[(k + 1) % 4]);
      poses.push_back(pose);  // time, place, orientation (x, y, z, w)
    }
    json["poses"] = bytes_text(poses);
    return json;
  }

  RecordedFilm film_;
  const Assessment* assessment_;
  const AssessmentSettings& settings_;
  double rate_hz_;
  std::vector<RenderedBody> bodies_;  // before the first edit
  std::vector<Edit> edits_;
  std::optional<VoxelSet> target_;
  std::vector<std::size_t> ends_;  // of each moment, how many edits have been made by then
  std::vector<double> times_s_;
};

}  // namespace

nlohmann::ordered_json page_attempt(const RecordingReader& reader, const std::string& path,
                                    const Assessment* assessment,
                                    const AssessmentSettings& settings, std::size_t moments) {
  return AttemptMaker(reader, path, assessment, settings, moments).make();
}

}  // namespace sulcus
