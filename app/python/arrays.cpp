#include "app/python/arrays.hpp"

#include <memory>
#include <optional>

namespace sulcus::python {

py::array_t<bool> solid_array(const VoxelModel& model, Lock lock) {
  const Eigen::Vector3i n = model.grid.cells;
  const auto count = static_cast<std::size_t>(model.grid.cell_count());
  auto values = std::make_unique<bool[]>(count);
  {
    std::optional<py::gil_scoped_release> release;
    if (lock == Lock::kLetGo) release.emplace();
    for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
      const LeafBits& bits = model.leaves[leaf];
      if (!any(bits)) continue;
      const Cell first = model.grid.leaf_origin(leaf);
      for (int place = 0; place < 512; ++place) {
        if (bits.has(place)) values[model.grid.linear(first + cell_in_leaf(place))] = true;
      }
    }
  }
  bool* const data = values.get();
  const py::capsule owner(values.release(), [](void* p) { delete[] static_cast<bool*>(p); });
  const auto nx = static_cast<py::ssize_t>(n.x()), ny = static_cast<py::ssize_t>(n.y());
  return py::array_t<bool>({nx, ny, static_cast<py::ssize_t>(n.z())}, {py::ssize_t{1}, nx, nx * ny},
                           data, owner);
}

}  // namespace sulcus::python
