#include "engine/import/meshes/mesh_shells.hpp"

#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/import/meshes/voxelise_mesh.hpp"
#include "tests/import/mesh_fixtures.hpp"

namespace sulcus::mesh_shells_test {
namespace {

constexpr float kVoxel_m = 1e-4f;

/// Boxes of sizes and middles in voxels of 0.1 mm, some with their faces turned inwards.
class Boxes {
 public:
  Boxes& add(const Eigen::Vector3f& size, const Eigen::Vector3f& middle, bool inwards = false) {
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    const TriangleMesh box = box_mesh(size * kVoxel_m);
    for (const Eigen::Vector3f& p : box.positions) mesh_.positions.push_back(p + middle * kVoxel_m);
    for (auto t : box.triangles) {
      if (inwards) std::swap(t[0], t[1]);
      mesh_.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    return *this;
  }
  /// Voxels, with the whole mesh's box in the middle of the grid.
  std::size_t solid() const {
    return voxelise_mesh(mesh_, VoxelGrid{{64, 64, 64}, kVoxel_m}, {}).solid_count();
  }
  std::string refusal() const {
    try {
      WorkpieceSettings settings;
      settings.file = "boxes.stl";
      voxelise_mesh(mesh_, VoxelGrid{{64, 64, 64}, kVoxel_m}, settings);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no refusal";
  }
  const TriangleMesh& mesh() const { return mesh_; }

 private:
  TriangleMesh mesh_;
};

TEST(MeshShells, AreCountedInTheOrderOfTheFile) {
  const Boxes boxes = std::move(Boxes().add({2, 2, 2}, {0, 0, 0}).add({2, 2, 2}, {5, 0, 0}));
  const MeshShells shells = find_shells(boxes.mesh());
  EXPECT_EQ(shells.count, 2u);
  ASSERT_EQ(shells.of_triangle.size(), 24u);
  for (std::size_t t = 0; t < 24; ++t) EXPECT_EQ(shells.of_triangle[t], t / 12);
}

TEST(MeshShells, AnInsideOutOneHalfOverAnotherIsAskedAbout) {
  // 10 x 20 x 20 voxels of both: 4 mm3.
  EXPECT_EQ(Boxes().add({20, 20, 20}, {0, 0, 0}).add({20, 20, 20}, {10, 0, 0}, true).refusal(),
            "boxes.stl: found shell 2 of 2, about (1, 0, 0) mm, turned against shell 1 and half "
            "over it: 4 mm3 of both would be a hole, expected shells turned alike, or a cavity "
            "wholly within another: turn its faces round in a mesh editor");
  // The smaller one is the one that is told of, whichever comes first and is turned which way.
  for (const bool inwards : {false, true}) {
    EXPECT_NE(Boxes()
                  .add({8, 8, 8}, {10, 0, 0}, inwards)
                  .add({20, 20, 20}, {0, 0, 0}, !inwards)
                  .refusal()
                  .find("found shell 1 of 2, about (1, 0, 0) mm"),
              std::string::npos);
  }
  // A third that takes no part.
  EXPECT_NE(Boxes()
                .add({4, 4, 4}, {-20, 0, 0})
                .add({20, 20, 20}, {0, 0, 0})
                .add({10, 10, 10}, {0, 10, 0}, true)
                .refusal()
                .find("found shell 3 of 3, about (0, 1, 0) mm, turned against shell 2"),
            std::string::npos);
}

TEST(MeshShells, CavitiesSolidsInThemAndOnesApartStayAsTheyWere) {
  EXPECT_EQ(Boxes().add({20, 20, 20}, {0, 0, 0}).add({20, 20, 20}, {10, 0, 0}).solid(),
            30u * 20 * 20);
  EXPECT_EQ(Boxes().add({20, 20, 20}, {0, 0, 0}).add({8, 8, 8}, {2, 0, 0}, true).solid(),
            20u * 20 * 20 - 8 * 8 * 8);
  // Inside out as a whole.
  EXPECT_EQ(Boxes().add({20, 20, 20}, {0, 0, 0}, true).add({8, 8, 8}, {2, 0, 0}).solid(),
            20u * 20 * 20 - 8 * 8 * 8);
  // A stone that sticks out of the cavity's wall.
  EXPECT_EQ(Boxes()
                .add({20, 20, 20}, {0, 0, 0})
                .add({8, 8, 8}, {0, 0, 0}, true)
                .add({4, 4, 4}, {4, 0, 0})
                .solid(),
            20u * 20 * 20 - 8 * 8 * 8 + 2 * 4 * 4);
  // Two solids apart, turned against each other, the larger one hollow.
  EXPECT_EQ(Boxes()
                .add({10, 10, 10}, {-13, 0, 0})
                .add({20, 20, 20}, {12, 0, 0}, true)
                .add({6, 6, 6}, {12, 0, 0})
                .solid(),
            10u * 10 * 10 + 20 * 20 * 20 - 6 * 6 * 6);
  // A cavity in a solid that lacks half of a side.
  TriangleMesh open = Boxes().add({20, 20, 20}, {0, 0, 0}).add({8, 8, 8}, {0, 0, 0}, true).mesh();
  open.triangles.erase(open.triangles.begin() + 2);
  EXPECT_NEAR(
      static_cast<double>(voxelise_mesh(open, VoxelGrid{{64, 64, 64}, kVoxel_m}, {}).solid_count()),
      20.0 * 20 * 20 - 8 * 8 * 8, 0.1 * 20 * 20 * 20);
  // One upon another, face to face.
  EXPECT_EQ(Boxes().add({20, 20, 20}, {-10, 0, 0}).add({20, 20, 20}, {10, 0, 0}, true).solid(),
            40u * 20 * 20);
}

}  // namespace
}  // namespace sulcus::mesh_shells_test
