#include "engine/bodies/body_tree.hpp"

#include <algorithm>

#include <BulletCollision/BroadphaseCollision/btDbvt.h>

namespace sulcus {

namespace {

btVector3 bullet_vector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

btDbvtVolume bullet_volume(const Eigen::AlignedBox3d& box) {
  return btDbvtVolume::FromMM(bullet_vector(box.min()), bullet_vector(box.max()));
}

/// Collects the numbers of the leaves that a query meets.
struct Collector : btDbvt::ICollide {
  explicit Collector(std::span<std::uint16_t> out) : found(out) {}
  void Process(const btDbvtNode* leaf) override {
    if (count < found.size()) found[count++] = static_cast<std::uint16_t>(leaf->dataAsInt);
  }
  std::span<std::uint16_t> found;
  std::size_t count = 0;
};

}  // namespace

struct BodyTree::Tree {
  btDbvt dbvt;
};

BodyTree::BodyTree(std::span<const Eigen::AlignedBox3d> boxes_world)
    : tree_(std::make_unique<Tree>()) {
  for (std::size_t i = 0; i < boxes_world.size(); ++i) {
    btDbvtNode* leaf = tree_->dbvt.insert(bullet_volume(boxes_world[i]), nullptr);
    leaf->dataAsInt = static_cast<int>(i);
  }
  tree_->dbvt.optimizeTopDown();
}

BodyTree::~BodyTree() = default;
BodyTree::BodyTree(BodyTree&&) noexcept = default;
BodyTree& BodyTree::operator=(BodyTree&&) noexcept = default;

std::size_t BodyTree::find(const Eigen::AlignedBox3d& box_world,
                           std::span<std::uint16_t> found) const noexcept {
  Collector collector(found);
  // collideTV walks with a stack on the caller's own, enough for a tree of 2^60 bodies: no tick
  // allocates here.
  tree_->dbvt.collideTV(tree_->dbvt.m_root, bullet_volume(box_world), collector);
  std::sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(collector.count));
  return collector.count;
}

BodyQuery BodyTree::query() const noexcept {
  return {this, [](const void* bodies, const Eigen::AlignedBox3d& box,
                   std::span<std::uint16_t> found) noexcept {
            return static_cast<const BodyTree*>(bodies)->find(box, found);
          }};
}

}  // namespace sulcus
