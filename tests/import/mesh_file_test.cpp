#include "engine/import/mesh_file.hpp"

#include <cstring>
#include <filesystem>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>

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
    for (const int v : t)
      file.append(binary ? "" : " ").append(binary ? bytes_of(v) : std::to_string(v));
    if (!binary) file += "\n";
  }
  return file.substr(0, file.size() - cut);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::string times(int count, const std::string& part) {
  std::string all;
  for (int i = 0; i < count; ++i) all += part;
  return all;
}

/// A text PLY whose first face is `corners`.
std::string with_a_face_of(const std::string& corners) {
  return replaced(ply(false), "3 0 2 1", corners);
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
        BadMesh{"many.stl", stl(100000000),
                "triangle count: found 100000000 in a file of 284 bytes, expected 5000000084 bytes "
                "for them"},
        BadMesh{"zeros.stl", std::string(284, '\0'),
                "triangle count: found 0 in a file of 284 bytes, expected 84 bytes for them"},
        BadMesh{"ones.stl", std::string(284, '\xff'),
                "triangle count: found 4294967295 in a file of 284 bytes"},
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
        BadMesh{"corners.obj", obj("f 1 3 2\nf 1 2\n"),
                "line 6: found a face of 2 corners, expected 3 to 1000"},
        BadMesh{"none.obj", obj("f\n"), "line 5: found a face of 0 corners, expected 3 to 1000"},
        BadMesh{"polygon.obj", obj("f" + times(1001, " 1") + "\n"),
                "line 5: found a face of 1001 corners, expected 3 to 1000"},
        BadMesh{"lines.obj", obj("f" + times(1001, " \\\n1") + "\n"),
                "line 5: found a face of 1001 corners"},
        BadMesh{"parts.obj", obj(times(70000, "g a\n")),
                "line 65541: found more than 65536 parts, expected fewer objects, groups and "
                "materials"},
        BadMesh{"nan.obj", obj("f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", "nan"), "nan"},
        BadMesh{"truncated.ply", ply(true, 4, 4, 3, 20), "face 2: found the end of the file"},
        BadMesh{"truncated_text.ply", ply(false, 4, 4, 3, 9), "face 3: found the end"},
        BadMesh{"vertices.ply", ply(true, 4000000000), "expected 4000000000 rows"},
        BadMesh{"faces.ply", ply(false, 4, 400),
                "face 4: found the end of the file, expected 400 rows"},
        BadMesh{"many.ply", ply(false, 4, 4000000000),
                "header: found 4000000000 triangles, expected at most 16777216 (--limit-gib)"},
        BadMesh{"range.ply", ply(true, 4, 4, 9), "face 3: found vertex 9"},
        BadMesh{"range_text.ply", ply(false, 4, 4, 99), "face 3: found vertex 99"},
        BadMesh{"negative.ply", ply(true, 4, 4, -1), "face 3: found vertex -1"},
        BadMesh{"corners.ply", with_a_face_of("0"),
                "face 0: found a face of 0 corners, expected 3 to 1000"},
        BadMesh{"polygon.ply", with_a_face_of("2000" + times(2000, " 1")),
                "face 0: found a face of 2000 corners, expected 3 to 1000"},
        BadMesh{"nothing.ply",
                replaced(ply(false), "element face", "element nothing 4000000000\nelement face"),
                "header: found element nothing without properties, expected at least one"},
        BadMesh{
            "twice.ply",
            replaced(ply(false), "element face", "element vertex 4\nproperty char c\nelement face"),
            "header: found element vertex twice, expected it once"},
        BadMesh{"return.ply", replaced(ply(false), "1.0\n", "1.0\ncomment\relement vertex 9\n"),
                "line 3: found the control character 13, expected text"},
        BadMesh{"control.ply", replaced(ply(false), "3 0 2 1", "3 0 2\x10 1"),
                "line 14: found the control character 16, expected text"},
        BadMesh{"two_lines.ply", replaced(ply(false), "3 0 2 1", "3 0 2\n1"),
                "face 0: found the end of the line, expected 4 rows as the header says"},
        BadMesh{"one_line.ply", replaced(ply(false), "3 0 2 1", "3 0 2 1 7"),
                "face 0: found '7', expected the end of the row"},
        BadMesh{"fraction.ply", replaced(ply(false), "3 0 2 1", "3 0 2.5 1"),
                "face 0: found '2.5', expected 4 rows as the header says"},
        BadMesh{"float_index.ply", replaced(ply(false), "uchar int", "uchar float"),
                "header: found indices of type float, expected whole numbers"},
        BadMesh{"float_count.ply", replaced(ply(false), "uchar int", "float int"),
                "header: found lists of float lengths, expected whole numbers"},
        BadMesh{"control.obj", obj("f 1 3 2\rf 1 2 4\n"),
                "line 5: found the control character 13, expected text"},
        BadMesh{"header.ply", "ply\nformat ascii 1.0\n", "no end_header"},
        BadMesh{"word.ply", "hello\n", "\"ply\""},
        BadMesh{"tooth.fbx", "x", "expected .stl, .obj or .ply"}),
    [](const auto& tested) {
      std::string name = tested.param.name;
      for (char& c : name) c = c == '.' ? '_' : c;
      return name;
    });

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
}  // namespace sulcus
