// `import sulcus`: what Python sees, with its docstrings. app/python/sulcus.pyi says the same to
// checkers of types.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "app/build_info.hpp"
#include "app/python/arrays.hpp"
#include "app/python/recording.hpp"
#include "app/python/simulation.hpp"
#include "engine/core/error.hpp"
#include "engine/core/hash.hpp"

namespace sulcus::python {

namespace {

/// A path-like object or a text.
std::string text_of(const py::object& path) {
  return py::module_::import("os").attr("fspath")(path).cast<std::string>();
}

py::object from_json(const std::string& text) {
  return py::module_::import("json").attr("loads")(text);
}

Numbers pose_array(const double (&position)[3], const double (&orientation)[4]) {
  Numbers pose(7);
  std::copy_n(position, 3, pose.mutable_data());
  std::copy_n(orientation, 4, pose.mutable_data() + 3);
  return pose;
}
Numbers wrench_array(const double (&force)[3], const double (&torque)[3]) {
  Numbers wrench(6);
  std::copy_n(force, 3, wrench.mutable_data());
  std::copy_n(torque, 3, wrench.mutable_data() + 3);
  return wrench;
}

/// What a run is asked for between ticks.
void add_what_there_is(py::class_<PythonSimulation>& simulation) {
  simulation
      .def_property_readonly(
          "volume_hash",
          [](const PythonSimulation& s) {
            return hex(s.ask([](const SceneRun& run) { return run.volume_hash(); }));
          },
          "Of the workpiece's voxels as they are: the text of summary.json.")
      .def_property_readonly(
          "force_hash",
          [](const PythonSimulation& s) {
            return hex(s.ask([](const SceneRun& run) { return run.force_hash(); }));
          },
          "Of all wrenches so far: the text of summary.json.")
      .def_property_readonly(
          "state_hash",
          [](const PythonSimulation& s) {
            return hex(s.ask([](const SceneRun& run) { return run.state().hash(); }));
          },
          "Of all else that a later tick depends on.")
      .def_property_readonly("volume", &PythonSimulation::volume,
                             "(nx, ny, nz) bool, the workpiece's solid voxels as they are; a copy.")
      .def_property_readonly(
          "packed_volume", &PythonSimulation::packed_volume,
          R"((nz, ny, nx / 8) uint8: the same, 8 voxels a byte along x, the lowest
bit first (numpy.unpackbits with bitorder="little").)")
      .def_property_readonly("contacts", &PythonSimulation::contacts,
                             R"((n,) of the last tick: position_m (3), normal (3, unit, out of the
tooth), depth_m, force_N along it, voxel (x + y nx + z nx ny), body (0: the workpiece), tissue.)")
      .def_property_readonly(
          "edits", &PythonSimulation::edits,
          R"((n,) every voxel that changed so far: tick, voxel, body, cause (0 cut,
1 loose), level (0: gone; else what is left, of 255).)")
      .def_property_readonly(
          "tick",
          [](const PythonSimulation& s) {
            return s.ask([](const SceneRun& run) { return run.state().tick; });
          },
          "Number of the next tick.")
      .def_property_readonly(
          "ticks",
          [](const PythonSimulation& s) {
            return s.ask([](const SceneRun& run) { return run.scene_ticks(); });
          },
          "Ticks that the scene's trajectory has.")
      .def_property_readonly(
          "rate_hz",
          [](const PythonSimulation& s) {
            return s.ask([](const SceneRun& run) { return run.scene().haptics.rate_hz; });
          })
      .def_property_readonly(
          "voxel_m",
          [](const PythonSimulation& s) {
            return s.ask([](const SceneRun& run) { return run.workpiece().grid().voxel_m; });
          })
      .def_property_readonly(
          "origin_m",
          [](const PythonSimulation& s) {
            const Eigen::Vector3d p = s.ask([](const SceneRun& run) {
              return run.workpiece().grid().centre_world(Cell::Zero());
            });
            return array_of(std::vector<double>{p.x(), p.y(), p.z()});
          },
          "(3,) centre of voxel (0, 0, 0), world.");
}

void define_simulation(py::module_& module) {
  py::class_<PythonSimulation> simulation(module, "Simulation", R"(A scene run tick by tick.

The same bits as `sulcus run`. One thread at a time; the interpreter's lock is free during all calls.

scene: path of a scene, or, with a line break in it, the text of one.
set: texts KEY=VALUE that change the scene, as --set.
voxels: (nx * ny * nz,) uint8, x fastest; the workpiece instead of the scene's, on its grid:
    0 empty, else 1 + the number of the tissue.

ValueError, in one line, where the scene or a file of it cannot be used.)");
  add_what_there_is(simulation);
  simulation
      .def(py::init([](const py::object& scene, const std::vector<std::string>& set,
                       const std::optional<py::array>& voxels) {
             return std::make_unique<PythonSimulation>(text_of(scene), set, voxels);
           }),
           py::arg("scene"), py::kw_only(), py::arg("set") = std::vector<std::string>{},
           py::arg("voxels") = py::none())
      .def("step", &PythonSimulation::step, py::arg("pose") = py::none(),
           R"(One tick: a pose in, the wrench for the hand out.

pose: (7,) x, y, z of the burr's tip, m, then the orientation w, x, y, z, world from tool (its +y is
    the axis from tip to shank); None: the scene's own device.
Returns (6,): force, N, and torque about the burr's reference point, N m, world axes.)")
      .def(
          "run", &PythonSimulation::run, py::arg("ticks_or_poses") = py::none(),
          R"(Many ticks: the rest of the scene's trajectory (None), so many (an int), or one for each
of poses (n, 7). Ctrl-C ends it; what was done stays done.

Returns a dict of arrays by tick: tick, time_s (n,), device_pose, tool_pose (n, 7), wrench (n, 6) sent,
contact_wrench (n, 6) before limits and coupling, contacts, removed (voxels), faults (bits) (n,).)")
      .def("scene_pose", &PythonSimulation::scene_pose, py::arg("time_s"),
           "(7,) where the scene's trajectory has the tip at a time.")
      .def("render", &PythonSimulation::render, py::arg("camera") = "review",
           py::arg("width") = 1280, py::arg("height") = 720,
           R"(A picture of now: (height, width, 3) uint8, sRGB. camera: review, occlusal, buccal,
mesial, burr, or (azimuth, elevation) in degrees. Needs no display. RuntimeError where nothing can
draw.)")
      .def("save", &PythonSimulation::save,
           "bytes of all of the run as it is; not with [loose_pieces].")
      .def("restore", &PythonSimulation::restore, py::arg("state"),
           "Back to a save of the same scene. ValueError, and nothing changed, for other bytes.");
}

