#include "app/python/simulation.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <pybind11/stl.h>

#include "app/python/arrays.hpp"
#include "app/session/frame_history.hpp"
#include "app/terminal/progress.hpp"
#include "engine/cache/load_cache.hpp"
#include "engine/core/error.hpp"
#include "engine/core/hash.hpp"
#include "engine/graphics/renderer.hpp"
#include "engine/scene/scene_file.hpp"
#include "haptics/c/c_values.hpp"

namespace sulcus::python {

namespace {

/// std::invalid_argument where 7 numbers are no pose.
Pose pose_of_numbers(const double* p) {
  const std::optional<Pose> pose = pose_from(std::span<const double, 7>(p, 7));
  if (!pose) {
    throw std::invalid_argument(
        "a pose with a number not finite, beyond 10 m (positions are in metres), or with an "
        "orientation (w, x, y, z) not of length 1");
  }
  return *pose;
}

void append(std::vector<double>& to, const Wrench& wrench) {
  to.insert(to.end(), wrench.force_N.data(), wrench.force_N.data() + 3);
  to.insert(to.end(), wrench.torque_Nm.data(), wrench.torque_Nm.data() + 3);
}

void append(std::vector<double>& to, const Pose& pose) {
  to.insert(to.end(), pose.position.data(), pose.position.data() + 3);
  to.push_back(pose.orientation.w());
  to.insert(to.end(), pose.orientation.vec().data(), pose.orientation.vec().data() + 3);
}

/// What `run` gives, tick after tick.
struct Trace {
  std::vector<std::uint64_t> tick;
  std::vector<double> time_s, device_pose, tool_pose, wrench, contact_wrench;
  std::vector<std::uint32_t> contacts, removed, faults;

  void add(const TickResult& result, double rate_hz) {
    tick.push_back(result.tick);
    time_s.push_back(static_cast<double>(result.tick) / rate_hz);
    append(device_pose, result.device);
    append(tool_pose, result.tool);
    append(wrench, result.sent);
    append(contact_wrench, result.contact.wrench);
    contacts.push_back(result.contact.contacts);
    removed.push_back(result.removed);
    faults.push_back(result.faults);
  }
  py::dict arrays() {
    const auto n = static_cast<py::ssize_t>(tick.size());
    py::dict all;
    all["tick"] = array_of(std::move(tick));
    all["time_s"] = array_of(std::move(time_s));
    all["device_pose"] = array_of(std::move(device_pose), {n, 7});
    all["tool_pose"] = array_of(std::move(tool_pose), {n, 7});
    all["wrench"] = array_of(std::move(wrench), {n, 6});
    all["contact_wrench"] = array_of(std::move(contact_wrench), {n, 6});
    all["contacts"] = array_of(std::move(contacts));
    all["removed"] = array_of(std::move(removed));
    all["faults"] = array_of(std::move(faults));
    return all;
  }
};

std::unique_ptr<SceneRun> load(const std::string& text, const std::vector<std::string>& overrides,
                               std::span<const std::uint8_t> voxels) {
  const bool is_text = text.find('\n') != std::string::npos;
  Scene scene = is_text ? parse_scene(text, "scene", overrides) : load_scene(text, overrides);
  const Progress progress("loading");
  std::optional<VoxelModel> own;
  if (!voxels.empty()) own = own_voxels(scene, voxels);
  LoadCache cache = LoadCache::of_user();
  SceneParts parts = load_parts(scene, std::move(own), &cache);
  return std::make_unique<SceneRun>(std::move(scene), std::move(parts));
}

/// Lets Ctrl-C end a long call, now and then.
class Interrupts {
 public:
  void look() {
    if (++calls_ % 64 != 0) return;
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(20)) return;
    last_ = now;
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }

