#include "engine/import/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOSystem.h>
#include <assimp/Exporter.hpp>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include "engine/core/error.hpp"
#include "engine/core/units.hpp"
#include "engine/core/whole_file.hpp"
#include "engine/import/mesh_header.hpp"

namespace sulcus {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLeastTriangles = 4;  // of a solid
constexpr float kFarthest_mm = 1e6f;        // squares of it are still good floats

std::string one_line(std::string text) {
  constexpr std::size_t kLongest = 120;
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

/// Vertices at the same place become one, in the order in which they first occur.
class Welder {
 public:
  explicit Welder(TriangleMesh& mesh) : mesh_(mesh) {}

  std::uint32_t vertex(const aiVector3D& p_mm) {
    const Eigen::Vector3f p = (Eigen::Vector3d(p_mm.x, p_mm.y, p_mm.z) * kMillimetre).cast<float>();
    const auto next = static_cast<std::uint32_t>(mesh_.positions.size());
    // Adding 0 makes -0 and 0 the same place.
    const Key key = {std::bit_cast<std::uint32_t>(p.x() + 0.0f),
                     std::bit_cast<std::uint32_t>(p.y() + 0.0f),
                     std::bit_cast<std::uint32_t>(p.z() + 0.0f)};
    const auto [entry, inserted] = indices_.try_emplace(key, next);
    if (inserted) mesh_.positions.push_back(p);
    return entry->second;
  }

 private:
  using Key = std::array<std::uint32_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t h = 0;
      for (const std::uint32_t word : key) {
        h = (h ^ word) * 0x9e3779b97f4a7c15u;
        h ^= h >> 29;
      }
      return h;
    }
  };
  TriangleMesh& mesh_;
  std::unordered_map<Key, std::uint32_t, Hash> indices_;
};

/// The files that the library sees: one, and only to be read.
class OneFile : public Assimp::DefaultIOSystem {
 public:
  explicit OneFile(std::string path) : path_(std::move(path)) {}
  bool Exists(const char* file) const override { return path_ == file; }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    if (path_ != file || mode[0] != 'r') return nullptr;
    return DefaultIOSystem::Open(file, mode);
  }

 private:
  std::string path_;
};

/// Leaves the library only the reader of one extension: another would else be chosen by what a
/// file begins with.
void keep_reader(Assimp::Importer& importer, const std::string& extension) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    std::set<std::string> extensions;
    Assimp::BaseImporter* reader = importer.GetImporter(i);
    reader->GetExtensionList(extensions);
    if (extensions.contains(extension.substr(1))) continue;
    importer.UnregisterLoader(reader);
    delete reader;  // the importer's no longer
  }
}

void append(const std::string& path, const aiMesh& part, Welder& welder, TriangleMesh& mesh) {
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    if (face.mNumIndices != 3) continue;  // points and lines bound nothing
    std::array<aiVector3D, 3> corners;
    for (unsigned c = 0; c < 3; ++c) {
      if (face.mIndices[c] >= part.mNumVertices) {
        throw InputError(path, "face " + std::to_string(f),
                         "vertex " + std::to_string(face.mIndices[c]),
                         "less than " + std::to_string(part.mNumVertices));
      }
      corners[c] = part.mVertices[face.mIndices[c]];
      for (const float x : {corners[c].x, corners[c].y, corners[c].z}) {
        if (std::isfinite(x) && std::abs(x) <= kFarthest_mm) continue;
        std::ostringstream found;
        found << "a coordinate of " << x;
        throw InputError(path, "face " + std::to_string(f), found.str(),
                         "a finite one within 1 km");
      }
    }
    const std::array<std::uint32_t, 3> triangle = {
        welder.vertex(corners[0]), welder.vertex(corners[1]), welder.vertex(corners[2])};
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
      continue;
    }
    mesh.triangles.push_back(triangle);
  }
}

/// A vertex whose only triangles lost a corner is without any.
void drop_unused_vertices(TriangleMesh& mesh) {
  constexpr auto kUnused = ~std::uint32_t{0};
  std::vector<std::uint32_t> renamed(mesh.positions.size(), kUnused);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) renamed[v] = 0;
  }
  std::uint32_t kept = 0;
  for (std::size_t v = 0; v < renamed.size(); ++v) {
    if (renamed[v] == kUnused) continue;
    mesh.positions[kept] = mesh.positions[v];
    renamed[v] = kept++;
  }
  mesh.positions.resize(kept);
  for (auto& triangle : mesh.triangles) {
    for (std::uint32_t& v : triangle) v = renamed[v];
  }
}

