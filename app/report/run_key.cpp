#include "app/report/run_key.hpp"

#include <array>

#include "engine/cache/hash128.hpp"

namespace sulcus {

namespace {

void add_contents(Hash128Stream& hash, const std::string& file) {
  hash.add(file.empty() ? std::optional<Hash128>() : hash_file(file));
}

void add_goal(Hash128Stream& hash, const VoxelModel& goal) {
  hash.add_bytes(goal.leaves.data(), goal.leaves.size() * sizeof(goal.leaves[0]));
}

void add_settings(Hash128Stream& hash, const AssessmentSettings& settings) {
  hash.add(settings.kind).add(settings.insertion).add(settings.mesial).add(settings.buccal);
  hash.add(settings.tolerance_mm).add(settings.voxel_mm);
  for (const MeasureLimit& limit : settings.limits) {
    hash.add(limit.name).add(limit.low).add(limit.high).add(limit.weight);
  }
}

void add_mesh(Hash128Stream& hash, const TriangleMesh& mesh) {
  hash.add(mesh.positions.size()).add(mesh.triangles.size());
  hash.add_bytes(mesh.positions.data(), mesh.positions.size() * sizeof(mesh.positions[0]));
  hash.add_bytes(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]));
}

}  // namespace

std::string key_of_run(const Simulation& simulation, const VoxelModel* goal, std::uint64_t ticks,
                       bool renders) {
  const Scene& scene = simulation.scene();
  Hash128Stream hash;
  hash.add("run").add(scene.text).add(ticks).add(renders);
  for (const Body& body : simulation.state().bodies) hash.add(body.solid.hash_with_tissues());
  if (goal) add_goal(hash, *goal);
  for (const std::string* file :
       {&scene.burr.file, &scene.trajectory.file, &scene.trajectory.recording}) {
    add_contents(hash, *file);
  }
  return hex(hash.result());
}

std::string key_of_recording(const RecordingReader& reader, RecordingUse use) {
  Hash128Stream hash;
  constexpr std::array kUses{"replay", "view", "assess"};
  hash.add(kUses[static_cast<std::size_t>(use)]);
  const RecordingHeader& header = reader.header();
  hash.add(header.scene_toml).add(header.workpiece_hash).add(header.parent);
  constexpr std::size_t kRowsAtOnce = 4096;
  for (std::size_t first = 0; first < reader.tick_count(); first += kRowsAtOnce) {
    for (const TickRecord& row : reader.ticks(first, kRowsAtOnce)) hash.add(row.check);
  }
  return hex(hash.result());
}

std::string key_of_assessment(const RecordingReader& reader, const AssessmentSettings& settings) {
  Hash128Stream hash;
  hash.add(key_of_recording(reader, RecordingUse::kAssess));
  if (const auto goal = reader.goal()) add_goal(hash, *goal);
  add_settings(hash, settings);
  return hex(hash.result());
}

std::string key_of_assessment(const ScannedTooth& tooth, const AssessmentSettings& settings) {
  Hash128Stream hash;
  hash.add("assess a pair");
  add_mesh(hash, tooth.before.mesh);
  add_mesh(hash, tooth.after.mesh);
  if (tooth.plan) add_mesh(hash, tooth.plan->mesh);
  add_settings(hash, settings);
  return hex(hash.result());
}

std::string key_of_assessments(std::span<const std::string> keys) {
  if (keys.size() == 1) return keys.front();
  Hash128Stream hash;
  hash.add("assess side by side");
  for (const std::string& key : keys) hash.add(key);
  return hex(hash.result());
}

}  // namespace sulcus
