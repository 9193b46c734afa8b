#include "app/report/run_key.hpp"

#include "engine/cache/hash128.hpp"

namespace sulcus {

namespace {

void add_contents(Hash128Stream& hash, const std::string& file) {
  hash.add(file.empty() ? std::optional<Hash128>() : hash_file(file));
}

}  // namespace

std::string key_of_run(const Simulation& simulation, const VoxelModel* goal, std::uint64_t ticks,
                       bool renders) {
  const Scene& scene = simulation.scene();
  Hash128Stream hash;
  hash.add("run").add(scene.text).add(ticks).add(renders);
  for (const Body& body : simulation.state().bodies) hash.add(body.solid.hash_with_tissues());
  if (goal) hash.add_bytes(goal->leaves.data(), goal->leaves.size() * sizeof(goal->leaves[0]));
  for (const std::string* file :
       {&scene.burr.file, &scene.trajectory.file, &scene.trajectory.recording}) {
    add_contents(hash, *file);
  }
  return hex(hash.result());
}

std::string key_of_recording(const RecordingReader& reader, RecordingUse use) {
  Hash128Stream hash;
  hash.add(use == RecordingUse::kReplay ? "replay" : "view");
  const RecordingHeader& header = reader.header();
  hash.add(header.scene_toml).add(header.workpiece_hash).add(header.parent);
  constexpr std::size_t kRowsAtOnce = 4096;
  for (std::size_t first = 0; first < reader.tick_count(); first += kRowsAtOnce) {
    for (const TickRecord& row : reader.ticks(first, kRowsAtOnce)) hash.add(row.check);
  }
  return hex(hash.result());
}

}  // namespace sulcus
