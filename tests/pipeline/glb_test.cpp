// export --mesh x.glb, read by a few lines that know nothing but the format.
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::glb_test {
namespace {

/// A block of one tissue, cut from above off its middle; wider along x than along y.
const std::string kBlock = R"(
[[tissue]]
name = "glass"
colour = [0.1, 0.2, 0.9]
)" + test::block_and_fissure_burr("[5, 3, 2]", "0.1", "[64, 48, 32]") +
                           R"([trajectory]
axis = [0, 0, 1]
points_mm = [[1, 0, 1.2], [1, 0, 0]]
speed_mm_per_s = 4
[cutting]
[record]
)";

/// The parts of a .glb [glTF 2.0, 4.4]: its JSON, and one chunk of bytes.
class Glb {
 public:
  explicit Glb(std::string bytes) : bytes_(std::move(bytes)) {
    EXPECT_EQ(bytes_.substr(0, 4), "glTF");
    EXPECT_EQ(word(4), 2u);
    EXPECT_EQ(word(8), bytes_.size());
    EXPECT_EQ(bytes_.substr(16, 4), "JSON");
    gltf_ = nlohmann::json::parse(bytes_.substr(20, word(12)));
    binary_ = 20 + word(12) + 8;
    EXPECT_EQ(bytes_.substr(binary_ - 4, 3), "BIN");
    primitive_ = gltf_["meshes"][0]["primitives"][0];
  }
  template <class Part>
  std::vector<Part> values(const nlohmann::json& accessor_number) const {
    const auto& accessor = gltf_["accessors"][accessor_number.get<std::size_t>()];
    const auto& view = gltf_["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    std::vector<Part> values(accessor["count"].get<std::size_t>());
    const std::size_t at =
        binary_ + view.value("byteOffset", 0u) + accessor.value("byteOffset", 0u);
    std::memcpy(static_cast<void*>(values.data()), bytes_.data() + at,
                values.size() * sizeof(Part));
    return values;
  }
  const nlohmann::json& attribute(const char* name) const { return primitive_["attributes"][name]; }
  const nlohmann::json& primitive() const { return primitive_; }

 private:
  std::uint32_t word(std::size_t at) const {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes_.data() + at, sizeof value);
    return value;
  }
  std::string bytes_;
  std::size_t binary_ = 0;
  nlohmann::json gltf_, primitive_;
};

TEST(GlbExport, IsInMetresWithYUpAndTheColoursOfTheTissues) {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("run");
  const auto run = test::sulcus_command("run " + scratch.write("s.toml", kBlock) + " -o " + folder,
                                        scratch.path("err"));
  ASSERT_EQ(run.status, 0) << run.err;
  const auto result = test::sulcus_command(
      "export " + folder + "/recording.h5 --mesh " + scratch.path("cut.glb"), scratch.path("err"));
  ASSERT_EQ(result.status, 0) << result.err;
  const Glb glb(test::read_file(scratch.path("cut.glb")));
  const auto positions = glb.values<Eigen::Vector3f>(glb.attribute("POSITION"));
  const auto colours = glb.values<std::array<float, 4>>(glb.attribute("COLOR_0"));
  const auto triangles = glb.values<std::uint32_t>(glb.primitive()["indices"]);
  ASSERT_GT(positions.size(), 1000u);
  ASSERT_EQ(colours.size(), positions.size());

  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : positions) box.extend(p);
  EXPECT_NEAR(box.sizes().x(), 5e-3f, 0.1e-3f);  // x stays, z of the scene is y, y is -z
  EXPECT_NEAR(box.sizes().y(), 2e-3f, 0.1e-3f);
  EXPECT_NEAR(box.sizes().z(), 3e-3f, 0.1e-3f);
  double six = 0.0, floor_x = 0.0;
  int floor = 0;
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const Eigen::Vector3d a = positions[triangles[t]].cast<double>();
    const Eigen::Vector3d b = positions[triangles[t + 1]].cast<double>();
    const Eigen::Vector3d c = positions[triangles[t + 2]].cast<double>();
    six += a.dot(b.cross(c));
    const Eigen::Vector3d middle = (a + b + c) / 3.0;
    if (std::abs(middle.y()) > 0.3e-3 || std::abs(middle.x()) > 2.2e-3 ||
        std::abs(middle.z()) > 1.2e-3) {
      continue;
    }
    floor_x += middle.x();
    ++floor;
  }
  // Outward: a volume above 0, of the block less a shaft of about 1 mm deep.
  EXPECT_NEAR(six / 6.0, 30e-9 - 0.7e-9, 0.6e-9);
  ASSERT_GT(floor, 50);
  EXPECT_NEAR(floor_x / floor, 1e-3, 0.1e-3);
  for (const auto& [r, g, b, a] : colours) {
    EXPECT_NEAR(r, 0.1f, 0.005f);
    EXPECT_NEAR(g, 0.2f, 0.005f);
    EXPECT_NEAR(b, 0.9f, 0.005f);
    EXPECT_EQ(a, 1.0f);
  }
}

}  // namespace
}  // namespace sulcus::glb_test
