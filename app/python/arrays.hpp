#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <pybind11/numpy.h>

#include "engine/volume/voxel_model.hpp"

namespace sulcus::python {

namespace py = pybind11;

/// A NumPy array that owns what a vector held; nothing is copied. `shape`: its product is the
/// vector's size.
template <class T>
py::array_t<T> array_of(std::vector<T> values, std::vector<py::ssize_t> shape) {
  auto* const kept = new std::vector<T>(std::move(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
  return py::array_t<T>(std::move(shape), kept->data(), owner);
}
template <class T>
py::array_t<T> array_of(std::vector<T> values) {
  const auto size = static_cast<py::ssize_t>(values.size());
  return array_of(std::move(values), {size});
}

/// Whether the interpreter's lock is let go of meanwhile: only where something else keeps other
/// threads from the model.
enum class Lock : std::uint8_t { kHeld, kLetGo };

/// Which voxels are solid, bool, by [i, j, k] along x, y and z.
py::array_t<bool> solid_array(const VoxelModel& model, Lock lock);

}  // namespace sulcus::python
