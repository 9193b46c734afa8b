#include "engine/import/meshes/write_glb.hpp"

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string_view>

#include <assimp/Exporter.hpp>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>

#include "engine/core/error.hpp"
#include "engine/core/whole_file.hpp"

namespace sulcus {

namespace {

// What assimp's structures own they free themselves, with delete[] and delete.

std::unique_ptr<aiMesh> assimp_mesh(const TriangleMesh& mesh,
                                    std::span<const Eigen::Vector3f> colours) {
  auto made = std::make_unique<aiMesh>();
  made->mName = "tooth";
  made->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  made->mNumVertices = static_cast<unsigned>(mesh.positions.size());
  made->mVertices = new aiVector3D[mesh.positions.size()];
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Eigen::Vector3f& p = mesh.positions[v];
    made->mVertices[v] = {p.x(), p.z(), -p.y()};
  }
  if (!colours.empty()) {
    made->mColors[0] = new aiColor4D[colours.size()];
    for (std::size_t v = 0; v < colours.size(); ++v) {
      made->mColors[0][v] = {colours[v].x(), colours[v].y(), colours[v].z(), 1.0f};
    }
  }
  made->mNumFaces = static_cast<unsigned>(mesh.triangles.size());
  made->mFaces = new aiFace[mesh.triangles.size()];
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    aiFace& face = made->mFaces[t];
    face.mNumIndices = 3;
    face.mIndices = new unsigned[3];
    for (std::size_t k = 0; k < 3; ++k) face.mIndices[k] = mesh.triangles[t][k];
  }
  return made;
}

std::unique_ptr<aiMaterial> plain_material() {
  auto material = std::make_unique<aiMaterial>();
  const aiColor4D white(1.0f, 1.0f, 1.0f, 1.0f);
  const float metallic = 0.0f, roughness = 0.6f;
  material->AddProperty(&white, 1, AI_MATKEY_BASE_COLOR);
  material->AddProperty(&metallic, 1, AI_MATKEY_METALLIC_FACTOR);
  material->AddProperty(&roughness, 1, AI_MATKEY_ROUGHNESS_FACTOR);
  return material;
}

}  // namespace

void write_glb(const std::string& path, const TriangleMesh& mesh,
               std::span<const Eigen::Vector3f> colours) {
  if (mesh.triangles.empty()) throw InputError(path, "", "a mesh without triangles", "some");
  WholeFile file(path);
  aiScene scene;
  scene.mMeshes = new aiMesh* [1] { assimp_mesh(mesh, colours).release() };
  scene.mNumMeshes = 1;
  scene.mMaterials = new aiMaterial* [1] { plain_material().release() };
  scene.mNumMaterials = 1;
  scene.mRootNode = new aiNode("tooth");
  scene.mRootNode->mMeshes = new unsigned[1]{0};
  scene.mRootNode->mNumMeshes = 1;
  Assimp::Exporter exporter;
  const aiExportDataBlob* const blob = exporter.ExportToBlob(&scene, "glb2");
  if (!blob) throw std::runtime_error(path + ": cannot be made: " + exporter.GetErrorString());
  file.write(std::string_view(static_cast<const char*>(blob->data), blob->size));
  file.finish();
}

}  // namespace sulcus
