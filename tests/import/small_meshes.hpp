#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/import/meshes/mesh_file.hpp"
#include "tests/import/mesh_fixtures.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/fuzz/handed_file.hpp"

// A tetrahedron of a sixth of a cubic millimetre in each format, byte by byte.

namespace sulcus::test {

template <class T>
std::string bytes_of(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

using Corner = std::array<float, 3>;
using Triangle = std::array<int, 3>;
inline const std::vector<Corner> kCorners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
inline const std::vector<Triangle> kTriangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

inline std::string stl(std::uint32_t announced = 4, const std::vector<Corner>& corners = kCorners,
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

inline std::string text_stl(const std::string& corner = "1 0 0",
                            const std::string& end = "endsolid a\n") {
  const std::vector<std::string> corners = {"0 0 0", corner, "0 1 0", "0 0 1"};
  std::string file = "solid a\n";
  for (const Triangle& t : kTriangles) {
    file += "facet normal 0 0 0\nouter loop\n";
    for (const int v : t) file += "vertex " + corners[static_cast<std::size_t>(v)] + "\n";
    file += "endloop\nendfacet\n";
  }
  return file + end;
}

inline std::string obj(const std::string& faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
                       const std::string& x = "1") {
  return "v 0 0 0\nv " + x + " 0 0\nv 0 1 0\nv 0 0 1\n" + faces;
}

inline std::string ply(bool binary, std::uint64_t vertices = 4, std::uint64_t faces = 4,
                       int last = 3, std::size_t cut = 0) {
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

/// `text` with every `from` replaced; there must be one.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  for (; at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

inline std::string times(int count, const std::string& part) {
  std::string all;
  for (int i = 0; i < count; ++i) all += part;
  return all;
}

/// A file that is to be read, or refused in a line that says something.
struct MeshCase {
  std::string name, contents, says;

  friend std::ostream& operator<<(std::ostream& out, const MeshCase& mesh) {
    return out << mesh.name;
  }
};

inline std::string name_of(const testing::TestParamInfo<MeshCase>& tested) {
  std::string name = tested.param.name;
  std::ranges::replace(name, '.', '_');
  return name;
}

inline void expect_tetrahedron(const TriangleMesh& mesh) {
  EXPECT_EQ(mesh.positions.size(), 4u);  // welded
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_NEAR(enclosed_volume(mesh), 1e-9 / 6.0, 1e-15);
}

inline void expect_refused(const MeshCase& mesh) {
  const ScratchFolder folder;
  const std::string path = folder.write(mesh.name, mesh.contents);
  try {
    read_mesh(path);
    FAIL() << "no error";
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with(path)) << text;
    EXPECT_NE(text.find(mesh.says), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

/// Whatever becomes of its bytes, a file is a mesh or is refused in one line. Whether it is one.
inline bool is_mesh_or_refused(const std::string& name, const std::string& contents) {
  // In memory: there are thousands.
  const fuzz::HandedFile file(
      {reinterpret_cast<const std::uint8_t*>(contents.data()), contents.size()}, name);
  TriangleMesh mesh;
  if (!fuzz::reads([&] { mesh = read_mesh(file.path()); })) return false;
  for (const Eigen::Vector3f& p : mesh.positions) EXPECT_TRUE(p.allFinite());
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) EXPECT_LT(v, mesh.positions.size());
  }
  return true;
}

/// The file cut short at every byte, and with every byte in turn made one of `others`.
inline void expect_damage_told(const std::string& name, const std::string& file,
                               const std::string& others) {
  for (std::size_t at = 0; at < file.size(); ++at) {
    SCOPED_TRACE(at);
    is_mesh_or_refused(name, file.substr(0, at));
    for (const char c : others) {
      std::string changed = file;
      changed[at] = c;
      is_mesh_or_refused(name, changed);
    }
  }
}

}  // namespace sulcus::test
