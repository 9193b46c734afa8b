#include "haptics/neighbour.hpp"

#include <array>
#include <utility>

#include "engine/core/hash.hpp"
#include "haptics/evaluate_contact.hpp"
#include "haptics/state_fields.hpp"

namespace sulcus {

Neighbour::Neighbour(const Scene& scene, const BodySettings& settings, VoxelModel start)
    : world_from_grid(settings.world_from_grid),
      first_tissue(settings.tissue.value_or(0)),
      solid(std::move(start)) {
  if (keeps_normals(scene.haptics)) kept.emplace(solid.grid(), scene.haptics);
  if (scene.cutting && settings.cuttable) removal.emplace(*scene.cutting);
}

std::vector<Neighbour> make_neighbours(const Scene& scene, std::vector<VoxelModel> starts) {
  std::vector<Neighbour> neighbours;
  neighbours.reserve(starts.size());
  for (std::size_t i = 0; i < starts.size(); ++i) {
    neighbours.emplace_back(scene, scene.bodies[i], std::move(starts[i]));
  }
  return neighbours;
}

std::uint64_t Neighbour::hash() const {
  std::array<std::uint64_t, 4> parts{solid.hash()};
  if (kept) parts[1] = kept->hash();
  if (removal) parts[2] = removal->hash();
  parts[3] = fields::hash_of([this](auto& archive) { fields::damage(archive, *this); });
  return hash_bytes(parts.data(), sizeof(parts));
}

namespace {

/// A quantity of the grid's space in world axes.
Wrench turned(const Wrench& wrench, const Pose& world_from_grid) {
  return {world_from_grid.direction(wrench.force_N), world_from_grid.direction(wrench.torque_Nm)};
}

Matrix6d turned(const Matrix6d& stiffness, const Pose& world_from_grid) {
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = world_from_grid.orientation.toRotationMatrix();
  turn.bottomRightCorner<3, 3>() = turn.topLeftCorner<3, 3>();
  return turn * stiffness * turn.transpose();
}

}  // namespace

ContactResult evaluate_neighbour(const Neighbour& neighbour,
                                 std::span<const TissueSettings> tissues, const Burr& burr,
                                 const Pose& world_from_tool, const Twist* twist_world,
                                 const HapticsSettings& settings, ContactScratch& scratch,
                                 Asked asked) noexcept {
  const Pose& place = neighbour.world_from_grid;
  Twist twist;
  // What holds against everything is not rubbed at either.
  const bool rubbed = twist_world && neighbour.removal;
  if (rubbed) {
    twist = {place.inverse_direction(twist_world->linear_m_per_s),
             place.inverse_direction(twist_world->angular_rad_per_s),
             twist_world->spindle_rad_per_s};
  }
  ContactResult result =
      evaluate_contact(neighbour.solid, tissues.subspan(neighbour.first_tissue), burr,
                       inverse(place) * world_from_tool, rubbed ? &twist : nullptr, settings,
                       neighbour.kept ? &*neighbour.kept : nullptr, scratch, asked);
  result.wrench = turned(result.wrench, place);
  result.tangential = turned(result.tangential, place);
  if (asked != Asked::kForce) result.stiffness = turned(result.stiffness, place);
  return result;
}

void add(ContactResult& sum, const ContactResult& other) noexcept {
  sum.wrench.force_N += other.wrench.force_N;
  sum.wrench.torque_Nm += other.wrench.torque_Nm;
  sum.tangential.force_N += other.tangential.force_N;
  sum.tangential.torque_Nm += other.tangential.torque_Nm;
  sum.stiffness += other.stiffness;
  sum.contacts += other.contacts;
  sum.tested += other.tested;
  sum.leaves += other.leaves;
  sum.faults |= other.faults;
}

}  // namespace sulcus
