#include "haptics/c/scene_run.hpp"

#include <array>
#include <utility>

#include "haptics/force_hash.hpp"

namespace sulcus {

namespace {

/// A hand of the caller's.
class GivenPose final : public Device {
 public:
  explicit GivenPose(const Pose& pose) : pose_(pose) {}
  std::optional<Pose> pose(std::uint64_t) noexcept override { return pose_; }
  void apply(const Wrench&) noexcept override {}

 private:
  const Pose& pose_;
};

std::vector<Workpiece> workpieces(SceneParts& parts) {
  std::vector<Workpiece> all;
  all.reserve(1 + parts.bodies.size());
  all.emplace_back(std::move(parts.workpiece));
  for (VoxelModel& body : parts.bodies) all.emplace_back(std::move(body));
  return all;
}

/// Of a scene's text and of what its files gave: burr, trajectory and all voxels.
std::uint64_t hash_of_start(const Scene& scene, const Burr& burr, const Trajectory& trajectory,
                            const SimulationState& state) {
  std::uint64_t hash = hash_bytes(scene.text.data(), scene.text.size());
  const std::span<const float> field = burr.field.values();
  hash = hash_bytes(field.data(), field.size_bytes(), hash);
  for (const auto& [time_s, pose] : trajectory.poses()) {
    const Eigen::Vector3d& p = pose.position;
    const Eigen::Vector4d& q = pose.orientation.coeffs();
    const std::array numbers{time_s, p.x(), p.y(), p.z(), q[0], q[1], q[2], q[3]};
    hash = hash_bytes(numbers.data(), sizeof numbers, hash);
  }
  for (const Body& body : state.bodies) {
    const std::uint64_t solid = body.solid.hash_with_tissues();
    hash = hash_bytes(&solid, sizeof solid, hash);
  }
  return hash;
}

}  // namespace

SceneRun::SceneRun(Scene scene, SceneParts parts)
    : scene_(std::move(scene)),
      burr_(std::move(parts.burr)),
      trajectory_(std::move(parts.trajectory)),
      state_(initial_state(scene_, workpieces(parts), trajectory_.pose_at(0.0))),
      scratch_(scene_),
      context_{scene_, burr_},
      start_hash_(hash_of_start(scene_, burr_, trajectory_, state_)) {
  if (scene_.loose_pieces) finder_.emplace(workpiece().model());
  if (!scene_.device) {
    scripted_.emplace(trajectory_, scene_.haptics.rate_hz);
  } else if (!scene_.device->plugin && !scene_.device->played_back) {
    simulated_.emplace(*scene_.device, trajectory_, scene_.haptics.rate_hz,
                       scene_.burr.reference_m);
  }
}

const TickResult& SceneRun::step(const Pose& pose) {
  GivenPose hand(pose);
  return tick_with(hand);
}

const TickResult& SceneRun::step_scene() {
  if (simulated_) return tick_with(*simulated_);
  return tick_with(*scripted_);
}

const TickResult& SceneRun::tick_with(Device& device) {
  std::span<const std::uint32_t> loose;
  if (finder_) {
    loose = loose_.before_tick(state_.tick, [&](LooseAnswer& answer) {
      if (answers_.empty()) return false;
      answer = std::move(answers_.front());
      answers_.pop_front();
      return true;
    });
  }
  last_ = tick(context_, device, state_, scratch_, loose);
  double force_N[3], torque_Nm[3];
  for (int axis = 0; axis < 3; ++axis) {
    force_N[axis] = last_.sent.force_N[axis];
    torque_Nm[axis] = last_.sent.torque_Nm[axis];
  }
  force_hash_ = force_hash_after(force_hash_, force_N, torque_Nm);
  edits_.add(scratch_.edits);
  if (finder_) look_for_pieces(last_.tick);
  return last_;
}

/// As a thread of the program does beside the ticks; here the tick itself waits for it.
void SceneRun::look_for_pieces(std::uint64_t tick) {
  if (std::optional<LooseAnswer> answer = finder_->add_tick(tick, scratch_.edits)) {
    answers_.push_back(std::move(*answer));
  }
}

FeltContact SceneRun::felt(const Contact& contact, std::size_t body) const noexcept {
  const Body& of = state_.bodies[body];
  FeltContact felt;
  felt.position_world = of.world_from_grid.point(of.solid.grid().centre_world(contact.cell));
  felt.normal_world = of.world_from_grid.orientation.cast<float>() * contact.normal;
  felt.depth_m = contact.depth_m;
  felt.force_N = contact.normal_force_N;
  felt.voxel = of.solid.grid().linear(contact.cell);
  felt.body = static_cast<std::uint16_t>(body);
  felt.tissue = static_cast<std::uint8_t>(of.first_tissue + contact.tissue);
  return felt;
}

void write_bits(const VoxelModel& model, std::span<std::uint8_t> bits) noexcept {
  const Eigen::Vector3i cells = model.grid.cells;
  const std::size_t row = static_cast<std::size_t>(cells.x()) / kLeafEdge;
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    const Cell first = model.grid.leaf_origin(leaf);
    for (int z = 0; z < kLeafEdge; ++z) {
      for (int y = 0; y < kLeafEdge; ++y) {
        const std::size_t line = static_cast<std::size_t>(first.y() + y) +
                                 static_cast<std::size_t>(cells.y()) * (first.z() + z);
        bits[static_cast<std::size_t>(first.x()) / kLeafEdge + row * line] =
            static_cast<std::uint8_t>(model.leaves[leaf].words[z] >> (8 * y));
      }
    }
  }
}

}  // namespace sulcus
