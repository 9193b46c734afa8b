#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pybind11/numpy.h>

#include "app/playback/recorded_run.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/recording/tick_record.hpp"

namespace sulcus::python {

namespace py = pybind11;

/// `sulcus.Recording`: a recording gone through by time. Under the interpreter's lock.
class PythonRecording {
 public:
  /// InputError as RecordingReader; also of one without rows.
  explicit PythonRecording(const std::string& path);

  const RecordingReader& reader() const { return reader_; }
  const std::vector<TickRecord>& rows() const { return shape_.rows(); }
  py::array_t<TickRecord> ticks() const;
  /// The row of a time, s; std::out_of_range where that is none of the recording.
  std::size_t row_at(double time_s) const;
  /// The workpiece right after a row.
  const VoxelModel& model_at(std::size_t row);
  py::array_t<std::uint8_t> render(std::size_t row, const py::object& camera, int width,
                                   int height) const;
  /// As assessment.json. `limits`: a file with [assessment], or the text of one; none: the scene's.
  std::string assess(const std::optional<std::string>& limits) const;

 private:
  std::string path_;
  RecordingReader reader_;
  Scene scene_;
  RecordedShape shape_;
};

/// A time of a recording.
struct Moment {
  std::shared_ptr<PythonRecording> recording;
  std::size_t row = 0;

  const TickRecord& record() const { return recording->rows()[row]; }
};

}  // namespace sulcus::python
