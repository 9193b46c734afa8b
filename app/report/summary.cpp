#include "app/report/summary.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "app/build_info.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/core/hash.hpp"
#include "engine/core/instruction_set.hpp"
#include "engine/core/realtime.hpp"
#include "engine/core/units.hpp"

namespace sulcus {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kCubicMillimetre = kMillimetre * kMillimetre * kMillimetre;  // m^3

double mebibytes(std::size_t bytes) { return static_cast<double>(bytes) / kMebibyte; }

/// What each tissue takes up: solid voxels, by what of each is filled.
std::vector<double> tissue_voxels(const VoxelModel& model, std::size_t tissues) {
  std::vector<std::uint64_t> levels(tissues);
  for (std::uint32_t leaf = 0; leaf < model.leaves.size(); ++leaf) {
    const LabelBlock* block = model.tissues ? model.tissues->block(leaf) : nullptr;
    const FillLevel* page = model.fills ? model.fills->page(leaf) : nullptr;
    const std::uint8_t label = model.tissues ? model.tissues->uniform_label(leaf) : std::uint8_t{0};
    const LeafBits& solid = model.leaves[leaf];
    if (block || page) {
      for_each_voxel(solid, [&](int place) {
        levels[block ? (*block)[place] : label] += page ? page[place] : kFullLevel;
      });
    } else if (any(solid)) {
      levels[label] += std::uint64_t{kFullLevel} * static_cast<std::uint64_t>(count_voxels(solid));
    }
  }
  std::vector<double> voxels;
  voxels.reserve(levels.size());
  for (const std::uint64_t sum : levels) voxels.push_back(static_cast<double>(sum) / kFullLevel);
  return voxels;
}

Json tissue_mm3_json(const Simulation& simulation, std::span<const double> voxels) {
  const auto& tissues = simulation.scene().tissues;
  const double voxel_m3 = simulation.workpiece().grid().voxel_volume_m3();
  Json by_tissue = Json::object();
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    by_tissue[tissues[t].name] = voxels[t] * voxel_m3 / kCubicMillimetre;
  }
  return by_tissue;
}

/// As it was before the first tick of all: what is left and what went.
Json start_json(const Simulation& simulation, const std::optional<OutcomeResult>& outcome) {
  const Workpiece& w = simulation.workpiece();
  std::vector<double> voxels = tissue_voxels(w.model(), simulation.scene().tissues.size());
  std::uint64_t solid = w.solid_voxels();
  for (std::size_t t = 0; outcome && t < voxels.size(); ++t) {
    for (const EditCause cause : {EditCause::kCut, EditCause::kLoose}) {
      voxels[t] += outcome->progress.removed_volume(cause, t);
      solid += outcome->progress.removed_voxels(cause, t);
    }
  }
  return {{"solid_voxels", solid}, {"tissue_mm3", tissue_mm3_json(simulation, voxels)}};
}

Json workpiece_json(const Simulation& simulation) {
  const Workpiece& w = simulation.workpiece();
  const VoxelGrid& grid = w.grid();
  const std::vector<double> voxels = tissue_voxels(w.model(), simulation.scene().tissues.size());
  return {{"cells", {grid.cells.x(), grid.cells.y(), grid.cells.z()}},
          {"voxel_mm", grid.voxel_m / kMillimetre},
          {"solid_voxels", w.solid_voxels()},
          {"surface_voxels", w.surface_voxels()},
          {"tissue_mm3", tissue_mm3_json(simulation, voxels)}};
}

Json times_json(const Distribution& us) {
  return {{"mean", us.mean()},
          {"p50", us.quantile(0.5)},
          {"p99", us.quantile(0.99)},
          {"p999", us.quantile(0.999)},
          {"max", us.largest()}};
}

/// mm^3 of each tissue that were cut off a body; the voxels' label 0 is the first of them. With
/// fractions what is gone is what was paid for, level by level.
Json removed_json(const Body& body, std::span<const TissueSettings> tissues) {
  Json removed = Json::object();
  const std::optional<RemovalState>& removal = body.removal;
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    double removed_m3 = 0.0;
    if (removal && body.solid.has_fills()) {
      removed_m3 = removal->by_tissue[t].removed_J / tissues[t].specific_energy_J_per_m3;
    } else if (removal) {
      const double voxel_m3 = body.solid.grid().voxel_volume_m3();
      removed_m3 = static_cast<double>(removal->removed_voxels[t]) * voxel_m3;
    }
    removed[tissues[t].name] = removed_m3 / kCubicMillimetre;
  }
  return removed;
}

