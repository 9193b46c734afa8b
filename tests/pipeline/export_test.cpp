#include <array>
#include <cmath>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/import/meshes/mesh_file.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "engine/import/volumes/write_volume.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/surface_distance.hpp"

// What `sulcus export` writes lies over the file that the workpiece came from.

namespace sulcus::export_test {
namespace {

constexpr double kVoxel_m = 1e-4;
const Eigen::Vector3d kMiddle_file_mm{20, -30, 140};

/// Two blocks as labels 1 and 2 in one volume, whose lattice is turned about z, so that the grid's
/// voxels are its own in another order; the first one's middle lies at kMiddle_file_mm.
std::string write_jaw(const ScratchFolder& scratch) {
  VoxelModel model = test::make_model({64, 32, 32}, kVoxel_m, [](const Cell& c) {
    const bool first = c.x() >= 6 && c.x() < 26, second = c.x() >= 34 && c.x() < 54;
    return (first || second) && c.y() >= 8 && c.y() < 24 && c.z() >= 6 && c.z() < 28;
  });
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    tissues->set_uniform(leaf, model.grid.leaf_origin(leaf).x() < 32 ? 0 : 1);
  }
  model.tissues = tissues;
  InputGeometry place;
  place.file_from_world.linear() = (Eigen::Matrix3d() << 0, -1, 0, 1, 0, 0, 0, 0, 1).finished();
  const Eigen::Vector3d middle_world =
      model.grid.world_from_index(Eigen::Vector3d(15.5, 15.5, 16.5));
  place.file_from_world.translation() =
      kMiddle_file_mm * 1e-3 - place.file_from_world.linear() * middle_world;
  write_volume_in_file_space(scratch.path("jaw.nrrd"), model, VolumeContent::kLabels, place);
  return scratch.path("jaw.nrrd");
}

std::string scene_of(const std::string& file) {
  return "[workpiece]\nfile = '" + file + R"('
label = 1
voxel_mm = 0.1
cells = [40, 40, 40]
[burr]
diameter_mm = 0.8
speed_rpm = 300000
field = [32, 128, 32]
[trajectory]
points_mm = [[0, 0, 1.8], [0, 0, 0.9]]
speed_mm_per_s = 4
[haptics]
normals = "ldm_fast"
[cutting]
[record]
)";
}

class Export : public testing::Test {
 protected:
  void run(const std::string& scene) {
    const auto result = test::sulcus_command(
        "run " + scratch_.write("s.toml", scene) + " -o " + scratch_.path("out"), err_);
    ASSERT_EQ(result.status, 0) << result.err;
  }
  test::CommandResult exported(const std::string& options) {
    return test::sulcus_command("export " + scratch_.path("out/recording.h5") + " " + options,
                                err_);
  }

  ScratchFolder scratch_;
  std::string err_ = scratch_.path("err");
};

struct Voxels {
  std::size_t solid = 0;
  Eigen::AlignedBox3d box_file_mm;
};

Voxels voxels_of(const MedicalVolume& v) {
  Voxels found;
  for (int k = 0; k < v.sizes.z(); ++k) {
    for (int j = 0; j < v.sizes.y(); ++j) {
      for (int i = 0; i < v.sizes.x(); ++i) {
        if (v.at(i, j, k) <= 0.0f) continue;
        ++found.solid;
        found.box_file_mm.extend(
            (v.origin_m + v.direction * Eigen::Vector3d(i, j, k).cwiseProduct(v.spacing_m)) * 1e3);
      }
    }
  }
  return found;
}

