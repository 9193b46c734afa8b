#include "engine/import/meshes/mesh_file.hpp"

#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "engine/core/error.hpp"
#include "tests/import/mesh_fixtures.hpp"
#include "tests/import/small_meshes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::mesh_file_test {
namespace {

using test::bytes_of;
using test::expect_tetrahedron;
using test::obj;
using test::ply;
using test::stl;
using test::text_stl;
using test::times;

TEST(MeshFile, ReadsEveryFormatInMillimetres) {
  const ScratchFolder folder;
  expect_tetrahedron(read_mesh(folder.write("a.stl", stl())));
  expect_tetrahedron(read_mesh(folder.write("A.STL", stl())));
  expect_tetrahedron(read_mesh(folder.write("b.stl", text_stl())));
  expect_tetrahedron(read_mesh(folder.write("a.obj", obj())));
  expect_tetrahedron(read_mesh(folder.write("a.ply", ply(true))));
  expect_tetrahedron(read_mesh(folder.write("b.ply", ply(false))));
}

TEST(MeshFile, PolygonsAreCutAndSplitCornersWelded) {
  const ScratchFolder folder;
  const TriangleMesh box = read_mesh(folder.write(
      "box.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv -0 0 0\n"
      "f 4 3 2 1\nf 5 6 7 8\nf 9 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 9 5 8\nf 1 1 2\n"));
  EXPECT_EQ(box.positions.size(), 8u);
  EXPECT_EQ(box.triangles.size(), 12u);  // and none of two corners
  EXPECT_NEAR(enclosed_volume(box), 1e-9, 1e-14);
}

TEST(MeshFile, WrittenMeshesComeBackBitByBit) {
  const ScratchFolder folder;
  TriangleMesh mesh = icosphere(3);
  scale(mesh, 5.3e-3f);
  for (const char* name : {"a.stl", "a.obj", "a.ply"}) {
    write_mesh(folder.path(name), mesh);
    const TriangleMesh back = read_mesh(folder.path(name));
    ASSERT_EQ(back.positions.size(), mesh.positions.size()) << name;
    ASSERT_EQ(back.triangles.size(), mesh.triangles.size()) << name;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (std::size_t c = 0; c < 3; ++c) {
        const Eigen::Vector3f error =
            back.positions[back.triangles[t][c]] - mesh.positions[mesh.triangles[t][c]];
        ASSERT_LE(error.cwiseAbs().maxCoeff(), 5e-10f) << name;  // a float's last bit at 5 mm
      }
    }
  }
  EXPECT_THROW(write_mesh(folder.path("a.dae"), mesh), InputError);
  EXPECT_THROW(write_mesh(folder.path("no/folder/a.stl"), mesh), InputError);
}

/// In a process of its own, which may not write longer files from then on.
bool full_disk_is_told(const std::string& path, const TriangleMesh& mesh) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit most{1000, 1000};
  setrlimit(RLIMIT_FSIZE, &most);
  try {
    write_mesh(path, mesh);
  } catch (const std::runtime_error& error) {
    return std::string(error.what()).starts_with(path + ": cannot be written");
  }
  return false;
}

TEST(MeshFileDeathTest, AFullDiskIsToldAndLeavesWhatWasThere) {
  const ScratchFolder folder;
  const TriangleMesh mesh = icosphere(3);
  for (const char* name : {"a.stl", "a.obj", "a.ply"}) {
    const std::string path = folder.write(name, "earlier");
    EXPECT_EXIT(std::_Exit(full_disk_is_told(path, mesh) ? 0 : 1), testing::ExitedWithCode(0), "");
    EXPECT_EQ(test::read_file(path), "earlier");
  }
}

/// What each format's own document says of the bytes, read here without our readers.
TEST(MeshFile, WrittenBytesAreThoseOfTheFormats) {
  const ScratchFolder folder;
  TriangleMesh mesh = box_mesh({1e-3f, 2e-3f, 4e-3f});
  const auto corner_mm = [&](std::size_t t, std::size_t c) {
    return Eigen::Vector3f(mesh.positions[mesh.triangles[t][c]] * 1e3f);
  };
  const auto floats_at = [](const std::string& bytes, std::size_t at) {
    Eigen::Vector3f v;
    std::memcpy(v.data(), bytes.data() + at, 12);
    return v;
  };

  write_mesh(folder.path("a.stl"), mesh);
  const std::string stl_bytes = test::read_file(folder.path("a.stl"));
  ASSERT_EQ(stl_bytes.size(), 84u + 50u * 12u);
  EXPECT_FALSE(stl_bytes.starts_with("solid"));
  EXPECT_EQ(stl_bytes.substr(80, 4), std::string("\x0c\0\0\0", 4));
  for (std::size_t t = 0; t < 12; ++t) {
    const std::size_t at = 84 + 50 * t;
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_LT((floats_at(stl_bytes, at + 12 + 12 * c) - corner_mm(t, c)).norm(), 1e-6f);
    }
    // The box is about the origin, its faces along the axes: outwards is where the face lies.
    const Eigen::Vector3f normal = floats_at(stl_bytes, at);
    const Eigen::Vector3f middle = (corner_mm(t, 0) + corner_mm(t, 1) + corner_mm(t, 2)) / 3.0f;
    EXPECT_NEAR(normal.norm(), 1.0f, 1e-6f);
    EXPECT_NEAR(normal.cwiseAbs().maxCoeff(), 1.0f, 1e-6f);
    EXPECT_GT(normal.dot(middle), 0.4f);
    EXPECT_EQ(stl_bytes.substr(at + 48, 2), std::string(2, '\0'));
  }

  write_mesh(folder.path("a.ply"), mesh);
  const std::string ply_bytes = test::read_file(folder.path("a.ply"));
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment lengths in mm\nelement vertex 8\n"
      "property float x\nproperty float y\nproperty float z\nelement face 12\n"
      "property list uchar int vertex_indices\nend_header\n";
  ASSERT_TRUE(ply_bytes.starts_with(header)) << ply_bytes.substr(0, 300);
  ASSERT_EQ(ply_bytes.size(), header.size() + 8 * 12 + 12 * 13);
  for (std::size_t v = 0; v < 8; ++v) {
    const Eigen::Vector3f place_mm = mesh.positions[v] * 1e3f;
    EXPECT_LT((floats_at(ply_bytes, header.size() + 12 * v) - place_mm).norm(), 1e-6f);
  }
  for (std::size_t t = 0; t < 12; ++t) {
    std::string row = "\3";
    for (const std::uint32_t v : mesh.triangles[t]) row += bytes_of(v);
    EXPECT_EQ(ply_bytes.substr(header.size() + 8 * 12 + 13 * t, 13), row);
  }

  write_mesh(folder.path("a.obj"), mesh);
  std::istringstream obj_text(test::read_file(folder.path("a.obj")));
  std::string line;
  std::size_t vertices = 0, faces = 0;
  while (std::getline(obj_text, line)) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Eigen::Vector3f p;
      words >> p.x() >> p.y() >> p.z();
      ASSERT_LT((p - mesh.positions[vertices++] * 1e3f).norm(), 1e-6f) << line;
    } else if (kind == "f") {
      std::array<std::uint32_t, 3> t{};
      words >> t[0] >> t[1] >> t[2];
      for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(t[c], mesh.triangles[faces][c] + 1) << line;
      ++faces;
    }
    ASSERT_FALSE(words.fail()) << line;
  }
  EXPECT_EQ(vertices, 8u);
  EXPECT_EQ(faces, 12u);
}

