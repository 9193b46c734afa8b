#include "app/session/rendered_bodies.hpp"

#include <utility>

namespace sulcus {

std::vector<RenderedBody> rendered_bodies(const Scene& scene, VoxelModel workpiece,
                                          std::vector<VoxelModel> bodies) {
  std::vector<TissueLook> looks;
  for (const TissueSettings& tissue : scene.tissues) looks.push_back({tissue.name, tissue.colour});
  std::vector<RenderedBody> rendered{{std::move(workpiece), looks, {}}};
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodySettings& body = scene.bodies[i];
    rendered.push_back({std::move(bodies[i]),
                        body.tissue ? std::vector{looks[*body.tissue]} : looks,
                        body.world_from_grid});
  }
  return rendered;
}

}  // namespace sulcus