void define_recording(py::module_& module) {
  py::class_<Moment>(module, "Moment", "A time of a recording.")
      .def_property_readonly("tick", [](const Moment& m) { return m.record().tick; })
      .def_property_readonly("time_s", [](const Moment& m) { return m.record().time_s; })
      .def_property_readonly(
          "wrench",
          [](const Moment& m) { return wrench_array(m.record().force_N, m.record().torque_Nm); },
          "(6,) sent to the hand, N and N m.")
      .def_property_readonly(
          "contact_wrench",
          [](const Moment& m) {
            return wrench_array(m.record().contact_force_N, m.record().contact_torque_Nm);
          },
          "(6,) of the contact, before limits and coupling.")
      .def_property_readonly(
          "device_pose",
          [](const Moment& m) {
            return pose_array(m.record().device_position_m, m.record().device_orientation);
          },
          "(7,) x, y, z of the tip, m; w, x, y, z.")
      .def_property_readonly(
          "tool_pose",
          [](const Moment& m) {
            return pose_array(m.record().tool_position_m, m.record().tool_orientation);
          },
          "(7,) of the tool.")
      .def_property_readonly("contacts", [](const Moment& m) { return m.record().contacts; })
      .def_property_readonly("removed", [](const Moment& m) { return m.record().removed; })
      .def_property_readonly("faults", [](const Moment& m) { return m.record().faults; })
      .def_property_readonly(
          "volume",
          [](const Moment& m) { return solid_array(m.recording->model_at(m.row), Lock::kHeld); },
          "(nx, ny, nz) bool: the workpiece right after the tick.")
      .def(
          "render",
          [](const Moment& m, const py::object& camera, int width, int height) {
            return m.recording->render(m.row, camera, width, height);
          },
          py::arg("camera") = "review", py::arg("width") = 1280, py::arg("height") = 720,
          "A picture of then: (height, width, 3) uint8, as Simulation.render.");

  py::class_<PythonRecording, std::shared_ptr<PythonRecording>>(
      module, "Recording",
      "A recording.h5 by time: recording[t] is the last tick at or before t seconds.")
      .def(py::init([](const py::object& path) {
             return std::make_shared<PythonRecording>(text_of(path));
           }),
           py::arg("path"))
      .def(
          "__getitem__",
          [](const std::shared_ptr<PythonRecording>& r, double time_s) {
            return Moment{r, r->row_at(time_s)};
          },
          py::arg("time_s"), "The tick at a time, s. IndexError where the recording has none.")
      .def(
          "__len__", [](const PythonRecording& r) { return r.rows().size(); }, "Ticks.")
      .def_property_readonly("ticks", &PythonRecording::ticks,
                             "(n,) all rows of /ticks, with its names and units.")
      .def_property_readonly("rate_hz",
                             [](const PythonRecording& r) { return r.reader().header().rate_hz; })
      .def(
          "assess",
          [](const PythonRecording& r, const std::optional<py::object>& limits) {
            return from_json(r.assess(limits ? std::optional(text_of(*limits)) : std::nullopt));
          },
          py::arg("limits") = py::none(),
          R"(What an examiner measures: the dict of assessment.json. limits: path, or text, of TOML
with [assessment]; None: the scene's.)");
}

}  // namespace

}  // namespace sulcus::python

PYBIND11_MODULE(sulcus, module) {
  namespace py = pybind11;
  using namespace sulcus;          // NOLINT
  using namespace sulcus::python;  // NOLINT
  module.doc() =
      "Sulcus, a real-time dental cutting simulator: scenes run, recordings read, pictures drawn.\n"
      "SI units; world: the scene's, +z up; poses (x, y, z, w, x, y, z) of the burr's tip.";
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& why) {
      PyErr_SetString(PyExc_ValueError, why.what());
    }
  });
  PYBIND11_NUMPY_DTYPE(SulcusContact, position_m, normal, depth_m, force_N, voxel, body, tissue);
  PYBIND11_NUMPY_DTYPE(SulcusEdit, tick, voxel, body, cause, level);
  PYBIND11_NUMPY_DTYPE(TickRecord, tick, time_s, device_position_m, device_orientation,
                       tool_position_m, tool_orientation, force_N, torque_Nm, contact_force_N,
                       contact_torque_Nm, contacts, tested, leaves, removed, step_us, late_us,
                       faults, edits_end, check);
  module.attr("__version__") = build_info();
  define_simulation(module);
  define_recording(module);
}
