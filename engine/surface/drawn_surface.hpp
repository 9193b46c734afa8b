#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/surface/density.hpp"
#include "engine/surface/surface_colour.hpp"
#include "engine/surface/surface_nets.hpp"
#include "engine/surface/wide_density.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// A vertex as the graphics card gets it.
struct DrawnVertex {
  std::array<float, 3> position_m;  // world
  // Outward unit normal times 32767; the fourth is 0, or 32767 where the colour is drawn as it is,
  // without light (ColourScale::unlit).
  std::array<std::int16_t, 4> normal;
  // Square root of the linear RGB of the tissue just inside, times 255 (dark tones need the
  // steps); the fourth: how much of the surface here was made by cutting.
  std::array<std::uint8_t, 4> colour_cut;

  bool operator==(const DrawnVertex&) const = default;
};
static_assert(sizeof(DrawnVertex) == 24);

struct DrawnMesh {
  std::vector<DrawnVertex> vertices;
  std::vector<std::uint32_t> indices;  // triangles, counter-clockwise seen from outside
};

/// What is left of a voxel (VoxelGrid::linear) of a model with fractions; level 0: it is gone.
struct VoxelLevel {
  std::uint32_t voxel = 0;
  FillLevel level = 0;
};

/// How finely a surface is meshed.
enum class Detail : std::uint8_t {
  kFull,
  kCoarse,  // cells of twice the edge, a quarter of the triangles: for pictures in a hurry
};

/// The surface of a voxel model as it is drawn: in bricks that fit together without cracks, and
/// from which a removed voxel touches only those near it. The shape is the half-level of the
/// lightly blurred density of cells of 1, 2 or 4 voxels; normals come from wider blurs, so that no
/// staircase shows. With fractions, which have none, the density is not blurred, vertices lie where
/// columns have the surface (move_to_columns), and normals come from the narrowest blur. Bricks of
/// one detail do not fit those of the other: a picture takes one. What is not asked for is not
/// meshed. No graphics library in it.
class DrawnSurface {
 public:
  /// Takes its own copy of the model. `looks`: one per tissue label, at least one; labels beyond
  /// are drawn as the last. `cell_voxels`: 1, 2 or 4; 0: the finest at which a tooth draws
  /// fluently. `removed`: voxels that are gone already; faces towards them are drawn as cut.
  DrawnSurface(VoxelModel model, std::vector<TissueLook> looks, int cell_voxels = 0,
               LeafMap removed = {});

  /// Draws what was cut by the time at which it was, light to dark over so many seconds, instead of
  /// by tissue. Before the first removal.
  void colour_by_time(double span_s) { colour_.by_time(span_s); }
  /// Draws a quantity of the voxels at the surface by a scale; what has none is grey. At any time;
  /// what looks otherwise than before is meshed again.
  void colour_by_values(const ColourScale& scale, VoxelValues values);
  /// As it is at first. At any time; all is meshed again where it was otherwise.
  void colour_by_tissue();
  /// Of what is not drawn by tissue.
  const std::optional<ColourScale>& colour_scale() const { return colour_.scale(); }
  /// As given to colour_by_values; none where something else is drawn.
  const std::optional<VoxelValues>& values() const { return colour_.values(); }
  /// Voxels (VoxelGrid::linear) that are no longer solid; those that were not are ignored.
  /// `time_s`: when, for colour_by_time.
  void remove(std::span<const std::uint32_t> voxels, double time_s = 0.0);
  /// Takes removals back; voxels that were not removed are ignored. All is then as before them.
  void restore(std::span<const std::uint32_t> voxels);
  /// Sets levels of a model with fractions, one after another; those of voxels that were never
  /// solid are ignored. What had been removed is there again with any level above 0. `time_s`: as
  /// for `remove`.
  void set_levels(std::span<const VoxelLevel> levels, double time_s = 0.0);