/// Where the work on each tissue has gone.
Json tissue_energy_json(const Body& body, std::span<const TissueSettings> tissues) {
  Json energies = Json::object();
  const std::array<double, 256> stored_J = body.removal->stored_by_tissue_J(body.solid);
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    const TissueEnergy& energy = body.removal->by_tissue[t];
    energies[tissues[t].name] = {{"work", energy.work_J},
                                 {"removed", energy.removed_J},
                                 {"stored", stored_J[t]},
                                 {"heat", energy.heat_J}};
  }
  return energies;
}

/// What was done to the bodies besides the workpiece.
Json bodies_json(const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  Json bodies = Json::array();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = simulation.state().others()[i];
    const std::span tissues = std::span(scene.tissues).subspan(body.first_tissue);
    const std::size_t count = scene.bodies[i].tissue ? 1 : tissues.size();
    Json j{{"name", scene.bodies[i].name},
           {"solid_voxels", body.solid.solid_voxels()},
           {"contact_s", static_cast<double>(body.touched_ticks) / scene.haptics.rate_hz},
           {"peak_force_N", body.peak_force_N},
           {"removed_mm3", removed_json(body, tissues.first(count))}};
    if (body.removal) j["tissue_energy_J"] = tissue_energy_json(body, tissues.first(count));
    j["volume_hash"] = hex(body.solid.hash());
    bodies.push_back(std::move(j));
  }
  return bodies;
}

/// Of all bodies.
void add_energies(const SimulationState& state, Json& j) {
  double removed_J = 0.0, stored_J = 0.0, heat_J = 0.0;
  for (const Body& body : state.bodies) {
    if (!body.removal) continue;
    removed_J += body.removal->removed_J;
    stored_J += body.removal->stored_J();
    heat_J += body.removal->heat_J;
  }
  j["tangential_work_J"] = state.work_J();
  j["removed_energy_J"] = removed_J;
  j["stored_energy_J"] = stored_J;
  j["heat_J"] = heat_J;
}

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

double voxel_mm3_of(const Scene& scene) {
  const double voxel_m = scene.workpiece.voxel_m;
  return voxel_m * voxel_m * voxel_m / kCubicMillimetre;
}

Json reach_json(const Reach& reach) {
  return {{"p95", reach.p95_m / kMillimetre}, {"max", reach.max_m / kMillimetre}};
}

}  // namespace

nlohmann::ordered_json outcome_json(const Scene& scene, const OutcomeResult& outcome) {
  const double voxel_mm3 = voxel_mm3_of(scene);
  const auto mm3 = [&](double voxels) { return voxels * voxel_mm3; };
  const auto seconds = [&](std::uint64_t tick) {
    return Json(static_cast<double>(tick) / scene.haptics.rate_hz);
  };
  const PreparationProgress& progress = outcome.progress;
  Json j;
  for (const auto& [name, cause] :
       {std::pair{"cut", EditCause::kCut}, std::pair{"loose", EditCause::kLoose}}) {
    for (std::size_t t = 0; t < scene.tissues.size(); ++t) {
      j["removed_mm3"][name][scene.tissues[t].name] = mm3(progress.removed_volume(cause, t));
    }
  }
  if (const auto left = progress.caries_left()) j["caries_left_mm3"] = mm3(*left);
  if (progress.has_pulp()) {
    const std::optional<std::uint64_t> tick = progress.pulp_exposed_tick();
    j["pulp_exposed_tick"] = tick ? Json(*tick) : Json(nullptr);
    j["pulp_exposed_s"] = tick ? seconds(*tick) : Json(nullptr);
    j["pulp_removed_mm3"] = mm3(progress.pulp_removed());
    std::optional<double> wall_mm = progress.wall_over_pulp_m();
    if (wall_mm) *wall_mm /= kMillimetre;
    j["dentine_over_pulp_mm"] = or_null(wall_mm);
    if (const auto& least_m = scene.least_pulp_distance_m) {
      const std::optional<std::uint64_t> near = progress.pulp_near_tick();
      j["pulp_distance"] = {{"wanted_mm", *least_m / kMillimetre},
                            {"kept", !near},
                            {"nearer_s", near ? seconds(*near) : Json(nullptr)}};
    }
  }
  j["peak_force_N"] = outcome.measures.peak_force_N;
  j["mean_force_N"] = outcome.measures.mean_force_in_contact_N();
  j["contact_s"] = static_cast<double>(outcome.measures.ticks_in_contact) / scene.haptics.rate_hz;
  return j;
}

nlohmann::ordered_json goal_json(const Scene& scene, const GoalFigures& goal) {
  const double voxel_mm3 = voxel_mm3_of(scene);
  return {{"target_mm3", goal.target_volume * voxel_mm3},
          {"dice", goal.dice},
          {"excess_mm3", goal.excess_volume * voxel_mm3},
          {"missing_mm3", goal.missing_volume * voxel_mm3},
          {"excess_beyond_mm", reach_json(goal.excess)},
          {"missing_within_mm", goal.missing ? reach_json(*goal.missing) : Json(nullptr)}};
}