TEST(MeshFile, AnExportWhoseFirstByteEndsALineComesBack) {
  const ScratchFolder folder;
  TriangleMesh mesh = box_mesh({2e-3f, 2e-3f, 2e-3f});
  std::string bytes;
  std::size_t first = 0;
  for (int tries = 0; tries < 5000; ++tries) {
    write_mesh(folder.path("a.ply"), mesh);
    bytes = test::read_file(folder.path("a.ply"));
    first = bytes.find("end_header\n") + 11;
    if (bytes[first] == '\n') break;
    mesh.positions[0].x() = std::nextafter(mesh.positions[0].x(), -1.0f);
  }
  ASSERT_EQ(bytes[first], '\n');
  const TriangleMesh back = read_mesh(folder.path("a.ply"));
  EXPECT_EQ(back.triangles.size(), 12u);
  EXPECT_NEAR(enclosed_volume(back), 8e-9, 1e-12);
}

std::string error_with(const std::string& path, const InputLimits& limits) {
  try {
    read_mesh(path, limits);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(MeshFile, LimitsCanBeRaised) {
  const ScratchFolder folder;
  const auto limits_of = [](std::uint64_t triangles) {
    return InputLimits{.memory_bytes = triangles * InputLimits::kTriangleBytes};
  };
  const std::string path = folder.write("a.stl", stl());
  EXPECT_EQ(error_with(path, limits_of(3)),
            path + ": triangle count: found 4 triangles, expected at most 3 (--limit-gib)");
  EXPECT_EQ(error_with(path, limits_of(4)), "no error");
  const std::string faces = folder.write("a.obj", obj(times(20, "f 1 2 3\n")));
  EXPECT_EQ(error_with(faces, limits_of(19)),
            faces + ": line 24: found 20 triangles, expected at most 19 (--limit-gib)");
  EXPECT_EQ(error_with(faces, limits_of(20)), "no error");
  const std::string rows = folder.write("a.ply", ply(false, 4, 20));
  EXPECT_EQ(error_with(rows, limits_of(19)),
            rows + ": header: found 20 triangles, expected at most 19 (--limit-gib)");
  const std::string text = folder.write("b.stl", text_stl());
  EXPECT_EQ(error_with(text, {.memory_bytes = 1000}),
            text + ": found 363 bytes, expected at most 250 (--limit-gib)");
  EXPECT_EQ(error_with(text, {.memory_bytes = 4 * 363}), "no error");
}

TEST(MeshFile, NoOtherFileIsOpenedAndNoOtherFormatRead) {
  const ScratchFolder folder;
  // A pipe: whoever opened it would wait for ever.
  ASSERT_EQ(mkfifo(folder.path("pipe.mtl").c_str(), 0600), 0);
  expect_tetrahedron(read_mesh(folder.write("a.obj", "mtllib pipe.mtl\n" + obj())));
  const std::string drawing = folder.write("drawing.obj", "0\nSECTION\n2\nHEADER\n0\nENDSEC\n");
  EXPECT_NE(error_with(drawing, {}), "no error");
}

TEST(MeshFile, MissingFilesAndFolders) {
  const ScratchFolder folder;
  EXPECT_THROW(read_mesh(folder.path("none.stl")), InputError);
  folder.write("folder.stl/x", "x");
  EXPECT_THROW(read_mesh(folder.path("folder.stl")), InputError);
}

TEST(MeshFile, RealMolar) {
  const std::string path = SULCUS_SOURCE_DIR "/../shared/data/open_full_jaw/mandible_tooth_19.stl";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  const TriangleMesh mesh = read_mesh(path);
  EXPECT_EQ(mesh.triangles.size(), 43980u);
  // Closed and of genus 0: V = F / 2 + 2 [Euler].
  EXPECT_EQ(mesh.positions.size(), 43980u / 2 + 2);
  EXPECT_NEAR(enclosed_volume(mesh), 891e-9, 1e-9);
}

}  // namespace
}  // namespace sulcus::mesh_file_test
