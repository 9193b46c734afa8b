#include "app/python/recording.hpp"

#include <cmath>
#include <stdexcept>

#include "app/playback/recorded_film.hpp"
#include "app/python/arrays.hpp"
#include "app/python/simulation.hpp"
#include "app/report/assessment.hpp"
#include "engine/core/error.hpp"
#include "engine/graphics/renderer.hpp"
#include "engine/scene/scene_file.hpp"

namespace sulcus::python {

PythonRecording::PythonRecording(const std::string& path)
    : path_(path),
      reader_(path),
      scene_(recorded_scene(reader_, path)),
      shape_(reader_, recorded_workpiece(reader_, scene_)) {
  if (rows().empty()) throw InputError(path, "/ticks", "no rows", "one at least");
}

py::array_t<TickRecord> PythonRecording::ticks() const { return array_of(shape_.rows()); }

std::size_t PythonRecording::row_at(double time_s) const {
  const double first_s = rows().front().time_s;
  const double end_s = rows().back().time_s + 1.0 / reader_.header().rate_hz;
  if (!(time_s >= first_s && time_s <= end_s)) {
    throw std::out_of_range("no time of the recording: it has " + std::to_string(first_s) + " to " +
                            std::to_string(end_s) + " s");
  }
  // A time said in decimals is a rounding before its tick's.
  constexpr double kRounding = 1e-6;  // of a tick
  return shape_.row_at(time_s + kRounding / reader_.header().rate_hz);
}

const VoxelModel& PythonRecording::model_at(std::size_t row) {
  (void)shape_.seek_row(row);
  return shape_.model();
}

py::array_t<std::uint8_t> PythonRecording::render(std::size_t row, const py::object& camera,
                                                  int width, int height) const {
  if (width < 16 || height < 16 || width > 8192 || height > 8192) {
    throw std::invalid_argument("a picture that is not 16 to 8192 pixels wide and high");
  }
  const Viewpoint from = viewpoint_of(camera);
  Image image;
  {
    const py::gil_scoped_release release;
    const RecordingReader reader(path_);
    RecordedFilm film(reader, path_);
    RenderSettings settings = film.scene().render.value_or(RenderSettings{});
    settings.width = width;
    settings.height = height;
    Renderer renderer(settings, film.bodies(), film.burr().mesh_tool, film.burr().head_length_m);
    renderer.set_viewpoint(from);
    renderer.set_hud(
        {.title = false, .figures = false, .arrows = settings.arrows, .scales = false});
    image = renderer.draw(film.seek_row(row, renderer));
  }
  return array_of(std::move(image.rgb), {image.height, image.width, 3});
}

std::string PythonRecording::assess(const std::optional<std::string>& limits) const {
  const bool is_text = limits && limits->find('\n') != std::string::npos;
  const std::string file = limits ? (is_text ? "assessment" : *limits) : path_;
  const std::string text = !limits ? scene_.text : (is_text ? *limits : read_scene_text(*limits));
  const auto settings = assessment_of(text, file);
  if (!settings) {
    throw InputError(file, "[assessment]", "none", "one in the scene, or limits given");
  }
  const py::gil_scoped_release release;
  return assessment_json(assess_recording(reader_, path_, *settings));
}

}  // namespace sulcus::python
