#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>

#include <Eigen/Geometry>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/import/meshes/mesh_file.hpp"

namespace sulcus {
namespace {

static_assert(std::endian::native == std::endian::little, "as STL is, and PLY is written");

Eigen::Vector3f in_mm(const Eigen::Vector3f& p) {
  return (p.cast<double>() / kMillimetre).cast<float>();
}

template <class T>
void put(std::ostream& out, const T& value) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), &value, sizeof(T));
  out.write(bytes.data(), bytes.size());
}

void put(std::ostream& out, const Eigen::Vector3f& p) {
  for (const float x : p) put(out, x);
}

/// As few digits as name this float, whatever the locale.
void put_digits(std::ostream& out, float value) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  out.write(digits.data(), end - digits.data());
}

void write_stl(std::ostream& out, const TriangleMesh& mesh) {
  std::string header = "binary STL, lengths in mm";  // never "solid", which begins a text
  header.resize(80, ' ');
  out << header;
  put(out, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const std::array<Eigen::Vector3f, 3> corners = {
        in_mm(mesh.positions[t[0]]), in_mm(mesh.positions[t[1]]), in_mm(mesh.positions[t[2]])};
    const Eigen::Vector3d a = corners[0].cast<double>();
    const Eigen::Vector3d normal =
        (corners[1].cast<double>() - a).cross(corners[2].cast<double>() - a).normalized();
    put(out, Eigen::Vector3f(normal.cast<float>()));
    for (const Eigen::Vector3f& corner : corners) put(out, corner);
    put(out, std::uint16_t{0});
  }
}

void write_obj(std::ostream& out, const TriangleMesh& mesh) {
  out << "# lengths in mm\n";
  for (const Eigen::Vector3f& p : mesh.positions) {
    out << 'v';
    for (const float x : in_mm(p)) put_digits(out << ' ', x);
    out << '\n';
  }
  for (const auto& t : mesh.triangles) {
    out << 'f';
    for (const std::uint32_t v : t) out << ' ' << std::to_string(std::uint64_t{v} + 1);
    out << '\n';
  }
}

void write_ply(std::ostream& out, const TriangleMesh& mesh) {
  out << "ply\nformat binary_little_endian 1.0\ncomment lengths in mm\nelement vertex "
      << std::to_string(mesh.positions.size())
      << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
      << std::to_string(mesh.triangles.size())
      << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Eigen::Vector3f& p : mesh.positions) put(out, in_mm(p));
  for (const auto& t : mesh.triangles) {
    put(out, std::uint8_t{3});
    for (const std::uint32_t v : t) put(out, v);
  }
}

}  // namespace

void write_mesh(const std::string& path, const TriangleMesh& mesh) {
  const std::string extension = lower_extension(path);
  if (!is_mesh_file(path)) {
    throw InputError(path, "", "the extension \"" + extension + "\"", ".stl, .obj or .ply");
  }
  WholeFile file(path);
  std::ofstream out(file.beside(), std::ios::binary);
  if (extension == ".stl") {
    write_stl(out, mesh);
  } else if (extension == ".obj") {
    write_obj(out, mesh);
  } else {
    write_ply(out, mesh);
  }
  out.close();
  if (!out) file.fail_incomplete();
  file.finish();
}

}  // namespace sulcus
