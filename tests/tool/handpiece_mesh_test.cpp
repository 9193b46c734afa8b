#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "engine/tool/burr.hpp"
#include "engine/tool/burr_mesh.hpp"

namespace sulcus::handpiece_mesh_test {
namespace {

TEST(HandpieceMesh, IsClosedOutwardAndTakesUpTheShankAtItsEnd) {
  const Burr burr = make_burr(BurrSettings{}, 5e-5);
  const TriangleMesh mesh = handpiece_mesh(burr.mesh_tool, burr.head_length_m);
  ASSERT_FALSE(mesh.triangles.empty());
  Eigen::AlignedBox3f burr_box, box;
  for (const Eigen::Vector3f& p : burr.mesh_tool.positions) burr_box.extend(p);
  for (const Eigen::Vector3f& p : mesh.positions) box.extend(p);
  EXPECT_NEAR(box.min().y(), burr_box.max().y(), 3e-4);
  EXPECT_GT(box.max().x(), 4.0f * -box.min().x()) << "the neck goes off to one side";
  // Nothing wide comes near the blades.
  for (const Eigen::Vector3f& p : mesh.positions) {
    if (p.y() < burr.head_length_m + 6.4e-3) {
      EXPECT_LE(std::hypot(p.x(), p.z()), burr_box.max().x() + 1e-6f);
    }
  }
  // Round the shank where that ends, flat sides and all: nothing is seen of its end face.
  const float end = burr_box.max().y();
  float narrowest = 1.0f;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3f &p = mesh.positions[t[i]], &q = mesh.positions[t[(i + 1) % 3]];
      if (p.y() != end || q.y() != end) continue;
      const Eigen::Vector3f middle = 0.5f * (p + q);
      narrowest = std::min(narrowest, std::hypot(middle.x(), middle.z()));
    }
  }
  EXPECT_NEAR(narrowest, burr_box.max().x(), 2e-8f);
  // By place, since rods share none of their vertices and their ends are points.
  using Place = std::array<float, 3>;
  const auto place = [&](std::uint32_t v) {
    const Eigen::Vector3f& p = mesh.positions[v];
    return Place{p.x(), p.y(), p.z()};
  };
  std::map<std::pair<Place, Place>, int> sides;
  double volume = 0.0;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) ++sides[{place(t[i]), place(t[(i + 1) % 3])}];
    const auto p = [&](int i) { return mesh.positions[t[i]].cast<double>().eval(); };
    volume += p(0).dot(p(1).cross(p(2))) / 6.0;
  }
  for (const auto& [side, count] : sides) {
    EXPECT_EQ(count, (sides[{side.second, side.first}])) << side.first[1];
  }
  EXPECT_GT(volume, 3e-7);  // m3: a head alone has 0.4 cm3
}

TEST(HandpieceMesh, AnEmptyBurrHasNone) { EXPECT_TRUE(handpiece_mesh({}, 0.0).triangles.empty()); }

}  // namespace
}  // namespace sulcus::handpiece_mesh_test