  const VoxelModel& model() const { return model_; }
  const Density& density() const { return density_; }
  const std::vector<TissueLook>& looks() const { return colour_.looks(); }
  /// The voxels of a leaf that were solid at the start, removed since or not.
  LeafBits solid_at_start(std::uint32_t leaf) const;
  /// The level of a voxel that was solid at the start: as it is, or was when it was removed.
  FillLevel last_level(const Cell& c) const;
  int brick_count(Detail detail = Detail::kFull) const { return lattice(detail).bricks.prod(); }
  /// Edge of the cells that are meshed in full detail, in voxels.
  int cell_voxels() const { return 1 << lattice(Detail::kFull).level; }
  /// Bricks to be meshed again, rising: all of them at first. Takes them off the list. Those whose
  /// shape is as it was, and only the light on them changes with what is some way off, may wait:
  /// `later` of these at most are among them, those first that were not for longest.
  std::vector<int> take_changed(std::size_t later = std::numeric_limits<std::size_t>::max(),
                                Detail detail = Detail::kFull);
  /// Leaves with removals since the last call, rising. Clears the list.
  std::vector<std::uint32_t> take_changed_leaves();

  struct Scratch {
    NetsBlock field;
    DensityBlock near;
    std::vector<float> blur;
    NetsScratch nets;
    NetsMesh mesh;
  };
  /// Meshes one brick, as of the last `take_changed`; empty where no surface passes. Any thread,
  /// while nothing is removed.
  void mesh(int brick, Scratch& scratch, DrawnMesh& out, Detail detail = Detail::kFull) const;

  std::size_t memory_bytes() const;

 private:
  enum Redraw : std::uint8_t { kNone, kNormals, kShape };
  /// The cells and bricks of a detail.
  struct Lattice {
    int level;         // log2 of a cell's edge in voxels
    int brick_voxels;  // along an edge
    Eigen::Vector3i bricks;
    std::vector<std::uint8_t> changed;  // per brick: a Redraw
    std::size_t first_later = 0;        // brick that is the next to have waited

    Lattice(int level, const Eigen::Vector3i& cells);
    void mark(const Cell& c, int reach, Redraw redraw);
  };
  struct BrickPlace {
    int level;       // of its cells
    Cell at;         // among the bricks
    Cell low, high;  // its voxels, and the end of them
    int edge() const { return 1 << level; }
  };
  static std::array<Lattice, 2> lattices(const VoxelModel& model, int cell_voxels);
  const Lattice& lattice(Detail detail) const {
    return lattices_[static_cast<std::size_t>(detail)];
  }
  enum class Occupancy : std::uint8_t { kEmpty, kSolid };
  void change(std::span<const std::uint32_t> voxels, Occupancy now, float time_s);
  bool change(const Cell& c, Occupancy now, float time_s);
  bool fill(const Cell& c, FillLevel level);
  void mark_changed(const Cell& c);
  void take_in(std::vector<std::uint32_t> leaves);
  bool may_have_surface(const Eigen::Vector3i& low_voxel, const Eigen::Vector3i& high_voxel) const;
  bool has_removals(const Eigen::Vector3i& low_voxel, const Eigen::Vector3i& high_voxel) const;
  BrickPlace place_of(int brick, Detail detail) const;
  /// The surface of a brick, into scratch.mesh.
  void mesh_shape(const BrickPlace& place, Scratch& scratch) const;
  DrawnVertex drawn_vertex(const Eigen::Vector3f& p_index, const DensityBlock& near,
                           bool was_cut) const;

  VoxelModel model_;
  SurfaceColour colour_;
  Density density_;
  std::optional<WideDensity> wide_;  // none with fractions
  std::array<Lattice, 2> lattices_;  // by Detail
  LeafMap removed_;
  std::vector<std::uint32_t> changed_leaves_;  // since take_changed_leaves
  std::vector<std::uint32_t> stale_leaves_;    // of `wide_`
};

/// Boxes, world, that hold the solid voxels, one for each layer of leaves that has any: closer to
/// the shape of a tooth than one box.
std::vector<Eigen::AlignedBox3d> solid_slabs(const VoxelModel& model);

}  // namespace sulcus