double area_m2(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.positions[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.positions[t[1]].cast<double>();
    const Eigen::Vector3d c = mesh.positions[t[2]].cast<double>();
    const Eigen::Vector3d u = b - a, v = c - a;
    area += 0.5 * std::sqrt(std::max(0.0, u.squaredNorm() * v.squaredNorm() - u.dot(v) * u.dot(v)));
  }
  return area;
}

std::unique_ptr<aiScene> scene_of(const TriangleMesh& mesh) {
  auto scene = std::make_unique<aiScene>();  // frees all that is hung into it
  scene->mRootNode = new aiNode();
  scene->mMaterials = new aiMaterial* [1] { new aiMaterial() };
  scene->mNumMaterials = 1;
  auto* part = new aiMesh();
  scene->mMeshes = new aiMesh* [1] { part };
  scene->mNumMeshes = 1;
  scene->mRootNode->mMeshes = new unsigned[1]{0};
  scene->mRootNode->mNumMeshes = 1;
  part->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  part->mNumVertices = static_cast<unsigned>(mesh.positions.size());
  part->mVertices = new aiVector3D[mesh.positions.size()];
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Eigen::Vector3f p_mm = (mesh.positions[v].cast<double>() / kMillimetre).cast<float>();
    part->mVertices[v] = {p_mm.x(), p_mm.y(), p_mm.z()};
  }
  part->mNumFaces = static_cast<unsigned>(mesh.triangles.size());
  part->mFaces = new aiFace[mesh.triangles.size()];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    part->mFaces[t].mNumIndices = 3;
    part->mFaces[t].mIndices = new unsigned[3];
    std::ranges::copy(mesh.triangles[t], part->mFaces[t].mIndices);
  }
  return scene;
}

}  // namespace

TriangleMesh read_mesh(const std::string& path, const InputLimits& limits) {
  const std::string extension = lower_extension(path);
  if (!is_mesh_file(path)) {
    throw InputError(path, "", "the extension \"" + extension + "\"", ".stl, .obj or .ply");
  }
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError(path, "", "no such file", "a mesh");
  if (!fs::is_regular_file(path, error)) throw InputError(path, "", "no file", "a mesh");
  if (fs::file_size(path, error) == 0 || error) {
    throw InputError(path, "", "an empty file", "a mesh");
  }
  if (extension == ".stl") check_stl(path, limits);
  if (extension == ".obj") check_obj(path, limits);
  if (extension == ".ply") check_ply(path, limits);

  Assimp::Importer importer;
  importer.SetIOHandler(new OneFile(path));  // which it deletes
  keep_reader(importer, extension);
  const aiScene* scene = importer.ReadFile(path, aiProcess_Triangulate);
  if (scene == nullptr) {
    throw InputError(path, "", "unreadable contents (" + one_line(importer.GetErrorString()) + ")",
                     "a whole " + extension.substr(1) + " mesh");
  }
  TriangleMesh mesh;
  Welder welder(mesh);
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) append(path, *scene->mMeshes[m], welder, mesh);
  if (mesh.triangles.size() < kLeastTriangles) {
    throw InputError(path, "", std::to_string(mesh.triangles.size()) + " triangles",
                     "at least " + std::to_string(kLeastTriangles));
  }
  drop_unused_vertices(mesh);
  if (!(area_m2(mesh) > 0.0)) {
    throw InputError(path, "", "triangles without any area", "a surface");
  }
  return mesh;
}

void write_mesh(const std::string& path, const TriangleMesh& mesh) {
  const std::string extension = lower_extension(path);
  const char* format = extension == ".stl"   ? "stlb"
                       : extension == ".obj" ? "objnomtl"
                       : extension == ".ply" ? "plyb"
                                             : nullptr;
  if (format == nullptr) {
    throw InputError(path, "", "the extension \"" + extension + "\"", ".stl, .obj or .ply");
  }
  const std::unique_ptr<aiScene> scene = scene_of(mesh);
  // To memory: assimp does not see that a disk is full.
  Assimp::Exporter exporter;
  const aiExportDataBlob* bytes = exporter.ExportToBlob(scene.get(), format);
  if (bytes == nullptr) {
    throw std::runtime_error(path + ": cannot be written: " + one_line(exporter.GetErrorString()));
  }
  write_whole_file(path, {static_cast<const char*>(bytes->data), bytes->size});
}

}  // namespace sulcus
