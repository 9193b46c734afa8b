#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "engine/surface/colour_scale.hpp"
#include "engine/volume/voxel_model.hpp"
#include "engine/volume/voxel_values.hpp"

namespace sulcus {

/// How a tissue is drawn.
struct TissueLook {
  std::string name;
  std::array<float, 3> colour;  // linear RGB
};

/// Voxels by leaf; leaves without any are left out.
using LeafMap = std::unordered_map<std::uint32_t, LeafBits>;

/// Also asked of voxels beyond the grid, which are none of them.
bool contains(const LeafMap& voxels, const VoxelGrid& grid, const Cell& c);

/// What a vertex of a drawn surface is coloured by: the tissue just inside; or where that is asked
/// for, when the surface there was cut, or any quantity of the voxels there.
class SurfaceColour {
 public:
  /// `looks`: one per tissue label, at least one, else std::invalid_argument; labels beyond are
  /// drawn as the last.
  explicit SurfaceColour(std::vector<TissueLook> looks);

  const std::vector<TissueLook>& looks() const { return looks_; }
  /// As DrawnSurface::colour_by_time.
  void by_time(double span_s);
  /// As DrawnSurface::colour_by_values.
  void by_values(const ColourScale& scale, VoxelValues values);
  void by_tissue() { by_time(0.0); }
  /// Of what is not drawn by tissue.
  const std::optional<ColourScale>& scale() const { return scale_; }
  const std::optional<VoxelValues>& values() const { return values_; }
  /// A voxel has been removed.
  void note_removed(const VoxelGrid& grid, const Cell& c, float time_s);

  /// What a vertex gets of it, as DrawnVertex has it.
  struct Seen {
    std::array<std::uint8_t, 4> colour_cut;
    bool unlit;
  };
  /// Of a vertex. `removed`: voxels that are gone; `was_cut`: whether any
  /// of them may be near. Any thread, while nothing is removed.
  Seen at(const VoxelModel& model, const LeafMap& removed, const Eigen::Vector3f& p_index,
          const Eigen::Vector3f& normal, bool was_cut) const;

 private:
  Eigen::Vector3f tissue_at(const VoxelModel& model, const Eigen::Vector3f& p_index,
                            const Eigen::Vector3f& normal) const;
  std::optional<Eigen::Vector3f> value_at(const Eigen::Vector3f& p_index,
                                          const Eigen::Vector3f& normal) const;
  float mean_time_s(const VoxelGrid& grid, const LeafMap& removed, const Cell& outside) const;

  std::vector<TissueLook> looks_;
  std::optional<ColourScale> scale_;  // none: by tissue
  std::optional<VoxelValues> values_;
  bool by_time_ = false;
  // When voxels of a leaf were removed, s, by LeafBits' places; where it is drawn by time.
  std::unordered_map<std::uint32_t, std::array<float, 512>> removed_at_s_;
};

}  // namespace sulcus
