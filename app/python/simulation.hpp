#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>

#include "engine/graphics/camera.hpp"
#include "haptics/c/scene_run.hpp"
#include "haptics/c/sulcus.h"

namespace sulcus::python {

namespace py = pybind11;

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Voxels = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>;

/// `sulcus.Simulation`. The interpreter's lock is free during its calls; a second thread in any of
/// them is refused (std::runtime_error).
class PythonSimulation {
 public:
  /// `scene`: a file, or, with a line break in it, the text of one; `given`: the workpiece's
  /// voxels, uint8 or bool. InputError as the importers.
  PythonSimulation(const std::string& scene, const std::vector<std::string>& overrides,
                   const std::optional<py::array>& given);

  Numbers step(const std::optional<Numbers>& pose);
  py::dict run(const py::object& what);

  /// What `question` finds in the run between two ticks.
  template <class Question>
  auto ask(const Question& question) const {
    const Turn turn(taken_);
    return question(std::as_const(*run_));
  }
  Numbers scene_pose(double time_s) const;
  py::array_t<SulcusContact> contacts() const;
  py::array_t<SulcusEdit> edits() const;
  py::array_t<bool> volume() const;
  py::array_t<std::uint8_t> packed_volume() const;
  py::array_t<std::uint8_t> render(const py::object& camera, int width, int height) const;
  py::bytes save();
  void restore(const py::bytes& bytes);

 private:
  /// Of one thread; std::runtime_error where another has it.
  class Turn {
   public:
    explicit Turn(std::atomic_flag& taken);
    ~Turn() { taken_.clear(std::memory_order_release); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    std::atomic_flag& taken_;
  };
  template <class Call>
  auto alone(const Call& call) const {
    const Turn turn(taken_);
    return call();
  }
  void tick(const Pose* pose);
  std::uint64_t hash_of_edits(std::size_t count) const;

  std::unique_ptr<SceneRun> run_;
  std::vector<SulcusEdit> edits_;  // all of the run
  std::uint64_t edits_seen_ = 0;   // of the run's log
  // Of what was saved here, by the hash of its bytes: the hash of the edits that had led to it.
  std::map<std::uint64_t, std::uint64_t> edits_when_saved_;
  mutable std::atomic_flag taken_ = ATOMIC_FLAG_INIT;
};

/// A camera by its name, or by azimuth and elevation in degrees.
Viewpoint viewpoint_of(const py::object& camera);

}  // namespace sulcus::python
