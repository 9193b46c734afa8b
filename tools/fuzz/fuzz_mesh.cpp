#include <algorithm>

#include "engine/import/meshes/mesh_file.hpp"
#include "tools/fuzz/fuzz_targets.hpp"
#include "tools/fuzz/handed_file.hpp"

namespace sulcus::fuzz {

void fuzz_mesh(Bytes bytes) {
  if (bytes.empty()) return;
  const char* name = bytes[0] == 's' ? "a.stl" : bytes[0] == 'o' ? "a.obj" : "a.ply";
  const HandedFile file(bytes.subspan(1), name);
  constexpr InputLimits kLimits{.memory_bytes = std::uint64_t{64} << 20};
  TriangleMesh mesh;
  if (!reads([&] { mesh = read_mesh(file.path(), kLimits); })) return;
  expect(std::ranges::all_of(mesh.positions, [](const auto& p) { return p.allFinite(); }),
         "a vertex that is not finite");
  for (const auto& triangle : mesh.triangles) {
    expect(std::ranges::all_of(triangle, [&](auto v) { return v < mesh.positions.size(); }),
           "a corner that is no vertex");
  }
}

}  // namespace sulcus::fuzz
