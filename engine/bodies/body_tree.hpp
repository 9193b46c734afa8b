#pragma once

#include <memory>
#include <span>

#include "engine/bodies/body_query.hpp"

namespace sulcus {

/// Bounding boxes of the bodies of a scene in Bullet's dynamic tree: the broad phase over bodies.
/// Body i of `boxes_world` is number i. Read-only after construction, so any thread may ask.
class BodyTree {
 public:
  explicit BodyTree(std::span<const Eigen::AlignedBox3d> boxes_world);
  ~BodyTree();
  BodyTree(BodyTree&&) noexcept;
  BodyTree& operator=(BodyTree&&) noexcept;

  std::size_t find(const Eigen::AlignedBox3d& box_world,
                   std::span<std::uint16_t> found) const noexcept;
  BodyQuery query() const noexcept;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace sulcus
