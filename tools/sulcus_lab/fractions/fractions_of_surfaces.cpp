#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tools/sulcus_lab/fractions/fractions.hpp"
#include "tools/sulcus_lab/fractions/surface_error.hpp"

namespace sulcus::lab {

namespace {

/// What is made of a model, and under which name.
struct MeshMaker {
  std::string name;
  TriangleMesh (*make)(const VoxelModel& model);
};

const MeshMaker kMeshMakers[] = {
    {"exported", exported_mesh},
    {"drawn", [](const VoxelModel& model) { return drawn_mesh(model); }}};
constexpr double kWanted = 0.03;  // voxels

}  // namespace

std::vector<FractionRow> fractions_of_surfaces(const FractionOptions& options) {
  std::vector<FractionRow> rows;
  std::vector<std::array<SurfaceSum, 2>> sums;  // of the rows; bodies of one name share theirs
  const auto row_at = [&](const std::string& shape, const std::string& setting) {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (rows[r].shape == shape && rows[r].setting == setting) return r;
    }
    FractionRow& row = rows.emplace_back();
    row.quantity = "surface_off_voxels";
    row.shape = shape;
    row.setting = setting;
    sums.emplace_back();
    return rows.size() - 1;
  };
  for (const KnownBody& body : known_bodies(options.quick)) {
    for (std::size_t s = 0; s < 2; ++s) {
      options.progress("surface: " + body.name + ", " + std::string(kSurfaceNames[s]));
      const VoxelModel model = body.model(kBothSurfaces[s]);
      for (const MeshMaker& maker : kMeshMakers) {
        const std::vector<SurfaceSum> found = surface_sums(maker.make(model), body);
        for (std::size_t z = 0; z < body.zones.size(); ++z) {
          const std::string zone = body.zones[z].empty() ? "" : ", " + body.zones[z];
          SurfaceSum& sum = sums[row_at(body.name, maker.name + zone)][s];
          sum.squares_m2 += found[z].squares_m2;
          sum.area_m2 += found[z].area_m2;
        }
      }
    }
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t s = 0; s < 2; ++s) {
      rows[r].value[s] = std::sqrt(sums[r][s].squares_m2 / sums[r][s].area_m2);
    }
    // An edge has no place within a voxel that a net could keep: there only less is wanted.
    rows[r].wanted = rows[r].setting.ends_with("edges") ? rows[r].binary() : kWanted;
  }
  return rows;
}

}  // namespace sulcus::lab