 private:
  unsigned calls_ = 0;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

PythonSimulation::Turn::Turn(std::atomic_flag& taken) : taken_(taken) {
  if (taken.test_and_set(std::memory_order_acquire)) {
    throw std::runtime_error("another thread is using the simulation");
  }
}

PythonSimulation::PythonSimulation(const std::string& scene,
                                   const std::vector<std::string>& overrides,
                                   const std::optional<py::array>& given) {
  std::span<const std::uint8_t> own;
  Voxels voxels;
  if (given) {
    // Others would be wrapped or cut off to fit.
    const py::dtype type = given->dtype();
    if (type.kind() != 'b' && !(type.kind() == 'u' && type.itemsize() == 1)) {
      throw std::invalid_argument("voxels of type " +
                                  py::cast<std::string>(py::str(py::handle(type))) +
                                  ", expected uint8 or bool");
    }
    voxels = Voxels::ensure(*given);
    if (voxels.ndim() != 1 || voxels.size() == 0) {
      throw std::invalid_argument("voxels of another shape than (nx * ny * nz,), x fastest");
    }
    own = {voxels.data(), static_cast<std::size_t>(voxels.size())};
  }
  const py::gil_scoped_release release;
  run_ = load(scene, overrides, own);
}

void PythonSimulation::tick(const Pose* pose) {
  if (run_->has_ended()) throw std::runtime_error("a force was not finite: the run has ended");
  if (!pose && !run_->has_own_device()) {
    throw std::invalid_argument("the scene's device is a plug-in: give poses");
  }
  pose ? run_->step(*pose) : run_->step_scene();
  const EditLog& log = run_->edits();
  const std::uint64_t end = log.end();
  for (std::uint64_t n = std::max(log.begin(), edits_seen_); n < end; ++n) {
    edits_.push_back(edit_of(log[n]));
  }
  edits_seen_ = end;
}

Numbers PythonSimulation::step(const std::optional<Numbers>& pose) {
  Pose read;
  if (pose) {
    if (pose->size() != 7) throw std::invalid_argument("a pose is 7 numbers: x y z w x y z");
    read = pose_of_numbers(pose->data());
  }
  Wrench sent;
  {
    const py::gil_scoped_release release;
    const Turn turn(taken_);
    tick(pose ? &read : nullptr);
    sent = run_->last().sent;
  }
  Numbers wrench(6);
  double* const to = wrench.mutable_data();
  for (int a = 0; a < 3; ++a) {
    to[a] = sent.force_N[a];
    to[3 + a] = sent.torque_Nm[a];
  }
  return wrench;
}

py::dict PythonSimulation::run(const py::object& what) {
  const double rate_hz = run_->scene().haptics.rate_hz;
  std::vector<Pose> poses;
  std::uint64_t ticks = 0;
  if (what.is_none()) {
    const std::uint64_t all = run_->scene_ticks(), done = run_->state().tick;
    ticks = all > done ? all - done : 0;
  } else if (!py::isinstance<py::array>(what) && PyIndex_Check(what.ptr())) {
    int beyond = 0;  // 1: more than an integer of 64 bits holds, -1: less
    const long long asked = PyLong_AsLongLongAndOverflow(py::int_(what).ptr(), &beyond);
    if (beyond > 0) throw std::invalid_argument("more ticks than there can be");
    if (asked < 0) throw std::invalid_argument("fewer than no ticks");
    ticks = static_cast<std::uint64_t>(asked);
  } else {
    const Numbers rows = Numbers::ensure(what);
    if (!rows) throw std::invalid_argument("neither a number of ticks nor poses (n, 7)");
    if (rows.ndim() != 2 || rows.shape(1) != 7) {
      throw std::invalid_argument("poses of another shape than (n, 7)");
    }
    ticks = static_cast<std::uint64_t>(rows.shape(0));
    poses.reserve(ticks);
    for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
      poses.push_back(pose_of_numbers(rows.data() + 7 * i));
    }
  }
  const bool has_poses = !what.is_none() && !poses.empty();
  Trace trace;
  {
    const py::gil_scoped_release release;
    const Turn turn(taken_);
    Interrupts interrupts;
    for (std::uint64_t n = 0; n < ticks && !run_->has_ended(); ++n) {
      tick(has_poses ? &poses[n] : nullptr);
      trace.add(run_->last(), rate_hz);
      interrupts.look();
    }
  }
  return trace.arrays();
}

Numbers PythonSimulation::scene_pose(double time_s) const {
  if (!std::isfinite(time_s)) throw std::invalid_argument("a time not finite");
  std::vector<double> numbers;
  append(numbers, run_->trajectory().pose_at(time_s));
  return array_of(std::move(numbers));
}

py::array_t<SulcusContact> PythonSimulation::contacts() const {
  std::vector<SulcusContact> found;
  alone([&] {
    run_->for_each_contact([&](const FeltContact& felt) { found.push_back(contact_of(felt)); });
  });
  return array_of(std::move(found));
}

py::array_t<SulcusEdit> PythonSimulation::edits() const {
  return array_of(alone([&] { return edits_; }));
}

py::array_t<bool> PythonSimulation::volume() const {
  const Turn turn(taken_);
  return solid_array(run_->workpiece().model(), Lock::kLetGo);
}

py::array_t<std::uint8_t> PythonSimulation::packed_volume() const {
  const Turn turn(taken_);
  const VoxelModel& model = run_->workpiece().model();
  std::vector<std::uint8_t> bits(model.grid.cell_count() / 8);
  write_bits(model, bits);
  const Eigen::Vector3i n = model.grid.cells;
  return array_of(std::move(bits), {n.z(), n.y(), n.x() / 8});
}

Viewpoint viewpoint_of(const py::object& camera) {
  if (!py::isinstance<py::str>(camera)) {
    std::array<double, 2> angles{};
    try {
      angles = camera.cast<std::array<double, 2>>();
    } catch (const py::cast_error&) {
      throw py::type_error("a camera of another kind than a name or (azimuth, elevation)");
    }
    if (!std::isfinite(angles[0]) || !(std::abs(angles[1]) <= 90.0)) {
      throw std::invalid_argument("a camera of another kind than (azimuth, elevation) in degrees");
    }
    return {angles[0], angles[1]};
  }
  const auto name = camera.cast<std::string>();
  const auto found = std::ranges::find(kCameraNames, name);
  if (found == kCameraNames.end()) {
    throw std::invalid_argument("no camera '" + name +
                                "': review, occlusal, buccal, mesial, burr or two angles");
  }
  return static_cast<Camera>(found - kCameraNames.begin());
}

py::array_t<std::uint8_t> PythonSimulation::render(const py::object& camera, int width,
                                                   int height) const {
  if (width < 16 || height < 16 || width > 8192 || height > 8192) {
    throw std::invalid_argument("a picture that is not 16 to 8192 pixels wide and high");
  }
  const Viewpoint from = viewpoint_of(camera);
  Image image;
  {
    const py::gil_scoped_release release;
    const Turn turn(taken_);
    std::vector<VoxelModel> others;
    for (const Body& body : run_->state().others()) others.push_back(body.solid.model());
    RenderSettings settings = run_->scene().render.value_or(RenderSettings{});
    settings.width = width;
    settings.height = height;
    settings.hud = false;
    Renderer renderer(settings,
                      rendered_bodies(run_->scene(), run_->workpiece().model(), std::move(others)),
                      run_->burr().mesh_tool, run_->burr().head_length_m);
    renderer.set_viewpoint(from);
    renderer.set_hud(
        {.title = false, .figures = false, .arrows = settings.arrows, .scales = false});
    FrameState state;
    state.world_from_tool = run_->state().tool;
    state.force_N = run_->last().sent.force_N;
    state.torque_Nm = run_->last().sent.torque_Nm;
    image = renderer.draw(state);
  }
  return array_of(std::move(image.rgb), {image.height, image.width, 3});
}

std::uint64_t PythonSimulation::hash_of_edits(std::size_t count) const {
  return hash_bytes(edits_.data(), count * sizeof(SulcusEdit));
}

py::bytes PythonSimulation::save() {
  if (!run_->can_be_saved()) throw std::invalid_argument("a scene with [loose_pieces]");
  const std::vector<std::byte> saved = alone([&] {
    std::vector<std::byte> bytes = run_->saved();
    if (edits_.size() == run_->edits().end()) {
      edits_when_saved_[hash_bytes(bytes.data(), bytes.size())] = hash_of_edits(edits_.size());
    }
    return bytes;
  });
  return {reinterpret_cast<const char*>(saved.data()), saved.size()};
}

void PythonSimulation::restore(const py::bytes& bytes) {
  if (!run_->can_be_saved()) throw std::invalid_argument("a scene with [loose_pieces]");
  const auto text = static_cast<std::string>(bytes);
  alone([&] {
    const std::uint64_t before = run_->edits().end();
    run_->restore(std::as_bytes(std::span(text)));
    // Those of what is taken back are no more; of what is gone to on another way, unknown.
    const std::uint64_t now = run_->edits().end();
    const auto saved = edits_when_saved_.find(hash_bytes(text.data(), text.size()));
    if (now <= before && edits_.size() == before && saved != edits_when_saved_.end() &&
        saved->second == hash_of_edits(now)) {
      edits_.resize(now);
    } else {
      edits_.clear();
    }
    edits_seen_ = now;
  });
}

}  // namespace sulcus::python
