#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "engine/normals/surface_estimate.hpp"
#include "engine/normals/voxel_query.hpp"
#include "engine/volume/workpiece.hpp"

namespace sulcus::lab {

/// Every way to a normal that is measured. `pca` and `mls` are PCL's, in a program built with it.
enum class Method : std::uint8_t {
  kLdm,
  kLdmFast,
  kLdmPaper,
  kWeightedSum,
  kWeightedSumD2,
  kPca,
  kMls,
  kExact,
};

/// What a method reads for a normal.
enum class Window : std::uint8_t {
  kMap,           // columns of a square, one look each
  kCube,          // all voxels of a cube
  kBallOfPoints,  // the surface voxels in a ball of the cube's volume, by a search tree
};

struct MethodInfo {
  Method method;
  std::string_view name;  // on the command line, in tables and in charts
  int largest_ns;         // that it takes
  int largest_usual_ns;   // measured unless another is asked for
  Window window;
  bool finds_sign;  // false: a line, not a direction
  /// Voxels that suffice for its errors and for its times, of the slow ones; 0: all of them.
  int error_voxels, timed_voxels;
  int slow_from_ns;  // the limits above hold from this NS on
};

/// All of them, in the order of tables and charts.
std::span<const MethodInfo> all_methods();
const MethodInfo& info_of(Method method);
/// False for PCL's where the program was built without it.
bool is_available(Method method);
/// InputError for an unknown name, and for one that is not available.
Method method_named(std::string_view name);

/// Neighbourhoods measured unless others are asked for: 1 to 6, 8 and 12, as far as the method is
/// measured.
std::vector<int> usual_neighbourhoods(Method method);

/// Places read for one normal, n = 2 NS + 1: n^2 columns of a map, n^3 voxels of a cube, or as many
/// points as a ball of radius 0.62 n holds of a flat surface, pi (0.62 n)^2. Second looks of
/// adaptive methods and steps in a search tree are not counted.
double readouts(Method method, int neighbourhood);

/// Some surface voxels of a workpiece, found in its cloud of points beforehand, outside of what is
/// timed.
struct VoxelSample {
  std::vector<Cell> cells;
  std::vector<VoxelQuery> queries;  // the same, with what the tool knows
  std::vector<int> points;          // places in the cloud; empty where no cloud was needed
};

/// The methods on one workpiece, which must outlive this. Not for several threads.
class NormalMethods {
 public:
  /// `with_cloud`: pca and mls will be asked for; builds their cloud of all surface voxels.
  /// `tool_direction`: outward, unit, for the methods that use it.
  NormalMethods(const Workpiece& workpiece, bool with_cloud,
                const std::optional<Eigen::Vector3d>& tool_direction);
  ~NormalMethods();

  /// `cells` must be surface voxels.
  VoxelSample sample(std::vector<Cell> cells) const;
  /// One estimate per voxel of the sample, in its order. As the engine's own functions: trace 12,
  /// ldm_paper 5.
  void estimate(Method method, int neighbourhood, const VoxelSample& sample,
                std::vector<SurfaceEstimate>& estimates) const;

 private:
  struct Cloud;
  const Workpiece& workpiece_;
  Eigen::Vector3f outward_;  // zero: nothing is known
  std::unique_ptr<Cloud> cloud_;
};

}  // namespace sulcus::lab
