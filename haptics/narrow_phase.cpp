#include "haptics/narrow_phase.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/recording/tick_record.hpp"

namespace sulcus {

namespace {

/// Voxel (i, j, k) of a leaf in field space: base + i x + j y + k z. The base is computed in double
/// per leaf, so that single precision spans 8 voxels only.
struct LeafFrame {
  Eigen::Vector3f base, x, y, z;
};

/// Distance to the burr, never too large: what a leaf may be passed over by. Outside its box the
/// field is the value at the nearest point of the box plus the way there. The burr lies aslant of
/// that way, so that the two are the legs of the distance, not its parts.
float least_distance(const DistanceField& field, const Eigen::Vector3f& p_field) {
  const Eigen::Vector3f last = (field.samples().array() - 1).cast<float>();
  const Eigen::Vector3f inside = p_field.cwiseMax(0.0f).cwiseMin(last);
  const float value = field.sample(inside);
  const float beyond = (p_field - inside).norm() * static_cast<float>(field.spacing_m());
  return value > 0.0f ? std::sqrt(value * value + beyond * beyond) : value;
}

bool deeper(const Contact& a, const Contact& b) {
  return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : a.voxel < b.voxel;
}

/// Keeps the `count` deepest contacts, in the order of their voxels so that sums do not depend on
/// how the library partitions.
void keep_deepest(std::vector<Contact>& contacts, std::size_t count) {
  const auto end = contacts.begin() + static_cast<std::ptrdiff_t>(count);
  std::nth_element(contacts.begin(), end, contacts.end(), deeper);
  contacts.resize(count);
  std::sort(contacts.begin(), contacts.end(),
            [](const Contact& a, const Contact& b) { return a.voxel < b.voxel; });
}

}  // namespace

void narrow_phase(const Workpiece& workpiece, const DistanceField& field,
                  const Pose& world_from_tool, double reach_m, ContactScratch& scratch,
                  ContactResult& result) noexcept {
  scratch.contacts.clear();
  const VoxelGrid& grid = workpiece.grid();
  const Eigen::Matrix3d tool_from_world =
      world_from_tool.orientation.conjugate().toRotationMatrix();
  // One voxel along each axis, in samples of the field.
  const Eigen::Matrix3d field_per_voxel = tool_from_world * (grid.voxel_m / field.spacing_m());
  const auto reach = static_cast<float>(reach_m);
  // Half the diagonal between the outermost voxel centres of a leaf; between samples the field may
  // rise by a little more than the way.
  const auto leaf_reach = static_cast<float>(reach_m + 3.5 * 1.7320508075688772 * grid.voxel_m +
                                             0.25 * field.spacing_m());

  LeafFrame frame;
  frame.x = field_per_voxel.col(0).cast<float>();
  frame.y = field_per_voxel.col(1).cast<float>();
  frame.z = field_per_voxel.col(2).cast<float>();
  for (const std::uint32_t leaf : scratch.leaves) {
    const Cell origin = grid.leaf_origin(leaf);
    const Eigen::Vector3d base = field.field_from_tool(
        tool_from_world * (grid.centre_world(origin) - world_from_tool.position));
    frame.base = base.cast<float>();
    const Eigen::Vector3f centre = frame.base + 3.5f * (frame.x + frame.y + frame.z);
    if (least_distance(field, centre) > leaf_reach) continue;

    const LeafBits& surface = workpiece.surface(leaf);
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector3f slice = frame.base + static_cast<float>(k) * frame.z;
      for (std::uint64_t rest = surface.words[k]; rest != 0; rest &= rest - 1) {
        const int bit = std::countr_zero(rest);
        const int i = bit & 7, j = bit >> 3;
        ++result.tested;
        const float distance_m =
            field.sample(slice + static_cast<float>(i) * frame.x + static_cast<float>(j) * frame.y);
        if (!(distance_m < reach)) continue;
        if (scratch.contacts.size() == scratch.contacts.capacity()) {
          keep_deepest(scratch.contacts, scratch.capacity);
          result.faults |= kFaultContactsFull;
        }
        Contact& contact = scratch.contacts.emplace_back();
        contact.cell = origin + Cell(i, j, k);
        contact.voxel = grid.linear(contact.cell);
        contact.distance_m = distance_m;
      }
    }
  }
  if (scratch.contacts.size() > scratch.capacity) {
    keep_deepest(scratch.contacts, scratch.capacity);
    result.faults |= kFaultContactsFull;
  }
}

}  // namespace sulcus