namespace {

/// How warm the tooth became.
Json heat_json(const HeatResult& heat) {
  Json j{{"cell_mm", heat.cell_m / kMillimetre}, {"given_J", heat.given_J}, {"pulp", nullptr}};
  if (!heat.pulp) return j;
  const Eigen::Vector3d at_mm = heat.pulp->greatest_rise_world / kMillimetre;
  j["pulp"] = {{"greatest_rise_K", heat.pulp->greatest_rise_K},
               {"greatest_rise_s", heat.pulp->greatest_rise_s},
               {"greatest_rise_mm", {at_mm.x(), at_mm.y(), at_mm.z()}},
               {"limit_K", kPulpLimit_K},
               {"over_limit_s", heat.pulp->over_limit_s},
               {"end_change_K", heat.pulp->end_change_K()}};
  return j;
}

/// From what a run goes on, and where.
Json parent_json(const EarlierRun& earlier, std::uint64_t first_tick, double rate_hz) {
  return {{"recording", earlier.recording},
          {"scene_sha256", earlier.scene_sha256},
          {"after_tick", first_tick - 1},
          {"after_s", static_cast<double>(first_tick - 1) / rate_hz}};
}

/// What went through the device's port, and what a scene names of it.
void add_port(const Scene& scene, const DevicePortState& port, const RunStatistics& s, Json& j) {
  const double ticks = std::max<double>(1.0, static_cast<double>(s.ticks));
  const PassivityState& passivity = port.passivity;
  j["passivity"] = {{"least_J", passivity.least_J}, {"given_out_J", passivity.given_out_J()}};
  if (scene.coupling) {
    j["coupling"] = {
        {"stiffness_N_per_mm", scene.coupling->stiffness_N_per_m / kNewtonPerMillimetre},
        {"evaluations", {{"mean", s.evaluations_sum / ticks}, {"max", s.evaluations_max}}}};
  }
  if (scene.device || scene.coupling) {
    j["asked_force_N"] = {{"mean", s.commanded_force_sum_N / ticks},
                          {"max", s.commanded_force_max_N}};
    j["asked_force_step_N"] = {{"max", s.commanded_step_max_N}};
    j["buzz_ticks"] = s.fault_ticks(kFaultBuzz);
  }
  if (!scene.device) return;
  if (scene.device->passivity_controller) {
    j["passivity"]["controller"] = {{"dissipated_J", passivity.dissipated_J},
                                    {"ticks", passivity.damped_ticks}};
  }
  j["device"] = {{"clamped_ticks", port.limiter.clamped_ticks},
                 {"step_limited_ticks", port.limiter.step_limited_ticks},
                 {"ramped_ticks", port.limiter.ramped_ticks},
                 {"silent_ticks", s.fault_ticks(kFaultDeviceSilent)},
                 {"bridged_ticks", s.fault_ticks(kFaultPoseBridged)},
                 {"jumped_ticks", s.fault_ticks(kFaultDeviceJumped)}};
  if (scene.device->plugin) j["device"]["plugin"] = scene.device->plugin->name;
}

Json faults_json(const RunStatistics& statistics, std::uint64_t dropped_rows) {
  Json faults = Json::object();
  for (const FaultInfo& fault : kFaults) {
    const std::uint64_t ticks = statistics.fault_ticks(fault.bit);
    if (ticks > 0) faults[std::string(fault.name)] = ticks;
  }
  if (dropped_rows > 0) faults["rows_dropped"] = dropped_rows;
  return faults;
}

/// All parts of the program that ran, in the order in which they are listed.
std::vector<PartUse> all_parts(const Simulation& simulation, const SessionResult& result,
                               const std::vector<PartUse>& loading) {
  const RunStatistics& s = result.statistics;
  std::vector<PartUse> parts = loading;
  parts.push_back({"contact", 1e-6 * s.tick_us.sum(), simulation.contact_bytes()});
  if (simulation.scene().cutting) {
    const auto& us = s.stage_us[static_cast<int>(Stage::kRemoval)];
    parts.push_back({"cutting", 1e-6 * us.sum(), simulation.cutting_bytes()});
  }
  parts.insert(parts.end(), result.parts.begin(), result.parts.end());
  return parts;
}

Json parts_json(const std::vector<PartUse>& parts) {
  Json uses = Json::array();
  for (const PartUse& part : parts) {
    Json use{{"name", part.name}, {"time_s", part.seconds}, {"memory_MiB", mebibytes(part.bytes)}};
    if (part.cached) use["cached"] = *part.cached;
    uses.push_back(std::move(use));
  }
  return uses;
}

Json memory_json(const std::vector<PartUse>& parts) {
  Json memory = Json::object();
  for (const PartUse& part : parts) memory[part.name] = mebibytes(part.bytes);
  memory["peak_rss"] = mebibytes(peak_resident_bytes());
  return memory;
}

/// How long ticks and their stages took, and how late they were.
void add_times(const Scene& scene, const SessionResult& result, Json& j) {
  const RunStatistics& s = result.statistics;
  j["tick_us"] = times_json(s.tick_us);
  j["stage_us"] = Json::object();
  for (int stage = 0; stage < kStageCount; ++stage) {
    if (Stage(stage) == Stage::kRemoval && !scene.cutting) continue;  // was not there
    j["stage_us"][kStageNames[stage]] = {{"mean", s.stage_us[stage].mean()},
                                         {"p99", s.stage_us[stage].quantile(0.99)}};
  }
  j["late_us"] = {{"p50", s.late_us.quantile(0.5)},
                  {"p99", s.late_us.quantile(0.99)},
                  {"max", s.late_us.largest()}};
  j["missed_ticks"] = result.missed_ticks;
  j["realtime_refused"] = result.refused;
}

void add_contact(const RunStatistics& s, Json& j) {
  const double ticks = std::max<double>(1.0, static_cast<double>(s.ticks));
  j["leaves_in_contact"] = {{"mean", s.leaves_sum / ticks}, {"max", s.leaves_max}};
  j["voxels_tested"] = {{"mean", s.tested_sum / ticks}, {"max", s.tested_max}};
  j["voxels_in_contact"] = {{"mean", s.contacts_sum / ticks}, {"max", s.contacts_max}};
  const double in_contact = std::max<double>(1.0, static_cast<double>(s.ticks_in_contact));
  j["force_N"] = {{"mean", s.force_N.mean()},
                  {"mean_in_contact", s.force_in_contact_sum_N / in_contact},
                  {"max", s.force_N.largest()}};
  j["force_step_N"] = {{"max", s.force_step_max_N}};
  j["torque_mNm"] = {{"mean", s.torque_mNm.mean()}, {"max", s.torque_mNm.largest()}};
}

}  // namespace