TEST_F(Export, LiesOverTheFileOfTheWorkpieceUnlessTheSceneIsAskedFor) {
  const std::string jaw = write_jaw(scratch_);
  run(scene_of(jaw));
  const MedicalVolume in = read_medical_volume(jaw);
  const std::string volume = scratch_.path("a.nii.gz"), mesh = scratch_.path("a.ply");
  auto result = exported("--at 0 --volume " + volume + " --mesh " + mesh);
  ASSERT_EQ(result.status, 0) << result.err;
  const MedicalVolume placed = read_medical_volume(volume);
  EXPECT_EQ(placed.sizes, Eigen::Vector3i(40, 40, 40));
  EXPECT_LT((placed.direction - Eigen::Matrix3d::Identity()).norm(), 1e-6);
  EXPECT_GT((in.direction - Eigen::Matrix3d::Identity()).norm(), 1.0);
  const Voxels whole = voxels_of(placed);
  EXPECT_EQ(whole.solid, 20u * 16u * 22u);  // one tooth of the two, and every voxel of it
  EXPECT_LT((whole.box_file_mm.center() - kMiddle_file_mm).norm(), 1e-3);

  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& p : read_mesh(mesh).positions) box.extend(p.cast<double>() * 1e3);
  EXPECT_LT((box.center() - kMiddle_file_mm).norm(), 0.02);
  EXPECT_LT((box.sizes() - whole.box_file_mm.sizes()).maxCoeff(), 0.2);

  // On the input's voxels, where the cut is what differs.
  result = exported("--geometry input --volume " + scratch_.path("b.mha"));
  ASSERT_EQ(result.status, 0) << result.err;
  const MedicalVolume onto = read_medical_volume(scratch_.path("b.mha"));
  ASSERT_EQ(onto.sizes, in.sizes);
  EXPECT_LT((onto.origin_m - in.origin_m).norm(), 1e-9);
  EXPECT_LT((onto.spacing_m - in.spacing_m).norm(), 1e-12);
  std::size_t cut = 0, other = 0;
  for (std::size_t v = 0; v < in.values.size(); ++v) {
    const bool was = in.values[v] == 1.0f, is = onto.values[v] > 0.0f;
    cut += was && !is;
    other += is && !was;
  }
  EXPECT_GT(cut, 5u);
  EXPECT_EQ(other, 0u);
  EXPECT_EQ(whole.solid - cut, voxels_of(onto).solid);

  result = exported("--at 0 --geometry scene --volume " + scratch_.path("c.nrrd"));
  ASSERT_EQ(result.status, 0) << result.err;
  const Voxels in_scene = voxels_of(read_medical_volume(scratch_.path("c.nrrd")));
  EXPECT_EQ(in_scene.solid, whole.solid);
  EXPECT_LT(in_scene.box_file_mm.center().norm(), 1e-3);

  result = exported("--volume " + scratch_.path("d.tif"));
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("expected .nrrd, .mha or .nii.gz"), std::string::npos) << result.err;
}

TEST_F(Export, TheWayOfTheBurrIsALineThroughItsPlaces) {
  constexpr std::size_t kPoints = 221;
  run(scene_of(write_jaw(scratch_)));
  const std::string vtk = scratch_.path("way.vtk"), ply = scratch_.path("way.ply");
  for (const std::string& file : {vtk, ply}) {
    const auto result = exported("--at 0.22 --path " + file);
    ASSERT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.out, file + ": 221 points\n");
  }
  std::istringstream text(test::read_file(vtk));
  const auto skip_to = [&](const std::string& word) {
    std::string found;
    while (text >> found && found != word) {
    }
    EXPECT_EQ(found, word);
  };
  const auto numbers = [&](std::size_t count) {
    std::vector<double> read(count);
    for (double& number : read) text >> number;
    EXPECT_TRUE(text) << count;
    return read;
  };
  skip_to("double");
  const std::vector<double> places = numbers(3 * kPoints);
  skip_to("LINES");
  const std::vector<double> line = numbers(3 + kPoints);
  EXPECT_EQ(line[1], 222.0);
  for (std::size_t i = 0; i < kPoints; ++i) EXPECT_EQ(line[3 + i], static_cast<double>(i));
  skip_to("time_s");
  skip_to("double");
  const std::vector<double> times = numbers(kPoints);
  skip_to("double");
  const std::vector<double> forces = numbers(kPoints);
  skip_to("unsigned_int");
  const std::vector<double> removed = numbers(kPoints);
  // Down the tooth's axis at 4 mm/s, in the space of the file.
  std::size_t touching = 0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Eigen::Vector3d p(places[3 * i], places[3 * i + 1], places[3 * i + 2]);
    const Eigen::Vector3d expected =
        kMiddle_file_mm + Eigen::Vector3d(0, 0, 1.8 - 0.004 * static_cast<double>(i));
    EXPECT_LT((p - expected).norm(), 1e-3) << i;
    EXPECT_NEAR(times[i], 0.001 * static_cast<double>(i), 1e-9);
    touching += forces[i] > 0.0 ? 1 : 0;
  }
  EXPECT_GT(touching, 10u);
  EXPECT_GT(std::accumulate(removed.begin(), removed.end(), 0.0), 0.0);

  const std::string other = test::read_file(ply);
  EXPECT_NE(other.find("element vertex 221\n"), std::string::npos);
  EXPECT_NE(other.find("element edge 220\n"), std::string::npos);
  std::istringstream rows(other.substr(other.find("end_header\n") + 11));
  for (std::size_t i = 0; i < kPoints; ++i) {
    std::array<double, 6> row{};
    for (double& number : row) rows >> number;
    const std::array<double, 6> same{places[3 * i], places[3 * i + 1], places[3 * i + 2],
                                     times[i],      forces[i],         removed[i]};
    EXPECT_EQ(row, same) << i;
  }
  for (std::size_t i = 0; i + 1 < kPoints; ++i) {
    std::size_t from = 0, to = 0;
    rows >> from >> to;
    EXPECT_EQ(from, i);
    EXPECT_EQ(to, i + 1);
  }

  const auto refused = exported("--path " + scratch_.path("way.stl"));
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("expected .vtk or .ply"), std::string::npos) << refused.err;
}

