#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "engine/scene/scene.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus::lab {

/// A surface voxel and the truth about it, in index space: the outward unit normal at the closest
/// point of its centre on the surface.
struct TruthVoxel {
  Cell cell;
  Eigen::Vector3d normal;
  int zone = 0;  // place in TruthShape::zones; of no meaning where there are none
};

/// Voxels of a shape whose normals are known.
struct TruthShape {
  std::string name;
  VoxelModel model;
  std::vector<std::string> zones;  // empty: nothing to tell apart
  std::vector<TruthVoxel> voxels;
  std::optional<Eigen::Vector3d> tool_direction;  // outward, where the tool's side is known
  bool either_sign = false;                       // a wall of one voxel has no side of its own
};

/// The first six are those of [Kim and Park 2019, VI-C] and of the design, the others are there
/// to be unlike them. No method was tuned on the gyroid, the dodecahedron, the hyperboloid and the
/// quartic; rims of the cone and the drilled ellipsoid, a face of the tetrahedron and the planes
/// were looked at.
inline constexpr std::string_view kShapeNames[] = {
    "sphere",      "cube",        "rotated_cube",
    "torus",       "molar",       "plate",
    "molar_cut",   "cone",        "drilled_ellipsoid",
    "gyroid",      "tetrahedron", "dodecahedron",
    "hyperboloid", "quartic",     "planes",
    "rough"};

/// The shapes of a name, in voxels unless said otherwise; solids with edges have the zones face,
/// near (2 to 10 voxels from an edge) and edge.
/// - sphere: radius 102.4 about (127.5, 127.5, 127.5) in 256^3 [Kim and Park 2019, VI-C]
/// - cube: upright, of 224, so that its surface has about as many voxels as the paper's. The
///   voxels of its edges are equally near to two faces: the truth is the first in the order of axes
/// - rotated_cube: three of 110, each tilted in its own way
/// - torus: radii 48 and 12, tilted
/// - molar: the built-in one at 0.07 mm
/// - plate: 1, 1.5, 2 and 3 thick at tilts up to 45 degrees, each thickness a zone; the side that
///   faces the tool, which comes from +z. Of one voxel both sides are one, so either sign is right
/// - molar_cut: the same tooth with a groove along the central sulcus and a drilled pit; zones
///   tooth, cut, near, edge
/// - cone: a frustum, radii 48 and 19, tilted: a face that is curved one way, ending in rims
/// - drilled_ellipsoid: semi-axes 60, 42, 32, with a hole of radius 9 through it, tilted
/// - gyroid: saddles everywhere, smallest radius of curvature 12
/// - tetrahedron: edges of 70.5 degrees, 127 long, tilted
/// - dodecahedron: edges of 116.6 degrees, 43 long, tilted
/// - hyperboloid: of one sheet, waist 26, rims of 40 where planes cut it, tilted: saddles, and
/// edges
/// - quartic: x^4 + y^4 + z^4 <= 50^4, tilted: flat, and bent ever more from there on
/// - planes: 200 of random attitudes, the same every time
/// - rough: balls of 48 with a surface as a burr leaves it: a voxel is solid where its centre,
///   moved by up to 0.4 or 0.7 at random, is inside. Each roughness a zone; full voxels alone
/// With fractions the model carries them; the voxels are those of the binary shape all the same.
/// Voxels near the grid's faces, where a shape goes on beyond them, are left out. InputError for
/// another name. Runs on oneTBB; the result does not depend on the number of threads.
std::vector<TruthShape> truth_shapes(std::string_view name,
                                     SurfaceKind surface = SurfaceKind::kBinary);

}  // namespace sulcus::lab
