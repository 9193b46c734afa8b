#include "engine/volume/loose_pieces.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "engine/volume/leaf_parts.hpp"

namespace sulcus {

LoosePieces::LoosePieces(VoxelModel model)
    : model_(std::move(model)), leaves_(model_.leaves.size()) {
  std::vector<LeafBits> bits;
  std::vector<Part> parts;
  for (std::uint32_t leaf = 0; leaf < leaves_.size(); ++leaf) {
    bits.clear();
    append_parts(model_.leaves[leaf], bits);
    parts.clear();
    for (const LeafBits& b : bits) parts.push_back({b, {}});
    set_parts(leaf, parts);
  }
  label_components();
}

std::size_t LoosePieces::memory_bytes() const {
  std::size_t bytes = model_.leaves.bytes() + leaves_.capacity() * sizeof(Leaf) +
                      splits_.capacity() * sizeof(std::vector<Part>) +
                      component_voxels_.capacity() * sizeof(std::uint64_t);
  for (const std::vector<Part>& parts : splits_) bytes += parts.capacity() * sizeof(Part);
  return bytes;
}

const LeafBits& LoosePieces::voxels(Node node) const {
  const std::uint32_t split = leaves_[node.leaf].split;
  return split == kNone ? model_.leaves[node.leaf] : splits_[split][node.part].voxels;
}

LoosePieces::Label& LoosePieces::label(Node node) {
  Leaf& leaf = leaves_[node.leaf];
  return leaf.split == kNone ? leaf.label : splits_[leaf.split][node.part].label;
}

LoosePieces::Node LoosePieces::node_of(std::uint32_t leaf, const Cell& c) const {
  const std::uint32_t split = leaves_[leaf].split;
  std::uint32_t part = 0;
  if (split != kNone) {
    while (!splits_[split][part].voxels.has(leaf_place(c))) ++part;
  }
  return {leaf, part};
}

/// visit(part's number, its voxels).
template <class Visit>
void LoosePieces::for_each_part(std::uint32_t leaf, const Visit& visit) const {
  if (leaves_[leaf].split == kNone) {
    if (any(model_.leaves[leaf])) visit(0u, model_.leaves[leaf]);
    return;
  }
  const std::vector<Part>& parts = splits_[leaves_[leaf].split];
  for (std::uint32_t p = 0; p < parts.size(); ++p) visit(p, parts[p].voxels);
}

/// visit(node) for every node that shares a face of a voxel.
template <class Visit>
void LoosePieces::for_each_neighbour(Node node, const Visit& visit) const {
  const Eigen::Vector3i n = model_.grid.leaf_dims();
  const Eigen::Vector3i stride(1, n.x(), n.x() * n.y());
  const Cell at = model_.grid.leaf_origin(node.leaf) / kLeafEdge;
  for (int face = 0; face < kLeafFaces; ++face) {
    const int axis = face / 2, step = face % 2 == 0 ? -1 : 1;
    if (at[axis] + step < 0 || at[axis] + step >= n[axis]) continue;
    const auto beyond =
        static_cast<std::uint32_t>(static_cast<int>(node.leaf) + step * stride[axis]);
    const LeafBits touched = across(voxels(node), face);
    for_each_part(beyond, [&](std::uint32_t part, const LeafBits& bits) {
      if (any(touched & bits)) visit(Node{beyond, part});
    });
  }
}

/// Keeps the parts of a leaf, whose voxels are the leaf's.
void LoosePieces::set_parts(std::uint32_t leaf, std::span<const Part> parts) {
  Leaf& l = leaves_[leaf];
  if (parts.size() > 1) {
    if (l.split == kNone) {
      if (free_splits_.empty()) {
        l.split = static_cast<std::uint32_t>(splits_.size());
        splits_.emplace_back();
      } else {
        l.split = free_splits_.back();
        free_splits_.pop_back();
      }
    }
    splits_[l.split].assign(parts.begin(), parts.end());
    return;
  }
  if (l.split != kNone) {
    splits_[l.split] = {};
    free_splits_.push_back(std::exchange(l.split, kNone));
  }
  l.label = parts.empty() ? Label{} : parts.front().label;
}

/// Finds the parts of a leaf anew after voxels of it were removed: each lies in a former one.
void LoosePieces::divide(std::uint32_t leaf) {
  std::vector<Part> parts;
  std::vector<LeafBits> bits;
  for_each_part(leaf, [&](std::uint32_t part, const LeafBits& former) {
    const Label kept = label({leaf, part});
    bits.clear();
    append_parts(former, bits);
    for (const LeafBits& b : bits) parts.push_back({b, kept});
  });
  set_parts(leaf, parts);
}

void LoosePieces::label_components() {
  std::vector<Node> todo;
  for (std::uint32_t leaf = 0; leaf < leaves_.size(); ++leaf) {
    for_each_part(leaf, [&](std::uint32_t part, const LeafBits&) {
      if (label({leaf, part}).component != kNone) return;
      const auto component = static_cast<std::uint32_t>(component_voxels_.size());
      component_voxels_.push_back(0);
      label({leaf, part}).component = component;
      todo.assign(1, {leaf, part});
      while (!todo.empty()) {
        const Node node = todo.back();
        todo.pop_back();
        component_voxels_.back() += static_cast<std::uint64_t>(count_voxels(voxels(node)));
        for_each_neighbour(node, [&](Node to) {
          if (label(to).component != kNone) return;
          label(to).component = component;
          todo.push_back(to);
        });
      }
    });
  }
}

void LoosePieces::remove(std::span<const std::uint32_t> voxels) {
  for (std::uint32_t v : voxels) {
    const Cell c = model_.grid.cell_of_linear(v);
    if (!model_.solid(c)) continue;
    const std::uint32_t leaf = model_.grid.leaf_of(c);
    const Node node = node_of(leaf, c);
    --component_voxels_[label(node).component];
    if (leaves_[leaf].split != kNone) {
      splits_[leaves_[leaf].split][node.part].voxels.reset(leaf_place(c));
    }
    model_.set(c, false);
    removed_.push_back(v);
  }
}

std::uint32_t LoosePieces::root(std::uint32_t front) {
  while (fronts_[front].met != kNone) {
    const std::uint32_t met = fronts_[front].met;
    if (fronts_[met].met != kNone) fronts_[front].met = fronts_[met].met;
    front = met;
  }
  return front;
}

/// A front that has not met another comes to a node: takes it, or takes over the front that has.
void LoosePieces::reach(std::uint32_t front, Node node) {
  Label& l = label(node);
  if (l.front == kNone) {
    l.front = front;
    fronts_[front].todo.push_back(node);
    reached_.push_back(node);
    return;
  }
  const std::uint32_t other = root(l.front);
  if (other == front) return;
  Front &into = fronts_[front], &from = fronts_[other];
  if (into.todo.size() - into.next < from.todo.size() - from.next) {
    std::swap(into.todo, from.todo);
    std::swap(into.next, from.next);
  }
  into.todo.insert(into.todo.end(), from.todo.begin() + static_cast<std::ptrdiff_t>(from.next),
                   from.todo.end());
  into.voxels += from.voxels;
  from = {};
  from.met = front;
}

/// Leaves one node behind for its neighbours. False where there is none: the front has all that
/// is connected to where it set out.
bool LoosePieces::advance(std::uint32_t front) {
  if (fronts_[front].next == fronts_[front].todo.size()) return false;
  const Node node = fronts_[front].todo[fronts_[front].next++];
  fronts_[front].voxels += static_cast<std::uint64_t>(count_voxels(voxels(node)));
  for_each_neighbour(node, [&](Node to) { reach(front, to); });
  return true;
}

/// A front for each node beside a removed voxel: whatever was separated has one.
void LoosePieces::set_out() {
  for (std::uint32_t v : removed_) {
    const Cell c = model_.grid.cell_of_linear(v);
    for (int face = 0; face < 6; ++face) {
      Cell beside = c;
      beside[face / 2] += face % 2 == 0 ? -1 : 1;
      if (!model_.solid(beside)) continue;
      const Node node = node_of(model_.grid.leaf_of(beside), beside);
      if (label(node).front != kNone) continue;
      const auto front = static_cast<std::uint32_t>(fronts_.size());
      fronts_.push_back({});
      fronts_.back().component = label(node).component;
      reach(front, node);
    }
  }
}

/// Runs the fronts of one component until what is loose is known: those appended to `loose`.
void LoosePieces::search_component(std::vector<std::uint32_t> running,
                                   std::vector<std::uint32_t>& loose) {
  std::vector<std::uint32_t> complete;
  while (running.size() > 1) {
    std::erase_if(running, [&](std::uint32_t front) {
      if (fronts_[front].met != kNone) return true;
      if (advance(front)) return false;
      complete.push_back(front);
      return true;
    });
  }
  if (complete.empty()) return;

  const auto size = [&](std::uint32_t front) { return fronts_[front].voxels; };
  const std::uint64_t largest = size(*std::ranges::max_element(complete, {}, size));
  if (!running.empty()) {
    std::uint64_t rest = component_voxels_[fronts_[complete.front()].component];
    for (std::uint32_t front : complete) rest -= size(front);
    if (rest > largest) {
      loose.insert(loose.end(), complete.begin(), complete.end());
      return;
    }
    while (advance(running.front())) {
    }
    complete.push_back(running.front());
  }
  std::uint32_t stays = *std::ranges::max_element(complete, {}, size);
  if (std::ranges::count(complete, size(stays), size) > 1) {
    const std::vector<std::uint32_t> first = first_voxels();
    for (std::uint32_t front : complete) {
      if (size(front) == size(stays) && first[front] < first[stays]) stays = front;
    }
  }
  std::erase(complete, stays);
  loose.insert(loose.end(), complete.begin(), complete.end());
}

/// The first voxel that each front has reached.
std::vector<std::uint32_t> LoosePieces::first_voxels() {
  std::vector<std::uint32_t> first(fronts_.size(), kNone);
  for (const Node& node : reached_) {
    const LeafBits& bits = voxels(node);
    const auto word = std::ranges::find_if(bits.words, [](std::uint64_t w) { return w != 0; });
    const auto k = static_cast<int>(word - bits.words.begin());
    const Cell voxel =
        model_.grid.leaf_origin(node.leaf) + cell_in_leaf(k << 6 | std::countr_zero(*word));
    std::uint32_t& of_front = first[root(label(node).front)];
    of_front = std::min(of_front, model_.grid.linear(voxel));
  }
  return first;
}

/// The voxels of nodes that are sorted by leaf: leaf by leaf, rising in each.
LoosePiece LoosePieces::piece_of(std::span<const Node> nodes) const {
  LoosePiece piece;
  for (std::size_t i = 0; i < nodes.size();) {
    const std::uint32_t leaf = nodes[i].leaf;
    LeafBits bits;
    for (; i < nodes.size() && nodes[i].leaf == leaf; ++i) bits |= voxels(nodes[i]);
    const Cell origin = model_.grid.leaf_origin(leaf);
    for_each_voxel(bits, [&](int place) {
      piece.voxels.push_back(model_.grid.linear(origin + cell_in_leaf(place)));
    });
  }
  return piece;
}

/// Empties nodes whose leaves rise.
void LoosePieces::erase(std::span<const Node> nodes) {
  std::vector<Part> kept;
  for (std::size_t i = 0; i < nodes.size();) {
    const std::uint32_t leaf = nodes[i].leaf;
    kept.clear();
    LeafBits erased;
    for_each_part(leaf, [&](std::uint32_t part, const LeafBits& bits) {
      const bool gone = i < nodes.size() && nodes[i].leaf == leaf && nodes[i].part == part;
      if (!gone) {
        kept.push_back({bits, label({leaf, part})});
        return;
      }
      erased |= bits;
      component_voxels_[label({leaf, part}).component] -=
          static_cast<std::uint64_t>(count_voxels(bits));
      ++i;
    });
    model_.leaves[leaf] = without(model_.leaves[leaf], erased);
    set_parts(leaf, kept);
  }
}

std::vector<LoosePiece> LoosePieces::take() {
  if (removed_.empty()) return {};
  std::vector<std::uint32_t> cut_leaves;
  for (std::uint32_t v : removed_) {
    cut_leaves.push_back(model_.grid.leaf_of(model_.grid.cell_of_linear(v)));
  }
  std::ranges::sort(cut_leaves);
  cut_leaves.erase(std::unique(cut_leaves.begin(), cut_leaves.end()), cut_leaves.end());
  for (std::uint32_t leaf : cut_leaves) divide(leaf);

  set_out();
  removed_.clear();
  std::vector<std::uint32_t> starts(fronts_.size()), loose;
  std::iota(starts.begin(), starts.end(), 0u);
  const auto component = [&](std::uint32_t front) { return fronts_[front].component; };
  std::ranges::stable_sort(starts, {}, component);
  for (auto first = starts.begin(); first != starts.end();) {
    const auto last =
        std::ranges::upper_bound(first, starts.end(), component(*first), {}, component);
    search_component({first, last}, loose);
    first = last;
  }

  // Loose nodes by piece and leaf.
  std::vector<std::uint32_t> number_of(fronts_.size(), kNone);
  for (std::uint32_t p = 0; p < loose.size(); ++p) number_of[loose[p]] = p;
  std::vector<std::vector<Node>> nodes_of(loose.size());
  std::vector<Node> all;
  for (const Node& node : reached_) {
    const std::uint32_t piece = number_of[root(std::exchange(label(node).front, kNone))];
    if (piece == kNone) continue;
    nodes_of[piece].push_back(node);
    all.push_back(node);
  }
  reached_.clear();
  fronts_.clear();

  const auto place = [](const Node& node) { return std::pair(node.leaf, node.part); };
  std::vector<LoosePiece> pieces;
  for (std::vector<Node>& nodes : nodes_of) {
    std::ranges::sort(nodes, {}, place);
    pieces.push_back(piece_of(nodes));
  }
  std::ranges::sort(pieces, {},
                    [](const LoosePiece& piece) { return std::ranges::min(piece.voxels); });
  std::ranges::sort(all, {}, place);
  erase(all);
  return pieces;
}

}  // namespace sulcus