nlohmann::ordered_json make_summary(const Simulation& simulation, const SessionResult& result,
                                    const SessionOptions& options,
                                    const std::vector<PartUse>& loading) {
  const Scene& scene = simulation.scene();
  const RunStatistics& s = result.statistics;
  const std::vector<PartUse> parts = all_parts(simulation, result, loading);
  Json j;
  j["scene"] = scene.title;
  j["scene_sha256"] = sha256_hex(scene.text);
  j["build"] = build_info();
  j["instructions"] = instruction_set_name();
  j["pace"] = options.pace == Pace::kReal ? "real" : "fast";
  if (options.earlier) {
    const std::uint64_t first_tick = simulation.state().tick - s.ticks;
    j["parent"] = parent_json(*options.earlier, first_tick, scene.haptics.rate_hz);
  }
  j["ticks"] = s.ticks;
  j["interrupted"] = result.interrupted;
  j["load_s"] = result.load_seconds;
  j["wall_s"] = result.wall_seconds;
  j["frames"] = result.frames;
  j["parts"] = parts_json(parts);
  j["workpiece"] = workpiece_json(simulation);
  j["workpiece_start"] = start_json(simulation, result.outcome);
  add_times(scene, result, j);
  add_contact(s, j);
  j["removed_voxels"] = s.removed;
  j["removed_mm3"] = simulation.workpiece().has_fills() && result.outcome
                         ? outcome_json(scene, *result.outcome)["removed_mm3"]["cut"]
                         : removed_json(simulation.state().workpiece(), scene.tissues);
  if (const Body& body = simulation.state().workpiece(); body.removal) {
    j["tissue_energy_J"] = tissue_energy_json(body, scene.tissues);
  }
  add_energies(simulation.state(), j);
  if (!scene.bodies.empty()) j["bodies"] = bodies_json(simulation);
  add_port(scene, simulation.state().port, s, j);
  j["fragments"] = result.pieces;
  if (result.outcome) {
    j["outcome"] = outcome_json(scene, *result.outcome);
    if (result.outcome->goal) j["goal"] = goal_json(scene, *result.outcome->goal);
  }
  if (result.part) {
    j["since_fork"] = {{"ticks", s.ticks}, {"outcome", outcome_json(scene, *result.part)}};
  }
  if (result.stream) {
    j["stream"] = {{"clients", result.stream->clients},
                   {"samples", result.stream->samples},
                   {"dropped", result.stream->dropped}};
  }
  if (result.heat) j["heat"] = heat_json(*result.heat);
  j["memory_MiB"] = memory_json(parts);
  j["volume_hash"] = hex(simulation.workpiece().hash());
  j["force_hash"] = hex(s.force_hash);
  j["faults"] = faults_json(s, result.dropped_rows);
  return j;
}

}  // namespace sulcus