/// By the theorem of Gauss, mm3.
double volume_of(const TriangleMesh& mesh) {
  double six_m3 = 0.0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.positions[t[0]].cast<double>();
    six_m3 += a.dot(mesh.positions[t[1]].cast<double>().cross(mesh.positions[t[2]].cast<double>()));
  }
  return six_m3 / 6.0 * 1e9;
}

TEST_F(Export, ASimplerMeshIsClosedAndMuchTheSame) {
  run(scene_of(write_jaw(scratch_)));
  const std::string whole = scratch_.path("a.stl"), simpler = scratch_.path("b.stl");
  ASSERT_EQ(exported("--geometry scene --mesh " + whole).status, 0);
  ASSERT_EQ(exported("--geometry scene --mesh " + simpler + " --simplify 0.02").status, 0);
  const TriangleMesh from = read_mesh(whole), to = read_mesh(simpler);
  EXPECT_LT(3 * to.triangles.size(), from.triangles.size());
  EXPECT_EQ(test::open_edges(to), 0u);
  // A block of 2 x 1.6 x 2.2 mm, of which no face moves by more.
  EXPECT_NEAR(volume_of(to), volume_of(from), 0.02 * 2.0 * (3.2 + 4.4 + 3.52));
  const auto refused = exported("--mesh " + whole + " --per-tissue --simplify 0.02");
  EXPECT_EQ(refused.status, 2) << "borders that two tissues share would part";
}

TEST_F(Export, ARepairedCopyAndALaterPartKnowItToo) {
  run(scene_of(write_jaw(scratch_)));
  const std::string recording = scratch_.path("out/recording.h5");
  auto result = test::sulcus_command("repair " + recording + " -o " + scratch_.path("r.h5"), err_);
  ASSERT_EQ(result.status, 0) << result.err;
  result = test::sulcus_command("replay " + recording + " --from 0.1 -o " + scratch_.path("later"),
                                err_);
  ASSERT_EQ(result.status, 0) << result.err;
  for (const std::string name : {"r.h5", "later/recording.h5"}) {
    result = test::sulcus_command(
        "export " + scratch_.path(name) + " --geometry input --volume " + scratch_.path("a.nrrd"),
        err_);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(read_medical_volume(scratch_.path("a.nrrd")).sizes, Eigen::Vector3i(64, 32, 32));
  }
}

// As in recordings that were made before they knew of a file.
TEST_F(Export, WithoutAFileItIsTheScenesSpace) {
  std::string scene = scene_of("");
  scene.replace(scene.find("file = ''\nlabel = 1"), 19,
                "shape = 'box'\nbox.size_mm = [2, 1.6, 2.2]");
  run(scene);
  auto result = exported("--volume " + scratch_.path("a.nrrd"));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_LT((read_medical_volume(scratch_.path("a.nrrd")).origin_m.array() + 19.5e-4).abs().sum(),
            1e-9);
  for (const char* geometry : {"input", "file"}) {
    result = exported("--volume " + scratch_.path("a.nrrd") + " --geometry " + geometry);
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find("expected --geometry scene"), std::string::npos) << result.err;
  }
}

}  // namespace
}  // namespace sulcus::export_test
