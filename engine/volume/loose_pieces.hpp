#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// Voxels that came loose together (VoxelGrid::linear), leaf by leaf, rising in each.
struct LoosePiece {
  std::vector<std::uint32_t> voxels;
};

/// Finds what cutting has separated. Voxels are connected by faces; of what was connected at the
/// start the largest part stays (of equal ones the one with the lowest first voxel), all others are
/// loose. A start may have several components, each of which keeps its own largest part: nothing is
/// loose before anything is cut.
///
/// What `take` returns follows from the start and from the set of voxels removed before each call
/// of it; neither their order nor how many calls of `remove` brought them counts. (The calls of
/// `take` do count: what one has taken is gone, and does not win when the rest is cut smaller than
/// it later.)
///
/// The nodes of the search are the parts of each leaf that are connected inside it: one in most
/// leaves. After a cut a search sets out from every node beside a removed voxel, all in turn, one
/// node at a time; those that meet go on as one, one that finds no more has been cut off, and
/// when one is left the rest of the component is its. So the time goes with the size of what came
/// off and with the way around the cut, not with the size of the tooth.
///
/// Free of threads: one at a time may call.
class LoosePieces {
 public:
  /// Takes a copy of the voxels; the tissues are shared.
  explicit LoosePieces(VoxelModel model);

  /// Voxels that were cut, each below grid.cell_count(); those that are empty are skipped.
  void remove(std::span<const std::uint32_t> voxels);
  /// The pieces that came loose since the last call, by their lowest voxel. They are removed from
  /// the copy. At once where nothing was removed.
  std::vector<LoosePiece> take();

  /// What stays.
  const VoxelModel& model() const { return model_; }
  std::size_t memory_bytes() const;

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  /// A part of a leaf; 0 where the leaf has but one.
  struct Node {
    std::uint32_t leaf = 0, part = 0;
  };
  struct Label {
    std::uint32_t component = kNone;  // of the start
    std::uint32_t front = kNone;      // that has reached it, during a search
  };
  struct Part {
    LeafBits voxels;
    Label label;
  };
  struct Leaf {
    Label label;                  // of the only part; without a component where there is none
    std::uint32_t split = kNone;  // place in splits_ of the parts, where there are several
  };
  /// A search that sets out from one node, or several that have met.
  struct Front {
    std::uint32_t met = kNone;  // the front that has taken it over
    std::uint32_t component = kNone;
    std::uint64_t voxels = 0;  // of the nodes left behind
    std::vector<Node> todo;    // reached, from `next` on not left behind yet
    std::size_t next = 0;
  };

  const LeafBits& voxels(Node node) const;
  Label& label(Node node);
  /// The part that holds a solid voxel.
  Node node_of(std::uint32_t leaf, const Cell& c) const;
  template <class Visit>
  void for_each_part(std::uint32_t leaf, const Visit& visit) const;
  template <class Visit>
  void for_each_neighbour(Node node, const Visit& visit) const;
  void set_parts(std::uint32_t leaf, std::span<const Part> parts);
  void divide(std::uint32_t leaf);
  void label_components();

  std::uint32_t root(std::uint32_t front);
  void reach(std::uint32_t front, Node node);
  bool advance(std::uint32_t front);
  void set_out();
  void search_component(std::vector<std::uint32_t> running, std::vector<std::uint32_t>& loose);
  std::vector<std::uint32_t> first_voxels();
  LoosePiece piece_of(std::span<const Node> nodes) const;
  void erase(std::span<const Node> nodes);

  VoxelModel model_;
  std::vector<Leaf> leaves_;
  std::vector<std::vector<Part>> splits_;
  std::vector<std::uint32_t> free_splits_;
  std::vector<std::uint64_t> component_voxels_;  // solid ones of each component
  std::vector<std::uint32_t> removed_;           // since the last take
  // Of the search that runs.
  std::vector<Front> fronts_;
  std::vector<Node> reached_;
};

}  // namespace sulcus
