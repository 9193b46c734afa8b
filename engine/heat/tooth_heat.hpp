#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "engine/heat/conduction.hpp"
#include "engine/heat/heat_log.hpp"
#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

/// What the pulp's limit is taken for, K above the start [Zach and Cohen 1965].
inline constexpr double kPulpLimit_K = 5.5;

/// How warm the pulp's wall became: of the cells of pulp with a face on another tissue, by how much
/// more than at the start.
struct PulpHeat {
  double greatest_rise_K = 0.0;  // of any of them, at any time
  double greatest_rise_s = 0.0;
  Eigen::Vector3d greatest_rise_world{0, 0, 0};
  double over_limit_s = 0.0;  // how long the warmest of them was beyond kPulpLimit_K
  struct Point {
    double time_s;
    double warmest_K, coldest_K;  // rises of any of them then
  };
  std::vector<Point> curve;  // at the end of each stretch

  /// At the end: of the place that is furthest from the start, above or below. 0 of no stretch.
  double end_change_K() const;
};

struct HeatResult {
  double cell_m = 0.0;           // edge of a cell
  double given_J = 0.0;          // by cutting to the tooth, without what still waits for a voxel
  std::optional<PulpHeat> pulp;  // none where the scene names no pulp, or the tooth has none
};

/// The temperature of a tooth that is cut, by a log of its run.
///
///   conduction  in cells of `HeatSettings::cell_m`, of which each has the mean of what its voxels
///               are made of; one goes when half of its voxels are gone, with its heat: so do chips
///   source      `tooth_share` of the work of the tangential force, in the cells of the voxels that
///               went in the same stretch, by the energy that each takes; where a cell has gone,
///               in those beside it. Work in a stretch in which none went waits for the next
///   sinks       still air on what is dry; gum and bone below `gum_m`, and where the grid cuts the
///               solid, at the start's temperature; and where the burr turns, water on what of the
///               surface lies near its tip: a film, mixed by what comes with the stream and what
///               the tooth gives it, so that little water warms and cools little
///
/// Influences nothing in the run. Used by one thread; a step runs on oneTBB and is the same for any
/// number of threads.
class ToothHeat {
 public:
  /// `start`: the workpiece before the first tick of the log; not kept. `scene` has [heat].
  ToothHeat(const Scene& scene, const VoxelModel& start);

  /// Goes on by the stretches of a log that end by `until_s`, on the clock of the run; each time of
  /// the same log, or of a longer one that begins with it.
  void advance(const HeatLog& log, double until_s);

  /// Up to where it has come.
  const HeatResult& result() const { return result_; }
  /// In the tooth, between the cells' centres; none where no cell is near. Index space of the
  /// workpiece.
  std::optional<double> temperature_C(const Eigen::Vector3d& p_index) const;
  std::size_t memory_bytes() const;

 private:
  enum class Side : std::uint8_t { kMouth, kGum };
  /// A cell with a face on nothing, or one that the grid cuts.
  struct SurfaceCell {
    std::uint32_t place;
    double area_m2;      // of the faces on nothing
    double cut_area_m2;  // where the grid cuts it
    Side side;
    Eigen::Vector3d centre_world;
  };

  void look_at_surface(std::uint32_t place);
  void remove_cell(std::uint32_t place);
  void remove_voxels(std::span<const HeatLog::GoneVoxel> gone);
  void heat(std::span<const HeatLog::GoneVoxel> gone);
  bool give(std::uint32_t place, double heat_J);
  void set_exchanges();
  void watch_pulp(double time_s, double seconds);
  std::uint32_t place_of(std::uint32_t voxel) const;
  Eigen::Vector3d centre_world(std::uint32_t place) const;

  HeatSettings settings_;
  VoxelGrid grid_;
  std::shared_ptr<const TissueMap> tissues_;
  std::vector<double> voxel_energy_J_;  // of a voxel of the workpiece, by tissue
  std::vector<double> other_energy_J_;  // of a voxel of each other body
  int edge_;                            // of a cell, in voxels
  Cell first_ = Cell::Zero();           // of the cells that the solid lies in
  std::optional<Conduction> solid_;
  std::vector<std::uint32_t> solid_voxels_;  // by place
  std::vector<SurfaceCell> surface_;
  std::vector<std::uint32_t> surface_at_;  // by place; kNone: it has no face on nothing
  std::vector<std::uint32_t> wall_;        // of the pulp, places
  std::vector<HeatExchange> exchanges_;

  std::size_t next_stretch_ = 0, next_gone_ = 0;
  HeatLog::Stretch now_;
  double waiting_J_ = 0.0;  // for a voxel that goes
  HeatResult result_;
};

}  // namespace sulcus
