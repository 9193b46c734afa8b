#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/pose.hpp"
#include "engine/scene/scene.hpp"
#include "engine/tool/burr.hpp"
#include "engine/volume/workpiece.hpp"
#include "haptics/contact.hpp"
#include "haptics/kept_normals.hpp"
#include "haptics/removal.hpp"

namespace sulcus {

/// Another body of the scene, a neighbouring tooth or a jaw: voxels in a grid of their own, which
/// stays where it is. Like the workpiece it is felt and, where the scene says so, cut; of what it
/// has suffered a little is counted.
struct Neighbour {
  /// `start` as build_bodies makes it.
  Neighbour(const Scene& scene, const BodySettings& settings, VoxelModel start);

  Pose world_from_grid;
  std::size_t first_tissue;  // of the scene's, that its label 0 is
  Workpiece solid;
  std::optional<KeptNormals> kept;      // as SimulationState::kept
  std::optional<RemovalState> removal;  // of one that can be cut
  // Damage, which no later tick depends on.
  std::uint64_t touched_ticks = 0;
  double peak_force_N = 0.0;

  /// With all of it, the voxels too.
  std::uint64_t hash() const;
};

/// One for each [[body]] of a scene, `starts` in its order.
std::vector<Neighbour> make_neighbours(const Scene& scene, std::vector<VoxelModel> starts);

/// evaluate_contact with a neighbour, in its grid's space; wrench, tangential part and stiffness
/// come out in world axes. Its forces are those of a body of its own: under `count` and `smooth` a
/// contact's stiffness is its share of this body's contacts, so that two bodies hold as two.
ContactResult evaluate_neighbour(const Neighbour& neighbour,
                                 std::span<const TissueSettings> tissues, const Burr& burr,
                                 const Pose& world_from_tool, const Twist* twist_world,
                                 const HapticsSettings& settings, ContactScratch& scratch,
                                 Asked asked) noexcept;

/// What two bodies do to the tool together.
void add(ContactResult& sum, const ContactResult& other) noexcept;

}  // namespace sulcus
