#include "engine/import/mesh_file.hpp"

#include <cstring>
#include <filesystem>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "tests/import/mesh_fixtures.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus {
namespace {

template <class T>
std::string bytes_of(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

using Corner = std::array<float, 3>;
using Triangle = std::array<int, 3>;
const std::vector<Corner> kCorners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Triangle> kTriangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

std::string stl(std::uint32_t announced = 4, const std::vector<Corner>& corners = kCorners,
                const std::vector<Triangle>& triangles = kTriangles) {
  std::string file = "solid in name only" + std::string(62, ' ') + bytes_of(announced);
  for (const Triangle& t : triangles) {
    file += std::string(12, '\0');
    for (const int v : t) {
      for (const float x : corners[static_cast<std::size_t>(v)]) file += bytes_of(x);
    }
    file += std::string(2, '\0');
  }
  return file;
}

std::string text_stl(const std::string& corner = "1 0 0", const std::string& end = "endsolid a\n") {
  const std::vector<std::string> corners = {"0 0 0", corner, "0 1 0", "0 0 1"};
  std::string file = "solid a\n";
  for (const Triangle& t : kTriangles) {
    file += "facet normal 0 0 0\nouter loop\n";
    for (const int v : t) file += "vertex " + corners[static_cast<std::size_t>(v)] + "\n";
    file += "endloop\nendfacet\n";
  }
  return file + end;
}

std::string obj(const std::string& faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
                const std::string& x = "1") {
  return "v 0 0 0\nv " + x + " 0 0\nv 0 1 0\nv 0 0 1\n" + faces;
}

std::string ply(bool binary, std::uint64_t vertices = 4, std::uint64_t faces = 4, int last = 3,
                std::size_t cut = 0) {
  std::string file = std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") +
                     " 1.0\nelement vertex " + std::to_string(vertices) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                     std::to_string(faces) +
                     "\nproperty list uchar int vertex_indices\nend_header\n";
  std::vector<Triangle> triangles = kTriangles;
  triangles.back()[2] = last;
  for (const Corner& c : kCorners) {
    for (const float x : c) file += binary ? bytes_of(x) : std::to_string(x) + " ";
    if (!binary) file += "\n";
  }
  for (const Triangle& t : triangles) {
    file += binary ? std::string("\3") : "3";
    for (const int v : t) file += binary ? bytes_of(v) : " " + std::to_string(v);
    if (!binary) file += "\n";
  }
  return file.substr(0, file.size() - cut);
}

void expect_tetrahedron(const TriangleMesh& mesh) {
  EXPECT_EQ(mesh.positions.size(), 4u);  // welded
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_NEAR(enclosed_volume(mesh), 1e-9 / 6.0, 1e-15);  // a sixth of a cubic millimetre
}

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

TEST(MeshFile, WrittenMeshesComeBack) {
  const ScratchFolder folder;
  TriangleMesh mesh = icosphere(3);
  scale(mesh, 5.3e-3f);
  for (const char* name : {"a.stl", "a.obj", "a.ply"}) {
    write_mesh(folder.path(name), mesh);
    const TriangleMesh back = read_mesh(folder.path(name));
    EXPECT_EQ(back.positions.size(), mesh.positions.size()) << name;
    EXPECT_EQ(back.triangles.size(), mesh.triangles.size()) << name;
    EXPECT_NEAR(enclosed_volume(back) / enclosed_volume(mesh), 1.0, 1e-5) << name;
  }
  EXPECT_EQ(std::filesystem::file_size(folder.path("a.stl")), 84 + 50 * mesh.triangles.size());
  EXPECT_THROW(write_mesh(folder.path("a.dae"), mesh), InputError);
  EXPECT_THROW(write_mesh(folder.path("no/folder/a.stl"), mesh), std::runtime_error);
}

struct BadMesh {
  std::string name, contents, says;

  friend std::ostream& operator<<(std::ostream& out, const BadMesh& mesh) {
    return out << mesh.name;
  }
};

class BadMeshes : public testing::TestWithParam<BadMesh> {};

TEST_P(BadMeshes, OneLine) {
  const ScratchFolder folder;
  const std::string path = folder.write(GetParam().name, GetParam().contents);
  try {
    read_mesh(path);
    FAIL() << "no error";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with(path)) << text;
    EXPECT_NE(text.find(GetParam().says), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

INSTANTIATE_TEST_SUITE_P(
    MeshFile, BadMeshes,
    testing::Values(
        BadMesh{"empty.stl", "", "an empty file"},
        BadMesh{"none.stl", stl(0, kCorners, {}), "found 0 triangles, expected at least 4"},
        BadMesh{"one.stl", stl(1, kCorners, {{0, 1, 2}}), "found 1 triangles"},
        BadMesh{"count.stl", stl(4000000000u), "triangle count: found 4000000000 in a file of 284"},
        BadMesh{"truncated.stl", stl().substr(0, 250), "triangle count: found 4 in a file of 250"},
        BadMesh{"header.stl", stl().substr(0, 60) + std::string(1, '\0'), "61 bytes"},
        BadMesh{"nan.stl", stl(4, {{0, 0, kNan}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), "nan"},
        BadMesh{"inf.stl", stl(4, {{0, 0, kInfinite}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), "inf"},
        BadMesh{"far.stl", stl(4, {{0, 0, 3e38f}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), "1 km"},
        BadMesh{"line.stl", stl(4, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}), "any area"},
        BadMesh{"text_cut.stl", text_stl("1 0 0", ""), "no endsolid"},
        BadMesh{"text_nan.stl", text_stl("nan 0 0"), "nan"},
        BadMesh{"text_word.stl", text_stl("one 0 0"), "unreadable contents"},
        BadMesh{"text_none.stl", "solid a\nendsolid a\n", "0 triangles"},
        BadMesh{"range.obj", obj("f 1 2 9\nf 1 2 3\nf 1 2 4\nf 2 3 4\n"), "out of range"},
        BadMesh{"zero.obj", obj("f 0 2 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\n"), "nvalid"},
        BadMesh{"points.obj", obj(""), "found 0 triangles"},
        BadMesh{"nan.obj", obj("f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", "nan"), "nan"},
        BadMesh{"truncated.ply", ply(true, 4, 4, 3, 20), "face 2: found the end of the file"},
        BadMesh{"truncated_text.ply", ply(false, 4, 4, 3, 9), "face 3: found the end"},
        BadMesh{"vertices.ply", ply(true, 4000000000), "expected 4000000000 rows"},
        BadMesh{"faces.ply", ply(false, 4, 4000000000), "expected 4000000000 rows"},
        BadMesh{"range.ply", ply(true, 4, 4, 9), "face 3: found vertex 9"},
        BadMesh{"range_text.ply", ply(false, 4, 4, 99), "face 3: found vertex 99"},
        BadMesh{"negative.ply", ply(true, 4, 4, -1), "face 3: found vertex -1"},
        BadMesh{"header.ply", "ply\nformat ascii 1.0\n", "no end_header"},
        BadMesh{"word.ply", "hello\n", "\"ply\""},
        BadMesh{"tooth.fbx", "x", "expected .stl, .obj or .ply"}),
    [](const auto& tested) {
      std::string name = tested.param.name;
      for (char& c : name) c = c == '.' ? '_' : c;
      return name;
    });

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
}  // namespace sulcus
