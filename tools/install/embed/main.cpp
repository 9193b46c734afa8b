// A device of one's own on the haptic core: a round burr sinks 0.1 mm into a ball of 3 mm and cuts.
#include <cstdio>
#include <optional>
#include <utility>
#include <vector>

#include "engine/shapes/build_shape.hpp"
#include "haptics/tick.hpp"

class MyDevice : public sulcus::Device {  // in its place: a driver that reads a hand
 public:
  std::optional<sulcus::Pose> pose(std::uint64_t tick) noexcept override {
    const double tip_z_m = 3.05e-3 - 0.15e-6 * static_cast<double>(tick);
    return sulcus::Pose{{0, 0, tip_z_m}, sulcus::orientation_along(Eigen::Vector3d::UnitZ())};
  }
  void apply(const sulcus::Wrench& wrench) noexcept override { felt = wrench; }
  sulcus::Wrench felt;
};

int main() {
  sulcus::Scene scene;  // as a file would say it, in SI units; every value here has a default
  scene.workpiece.shape = sulcus::ShapeKind::kSphere;
  scene.workpiece.cells = {192, 192, 192};
  scene.tissues.resize(1);
  scene.cutting.emplace();

  std::vector<sulcus::Workpiece> bodies;  // the workpiece, and then those beside it
  bodies.emplace_back(sulcus::build_shape(scene));
  const sulcus::Burr burr = sulcus::make_burr(scene.burr, scene.workpiece.voxel_m);
  const sulcus::TickContext context{scene, burr};
  sulcus::SimulationState state = sulcus::initial_state(scene, std::move(bodies));
  sulcus::TickScratch scratch(scene);
  MyDevice device;
  for (int tick = 1; tick <= 1000; ++tick) {  // nothing in a tick allocates, waits or throws
    const sulcus::TickResult result = sulcus::tick(context, device, state, scratch);
    if (tick % 100 != 0) continue;
    std::printf("%4d ms  %4u voxels in contact  %.3f N up, %llu voxels left\n", tick,
                result.contact.contacts, device.felt.force_N.z(),
                static_cast<unsigned long long>(state.workpiece().solid.solid_voxels()));
  }
}
