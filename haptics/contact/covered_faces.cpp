#include "haptics/contact/covered_faces.hpp"

#include <algorithm>

#include "haptics/contact/far_fills.hpp"

namespace sulcus {

namespace {

using Eigen::Vector3f;

/// Whether a point of the world lies in the solid of a body near, other than its own.
bool is_covered(const Body& body, std::span<const NearBody> near, const Eigen::Vector3d& p_world) {
  return std::ranges::any_of(near, [&](const NearBody& other) {
    if (other.body == &body || !other.body->solid_bounds_world.contains(p_world)) return false;
    const Workpiece& solid = other.body->solid;
    const Eigen::Vector3d p_index =
        solid.grid().index_from_world(other.body->world_from_grid.inverse_point(p_world));
    const Cell cell = p_index.array().round().cast<int>();
    return solid.grid().contains(cell) && solid.solid(cell);
  });
}

/// The empty sides of a voxel: sums of their directions, of those in another solid, and of those
/// that are not.
struct Sides {
  Vector3f covered = Vector3f::Zero(), open = Vector3f::Zero();
  bool any_covered = false, any_open = false;
};
Sides sides_of(const Body& body, std::span<const NearBody> near, const Cell& voxel) {
  Sides sides;
  const VoxelGrid& grid = body.solid.grid();
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sign : {-1, 1}) {
      const Cell step = sign * Cell::Unit(axis), beside = voxel + step;
      if (grid.contains(beside) && body.solid.solid(beside)) continue;
      const bool covered =
          is_covered(body, near, body.world_from_grid.point(grid.centre_world(beside)));
      (covered ? sides.covered : sides.open) += step.cast<float>();
      (covered ? sides.any_covered : sides.any_open) = true;
    }
  }
  return sides;
}

/// The normal of what is open of a voxel's surface.
Vector3f open_normal(const Vector3f& normal, const Sides& sides) {
  constexpr float kLeast = 0.3f;  // of the normal, along what is open
  if (normal.isZero(0.0f)) return normal;
  Vector3f rest = normal;
  for (int a = 0; a < 3; ++a) {
    if (sides.covered[a] * rest[a] > 0.0f) rest[a] = 0.0f;
  }
  if (rest.norm() < kLeast) rest = sides.open;
  const float length = rest.norm();
  return length > 0.0f ? Vector3f(rest / length) : Vector3f::Zero();
}

}  // namespace

void drop_covered(const Body& body, std::span<const NearBody> near, std::size_t first,
                  ContactScratch& scratch) noexcept {
  if (near.size() < 2) return;
  Contacts& contacts = scratch.contacts;
  const VoxelGrid& grid = body.solid.grid();
  const double voxel_m = grid.voxel_m;
  Eigen::AlignedBox3d others;
  for (const NearBody& other : near) {
    if (other.body != &body) others.extend(other.body->solid_bounds_world);
  }
  others.min().array() -= voxel_m;
  others.max().array() += voxel_m;
  std::size_t kept = first;
  for (std::size_t i = first; i < contacts.size(); ++i) {
    const Cell voxel = cell_of_key(contacts.keys()[i]);
    if (others.contains(body.world_from_grid.point(grid.centre_world(voxel)))) {
      const Sides sides = sides_of(body, near, voxel);
      if (sides.any_covered && !sides.any_open) continue;
      if (sides.any_covered) {
        const Vector3f before = contacts.vector(Contacts::kNormal, i);
        const Vector3f normal = open_normal(before, sides);
        contacts.set_vector(Contacts::kNormal, i, normal);
        constexpr float kSame = 0.9f;  // cosine
        if (normal.dot(before) < kSame) {
          scratch.block(ContactBlock::kOffset)[i - scratch.block.first()] =
              0.5f * static_cast<float>(voxel_m) * normal.cwiseAbs().maxCoeff();
        }
      }
    }
    move_contact(scratch, i, kept++);
  }
  contacts.resize(kept);
  scratch.block.set_end(kept);
}

}  // namespace sulcus
