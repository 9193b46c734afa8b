// A run with the threads that stream it, and clients on threads of the test.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "app/session/session.hpp"
#include "app/session/simulation.hpp"
#include "app/stream/stream_port.hpp"
#include "engine/core/error.hpp"
#include "engine/core/fault.hpp"
#include "engine/recording/recording_reader.hpp"
#include "engine/scene/scene_file.hpp"
#include "engine/scene/trajectory.hpp"
#include "engine/shapes/build_shape.hpp"
#include "engine/surface/surface_mesh.hpp"
#include "engine/volume/edits.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/support/stream_reader.hpp"

namespace sulcus::stream_session_test {
namespace {

using test::ReadMessages, test::StreamReader;

// As in session_test.cpp.
const tbb::global_control kNoWorkers(tbb::global_control::max_allowed_parallelism, 1);

constexpr double kRate_hz = 1000.0;

/// The cut of small_scenes.hpp with tissues that are removed, every tick of it sent.
std::string streamed_scene(int port, const std::string& more = {}) {
  return test::cut_scene() +
         "[coupling]\nstiffness_N_per_mm = 20\nforce_limit_N = 20\n[stream]\nrate_hz = 1000\nport "
         "= " +
         std::to_string(port) + "\n" + more;
}

struct StreamedRun {
  explicit StreamedRun(const std::string& text) : scene(parse_scene(text, "test.toml")) {
    if (scene.stream) port = std::make_shared<StreamPort>(scene);
  }
  void run(const std::string& folder, Pace pace, std::uint64_t ticks = 400,
           const std::atomic<bool>* paused = nullptr) {
    const Trajectory trajectory = make_trajectory(scene.trajectory);
    Simulation simulation(scene, build_shape(scene), {},
                          make_burr(scene.burr, scene.workpiece.voxel_m));
    ScriptedDevice device(trajectory, scene.haptics.rate_hz);
    SessionOptions options;
    options.folder = folder;
    options.pace = pace;
    options.ticks = ticks;
    options.stream = port;
    options.paused = paused;
    result = run_session(simulation, device, options);
    port.reset();
  }
  Scene scene;
  std::shared_ptr<StreamPort> port;
  SessionResult result;
};

class StreamSession : public ::testing::Test {
 protected:
  std::string folder() const { return scratch_.path("out"); }
  RecordingReader recording() const { return RecordingReader(folder() + "/recording.h5"); }
  const ScratchFolder scratch_;
  const int port_ = test::free_tcp_port();
};

std::uint64_t tick_of(std::uint64_t stamp) {
  return static_cast<std::uint64_t>(
      std::llround(std::ldexp(static_cast<double>(stamp), -32) * kRate_hz));
}

/// By the protocol: 4 bits of prefix, then pairs of 6 bits of unit and 4 bits of exponent.
std::uint64_t unit_code(std::uint64_t prefix, std::uint64_t unit0, std::uint64_t exponent0,
                        std::uint64_t unit1 = 0, std::uint64_t exponent1 = 0) {
  return prefix << 60 | unit0 << 54 | exponent0 << 50 | unit1 << 44 | exponent1 << 40;
}

/// Of a unit quaternion, written down once more.
std::vector<double> rows_of_pose(const double (&p)[3], const double (&q)[4]) {
  const auto [w, x, y, z] = q;
  const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                          {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                          {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
  std::vector<double> rows;
  for (int i = 0; i < 3; ++i) {
    rows.insert(rows.end(), {r[i][0], r[i][1], r[i][2], static_cast<float>(p[i] * 1e3)});
  }
  return rows;
}

void expect_pose(const std::vector<double>& got, const std::vector<double>& expected) {
  ASSERT_EQ(got.size(), 12u);
  for (std::size_t i = 0; i < got.size(); ++i) {
    if (i % 4 == 3) {
      EXPECT_EQ(got[i], expected[i]);
    } else {
      EXPECT_NEAR(got[i], expected[i], 1e-7);  // float32
    }
  }
}

std::vector<double> six(const double (&a)[3], const double (&b)[3], double scale) {
  return {a[0] * scale, a[1] * scale, a[2] * scale, b[0] * scale, b[1] * scale, b[2] * scale};
}

/// All that a reader has got, against the rows and edits of the recording.
void expect_recorded(StreamReader& reader, const RecordingReader& recording, std::uint64_t ticks) {
  EXPECT_EQ(recording.missing(), "");
  const std::vector<TickRecord> rows = recording.ticks();
  const std::vector<CuttingRecord> cuts = recording.cutting();
  const std::vector<Edit> edits = recording.edits();
  EXPECT_GT(edits.size(), 50u);
  EXPECT_EQ(reader.bodies_refused, 0u);
  auto& devices = reader.devices;
  ASSERT_EQ(devices["Tick"].numbers.size(), ticks);
  for (std::size_t n = 0; n < ticks; ++n) {
    const auto tick = static_cast<std::size_t>(devices["Tick"].numbers[n].at(0));
    ASSERT_LT(tick, rows.size());
    if (n > 0) {
      EXPECT_GT(tick, devices["Tick"].numbers[n - 1][0]);
    }
    const TickRecord& row = rows[tick];
    for (const char* name :
         {"Tick", "ToolToScene", "HandToScene", "Force", "Torque", "Speed", "Removed"}) {
      EXPECT_EQ(tick_of(devices[name].stamps[n]), tick) << name;
      EXPECT_EQ(devices[name].numbers.size(), ticks) << name;
    }
    EXPECT_EQ(devices["Tick"].numbers[n],
              (std::vector<double>{static_cast<double>(row.tick), static_cast<double>(row.contacts),
                                   static_cast<double>(row.faults)}));
    EXPECT_EQ(devices["Force"].numbers[n], six(row.force_N, row.contact_force_N, 1.0));
    EXPECT_EQ(devices["Torque"].numbers[n], six(row.torque_Nm, row.contact_torque_Nm, 1e3));
    EXPECT_EQ(devices["Speed"].numbers[n], std::vector<double>{cuts[tick].spindle_rad_per_s});
    const auto removed = static_cast<double>(
        std::ranges::count_if(edits, [&](const Edit& edit) { return edit.tick <= tick; }));
    const double removed_m3 = removed * (0.05e-3 * 0.05e-3 * 0.05e-3);
    EXPECT_EQ(devices["Removed"].numbers[n], (std::vector<double>{removed_m3, removed_m3}));
    expect_pose(devices["ToolToScene"].numbers[n],
                rows_of_pose(row.tool_position_m, row.tool_orientation));
    expect_pose(devices["HandToScene"].numbers[n],
                rows_of_pose(row.device_position_m, row.device_orientation));
  }
}

/// What is told of a run of which every tick is sent.
std::vector<std::string> states_of(const std::vector<TickRecord>& rows) {
  std::vector<std::string> states{"running: running"};
  for (const TickRecord& row : rows) {
    std::string faults;
    for (const FaultInfo& fault : kFaults) {
      if (row.faults & fault.bit) faults += (faults.empty() ? "" : ", ") + std::string(fault.name);
    }
    const std::string state = faults.empty() ? "running: running" : "fault: " + faults;
    if (state != states.back()) states.push_back(state);
  }
  states.emplace_back("over: over");
  return states;
}

TEST_F(StreamSession, AClientReadsWhatIsRecorded) {
  for (const Pace pace : {Pace::kFast, Pace::kReal}) {
    StreamedRun run(streamed_scene(port_));
    StreamReader reader(port_);
    std::thread reads([&] { reader.read(); });
    run.run(folder(), pace);
    reads.join();
    expect_recorded(reader, recording(), 400);
    EXPECT_EQ(reader.devices["Force"].unit, unit_code(0, 0x0B, 1));
    EXPECT_EQ(reader.devices["Torque"].unit, unit_code(0xB, 0x0B, 1, 0x01, 1));
    EXPECT_EQ(reader.devices["Speed"].unit, unit_code(0, 0x08, 1, 0x03, 0xF));
    EXPECT_EQ(reader.devices["Removed"].unit, unit_code(0, 0x01, 3));
    EXPECT_EQ(reader.devices["Tick"].unit, 0u);
    const ReadMessages& state = reader.devices["State"];
    EXPECT_EQ(state.words, states_of(recording().ticks()));
    EXPECT_EQ(state.codes[state.codes.size() - 2], igtl::StatusMessage::STATUS_SHUT_DOWN);
    EXPECT_EQ(state.codes.back(), 399);
    EXPECT_EQ(run.result.stream->clients, 1u);
    EXPECT_EQ(run.result.stream->samples, 400u);
    EXPECT_EQ(run.result.stream->dropped, 0u);
  }
}

/// Rows of ticks but for the times of the machine, and all edits.
std::string what_was_done(const RecordingReader& reader) {
  std::string bytes;
  for (TickRecord row : reader.ticks()) {
    row.step_us = row.late_us = 0.0f;
    row.check = 0;
    bytes.append(reinterpret_cast<const char*>(&row), sizeof(row));
  }
  for (const Edit& edit : reader.edits()) {
    bytes += std::to_string(edit.tick) + " " + std::to_string(edit.voxel) + "\n";
  }
  const StateHash last = reader.state_hashes().back();
  return bytes + std::to_string(last.volume) + " " + std::to_string(last.state);
}

TEST_F(StreamSession, TheRunIsTheSameWithAndWithoutIt) {
  const std::string text = streamed_scene(port_);
  StreamedRun alone(text.substr(0, text.find("[stream]")));
  alone.run(folder(), Pace::kFast);
  EXPECT_FALSE(alone.result.stream);
  const std::string expected = what_was_done(recording());
  StreamedRun run(text);
  StreamReader reader(port_);
  reader.ask<igtl::GetPolyDataMessage>("");
  std::thread reads([&] { reader.read(); });
  run.run(folder(), Pace::kFast);
  reads.join();
  EXPECT_EQ(what_was_done(recording()), expected);
  EXPECT_TRUE(reader.surface);
}

/// The workpiece after the tick of a message.
VoxelModel model_at(const Scene& scene, const RecordingReader& recording, std::uint64_t stamp) {
  VoxelModel model = build_shape(scene);
  for (const Edit& edit : recording.edits()) {
    if (edit.tick <= tick_of(stamp)) apply_edit(edit, model);
  }
  return model;
}

void expect_surface(igtl::PolyDataMessage& message, const TriangleMesh& mesh) {
  auto points = message.GetPoints();
  auto polygons = message.GetPolygons();
  ASSERT_EQ(static_cast<std::size_t>(points->GetNumberOfPoints()), mesh.positions.size());
  ASSERT_EQ(polygons->GetNumberOfCells(), mesh.triangles.size());
  for (unsigned i = 0; i < mesh.positions.size(); ++i) {
    float p[3];
    points->GetPoint(i, p);
    for (int axis = 0; axis < 3; ++axis) ASSERT_EQ(p[axis], mesh.positions[i][axis] * 1e3f);
  }
  for (unsigned i = 0; i < mesh.triangles.size(); ++i) {
    ASSERT_EQ(polygons->GetCellSize(i), 3u);
    std::array<std::uint32_t, 3> corners;
    polygons->GetCell(i, corners.data());
    ASSERT_EQ(corners, mesh.triangles[i]);
  }
}

/// Each voxel of the image where its place in space says that it is.
void expect_voxels(igtl::ImageMessage& image, const VoxelModel& model) {
  int size[3];
  float spacing[3], origin[3];
  image.GetDimensions(size);
  image.GetSpacing(spacing);
  image.GetOrigin(origin);  // of its middle
  const auto* voxel = static_cast<const std::uint8_t*>(image.GetScalarPointer());
  std::uint64_t solid = 0;
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i, ++voxel) {
        const int at[3] = {i, j, k};
        Eigen::Vector3d p_world;
        for (int axis = 0; axis < 3; ++axis) {
          const double from_middle = at[axis] - 0.5 * (size[axis] - 1);
          p_world[axis] = 1e-3 * (static_cast<double>(origin[axis]) +
                                  from_middle * static_cast<double>(spacing[axis]));
        }
        const Eigen::Vector3d p_index = model.grid.index_from_world(p_world);
        const Cell c = p_index.array().round().cast<int>();
        ASSERT_LT((p_index - c.cast<double>()).norm(), 1e-3);
        ASSERT_EQ(*voxel, model.solid(c) ? 1 : 0);
        solid += *voxel;
      }
    }
  }
  EXPECT_EQ(solid, model.solid_count());
}

TEST_F(StreamSession, TheToothIsGivenToWhoAsks) {
  StreamedRun run(streamed_scene(port_));
  StreamReader reader(port_);
  std::thread reads([&] {
    reader.read(2000);  // till it has been cut
    reader.ask<igtl::GetPolyDataMessage>("Tooth");
    reader.ask<igtl::GetImageMessage>("");
    reader.ask<igtl::GetPolyDataMessage>("Nothing");
    reader.ask<igtl::GetTransformMessage>("Tooth");
    reader.ask<igtl::GetCapabilityMessage>("");
    reader.read();
  });
  run.run(folder(), Pace::kReal);
  reads.join();
  EXPECT_EQ(reader.bodies_refused, 0u);
  EXPECT_EQ(reader.without_body, 2u);
  EXPECT_EQ(reader.devices["Nothing"].type, "POLYDATA");
  const std::vector<std::string> types{"CAPABILITY", "IMAGE",  "POLYDATA",
                                       "SENSOR",     "STATUS", "TRANSFORM"};
  EXPECT_EQ(reader.devices[""].words, types);
  // The surface, the image, and that there is no transform of it.
  std::vector<std::uint64_t> stamps = reader.devices["Tooth"].stamps;
  ASSERT_EQ(stamps.size(), 3u);
  std::erase(stamps, std::uint64_t{0});
  ASSERT_EQ(stamps.size(), 2u);
  ASSERT_TRUE(reader.surface);
  ASSERT_TRUE(reader.image);
  const VoxelModel meshed = model_at(run.scene, recording(), stamps[0]);
  EXPECT_LT(meshed.solid_count(), build_shape(run.scene).solid_count());
  expect_surface(*reader.surface, closed_surface(meshed));
  expect_voxels(*reader.image, model_at(run.scene, recording(), stamps[1]));
}

TEST_F(StreamSession, AClientThatIsKilledCostsNothingAndTheNextOneIsServed) {
  StreamedRun run(streamed_scene(port_));
  StreamReader killed(port_);
  std::optional<StreamReader> next;
  std::thread reads([&] {
    killed.read(100);
    killed.hang_up();
    next.emplace(port_);
    next->read();
  });
  run.run(folder(), Pace::kReal);
  reads.join();
  EXPECT_EQ(recording().missing(), "");
  EXPECT_EQ(recording().tick_count(), 400u);
  const std::size_t got = next->devices["Tick"].numbers.size();
  EXPECT_GT(got, 0u);
  expect_recorded(*next, recording(), got);
  EXPECT_EQ(next->devices["Tick"].numbers.back()[0], 399.0);  // to the last one
  EXPECT_EQ(run.result.stream->clients, 2u);
}

TEST_F(StreamSession, AClientThatNeverReadsHoldsNothingUp) {
  StreamedRun run(streamed_scene(port_));
  const StreamReader deaf(port_);
  StreamReader reader(port_);
  std::thread reads([&] { reader.read(); });
  constexpr std::uint64_t kTicks = 8000;  // 10 MB: more than the system takes for it
  run.run(folder(), Pace::kFast, kTicks);
  reads.join();
  EXPECT_EQ(recording().missing(), "");
  EXPECT_EQ(recording().tick_count(), kTicks);
  EXPECT_EQ(run.result.stream->samples, 2 * kTicks);
  EXPECT_GT(run.result.stream->dropped, 1000u);
  EXPECT_EQ(reader.devices["State"].words.back(), "over: over");
  expect_recorded(reader, recording(), reader.devices["Tick"].numbers.size());
}

TEST_F(StreamSession, NonsenseOfOneClientDoesNotReachTheOthers) {
  StreamedRun run(streamed_scene(port_));
  StreamReader reader(port_);
  std::thread reads([&] { reader.read(); });
  std::atomic<bool> over{false};
  std::thread talks([&] {
    std::mt19937 random(3);
    while (!over) {
      StreamReader hostile(port_);
      if (!hostile.is_connected()) break;  // the run is over
      std::string bytes(1 + random() % 3000, '\0');
      for (char& byte : bytes) byte = static_cast<char>(random());
      // At times a header that says how large a body is to come.
      if (random() % 2 == 0) bytes.replace(0, 14, std::string("\0\1GET_POLYDATA", 14));
      hostile.ask(bytes);
      if (random() % 2 == 0) hostile.hang_up();
    }
  });
  run.run(folder(), Pace::kReal);
  over = true;
  talks.join();
  reads.join();
  expect_recorded(reader, recording(), 400);
  EXPECT_GT(run.result.stream->clients, 5u);
}

TEST_F(StreamSession, WhoAsksWithoutEndIsAnsweredInTurn) {
  StreamedRun run(streamed_scene(port_));
  StreamReader reader(port_);
  for (int i = 0; i < 1000; ++i) {
    reader.ask<igtl::GetPolyDataMessage>("Tooth");
    reader.ask<igtl::GetImageMessage>("Tooth");
  }
  std::thread reads([&] { reader.read(); });
  run.run(folder(), Pace::kFast);
  reads.join();
  EXPECT_TRUE(reader.surface);
  EXPECT_TRUE(reader.image);
  EXPECT_LT(reader.devices["Tooth"].stamps.size(), 100u);
}

TEST_F(StreamSession, ItSaysThatItIsPaused) {
  StreamedRun run(test::cut_scene() + "[stream]\nport = " + std::to_string(port_) + "\n");
  StreamReader reader(port_);
  std::atomic<bool> paused{true};
  std::thread reads([&] {
    reader.read(2);  // that it runs, that it is paused
    EXPECT_EQ(reader.devices["State"].words.back(), "paused: paused");
    paused = false;
    reader.read();
  });
  run.run(folder(), Pace::kReal, 400, &paused);
  reads.join();
  const std::vector<std::string> expected{"running: running", "paused: paused", "running: running",
                                          "over: over"};
  EXPECT_EQ(reader.devices["State"].words, expected);
}

TEST_F(StreamSession, APortThatIsTakenIsRefused) {
  const Scene scene = parse_scene(streamed_scene(port_), "test.toml");
  const StreamPort taken(scene);
  try {
    const StreamPort again(scene);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("stream.port: found 127.0.0.1:"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace sulcus::stream_session_test
