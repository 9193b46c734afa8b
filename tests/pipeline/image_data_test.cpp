#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <png.h>

#include "app/playback/edit_cursor.hpp"
#include "app/playback/recorded_contacts.hpp"
#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/png_file.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::image_data_test {
namespace {

constexpr double kAt_s = 0.3;
constexpr int kWidth = 200, kHeight = 150;

/// Pictures for data sets, of a small recording with a goal.
class ImageData : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string goal =
        "[goal]\nshape = 'box'\nsize_mm = [0.6, 0.4, 0.2]\nposition_mm = [0, 0, 0.9]\n";
    const auto result = command("run " + scratch_.write("s.toml", test::cut_scene() + goal) +
                                " --no-render -o " + scratch_.path("run"));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  test::CommandResult command(const std::string& arguments) {
    return test::sulcus_command(arguments, scratch_.path("err"));
  }
  std::string recording() const { return scratch_.path("run/recording.h5"); }
  test::CommandResult render(const std::string& options, const std::string& folder = "drawn") {
    return command("render " + recording() + " --size 200x150 -o " + scratch_.path(folder) + ' ' +
                   options);
  }
  /// The list of pictures of one time and the kinds that are asked for.
  nlohmann::json list(const std::string& options) {
    const auto result = render("--at 0.3 " + options);
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(test::read_file(result.out.substr(0, result.out.find(": "))));
  }
  std::string file(const nlohmann::json& picture, const char* kind) const {
    return scratch_.path("drawn/" + picture.at(kind).get<std::string>());
  }
  VoxelModel model() const {
    const RecordingReader reader(recording());
    VoxelModel model = reader.workpiece();
    const std::vector<TickRecord> rows = reader.ticks();
    std::size_t row = 0;
    while (row + 1 < rows.size() && rows[row + 1].time_s <= kAt_s + 1e-9) ++row;
    for (const Edit& edit : recorded_edits(reader, row)) {
      model.set(model.grid.cell_of_linear(edit.voxel), false);
    }
    return model;
  }

  ScratchFolder scratch_;
};

/// As it is in the file: 8 or 16 bits, rows from the top.
template <class Number>
std::vector<Number> numbers_of_png(const std::string& file, png_uint_32 format) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&png, file.c_str()), 0) << file << png.message;
  EXPECT_EQ(png.format & PNG_FORMAT_FLAG_LINEAR, sizeof(Number) == 2 ? PNG_FORMAT_FLAG_LINEAR : 0u);
  png.format = format;
  std::vector<Number> numbers(PNG_IMAGE_SIZE(png) / sizeof(Number));
  EXPECT_NE(png_image_finish_read(&png, nullptr, numbers.data(), 0, nullptr), 0) << png.message;
  return numbers;
}

/// A picture's camera, by what the list says of it alone.
struct Camera {
  explicit Camera(const nlohmann::json& picture)
      : f(picture.at("f")), cx(picture.at("cx")), cy(picture.at("cy")) {
    for (int i = 0; i < 16; ++i) {
      scene_from_camera(i / 4, i % 4) = picture.at("scene_from_camera_mm").at(i);
    }
  }
  Eigen::Vector3d point_mm(double u, double v, double depth_mm) const {
    const Eigen::Vector4d p((u - cx) / f * depth_mm, (v - cy) / f * depth_mm, depth_mm, 1.0);
    return (scene_from_camera * p).head<3>();
  }
  double depth_mm(const Eigen::Vector3d& point_mm) const {
    const Eigen::Vector3d from_camera = point_mm - scene_from_camera.topRightCorner<3, 1>();
    return scene_from_camera.block<3, 1>(0, 2).dot(from_camera);
  }

  double f, cx, cy;
  Eigen::Matrix4d scene_from_camera;
};

/// The depth at which a ray comes into the first solid voxel, by small steps through all of the
/// ball that the grid lies in.
std::optional<double> first_voxel_mm(const VoxelModel& model, const Camera& camera, double u,
                                     double v) {
  const Eigen::Vector3d cells = model.grid.cells.cast<double>();
  const Eigen::Vector3d middle_mm = 1e3 * model.grid.world_from_index(0.5 * cells);
  const double radius_mm = 0.5e3 * model.grid.voxel_m * (cells.norm() + 2.0);
  const double middle_depth_mm = camera.depth_mm(middle_mm);
  for (double depth = middle_depth_mm - radius_mm; depth < middle_depth_mm + radius_mm;
       depth += 0.002) {
    const Eigen::Vector3d p = model.grid.index_from_world(1e-3 * camera.point_mm(u, v, depth));
    const Cell c = (p.array() + 0.5).floor().cast<int>();
    if (model.grid.contains(c) && model.solid(c)) return depth;
  }
  return {};
}

TEST_F(ImageData, DepthAndLabelsAreThoseOfTheVolumeAtThatTime) {
  const nlohmann::json all = list("--kind depth,labels --no-tool --camera occlusal");
  ASSERT_EQ(all.at("pictures").size(), 1u);
  const nlohmann::json& picture = all.at("pictures").at(0);
  const auto depth = numbers_of_png<std::uint16_t>(file(picture, "depth"), PNG_FORMAT_LINEAR_Y);
  const auto labels = numbers_of_png<std::uint8_t>(file(picture, "labels"), PNG_FORMAT_GRAY);
  ASSERT_EQ(depth.size(), static_cast<std::size_t>(kWidth * kHeight));
  const Camera camera(picture);
  const double step_mm = all.at("depth_mm_per_step"), voxel_mm = 0.05;
  const VoxelModel now = model();
  int met = 0, off = 0, cut = 0;
  for (int v = 1; v < kHeight; v += 4) {
    for (int u = 1; u < kWidth; u += 4) {
      const auto pixel = static_cast<std::size_t>(v * kWidth + u);
      const std::optional<double> hit = first_voxel_mm(now, camera, u, v);
      EXPECT_EQ(labels[pixel] == 255, depth[pixel] == 0);
      if (hit.has_value() != (depth[pixel] != 0)) {
        // The outline is rounded: a ray a voxel aside tells otherwise, or it is off.
        const double voxel = voxel_mm * camera.f / hit.value_or(step_mm * depth[pixel]);
        bool at_outline = false;
        for (const auto& [du, dv] :
             {std::pair{-voxel, 0.0}, {voxel, 0.0}, {0.0, -voxel}, {0.0, voxel}}) {
          at_outline = at_outline ||
                       first_voxel_mm(now, camera, u + du, v + dv).has_value() != hit.has_value();
        }
        if (!at_outline) ++off;
        continue;
      }
      if (!hit) continue;
      ++met;
      EXPECT_EQ(labels[pixel], 0);
      // Half a voxel away in any direction: beside a wall a ray down to the floor meets the rim.
      double low = *hit, high = *hit;
      const double aside = 0.5 * voxel_mm * camera.f / *hit;
      for (const auto& [du, dv] :
           {std::pair{-aside, 0.0}, {aside, 0.0}, {0.0, -aside}, {0.0, aside}}) {
        const std::optional<double> beside = first_voxel_mm(now, camera, u + du, v + dv);
        low = std::min(low, beside.value_or(low));
        high = std::max(high, beside.value_or(high));
      }
      const double drawn = step_mm * depth[pixel];
      if (drawn < low - 0.5 * voxel_mm || drawn > high + 0.5 * voxel_mm) ++off;
      cut += camera.point_mm(u, v, *hit).z() < 0.95;
    }
  }
  EXPECT_GT(met, 300);
  EXPECT_GT(cut, 10) << "the way of the burr is seen";
  EXPECT_LE(off, met / 100) << "of " << met;
  // The burr has a label of its own, and the table names it.
  const nlohmann::json with = list("--kind labels --camera occlusal --no-handpiece");
  const auto seen =
      numbers_of_png<std::uint8_t>(file(with.at("pictures").at(0), "labels"), PNG_FORMAT_GRAY);
  EXPECT_GT(std::ranges::count(seen, 254), 50);
  const auto& table = with.at("labels");
  EXPECT_NE(std::ranges::find(table, nlohmann::json{{"label", 254}, {"name", "burr"}}),
            table.end());
}

TEST_F(ImageData, ContactIsWhereTheTickHadIt) {
  const nlohmann::json all = list("--kind depth,contact --no-tool --camera occlusal");
  const nlohmann::json& picture = all.at("pictures").at(0);
  const auto depth = numbers_of_png<std::uint16_t>(file(picture, "depth"), PNG_FORMAT_LINEAR_Y);
  const auto contact = numbers_of_png<std::uint8_t>(file(picture, "contact"), PNG_FORMAT_GRAY);
  RecordedContacts contacts(recording(), false);
  const RecordingReader reader(recording());
  const std::vector<TickRecord> rows = reader.ticks();
  contacts.seek_row(row_at(rows, kAt_s));
  ASSERT_FALSE(contacts.marks().empty());
  const Camera camera(picture);
  const double step_mm = all.at("depth_mm_per_step");
  int seen = 0;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const auto pixel = static_cast<std::size_t>(v * kWidth + u);
      if (contact[pixel] == 0) continue;
      EXPECT_EQ(contact[pixel], 255);
      ++seen;
      const Eigen::Vector3d p = 1e-3 * camera.point_mm(u, v, step_mm * depth[pixel]);
      double nearest = 1.0;
      for (const ContactMark& mark : contacts.marks()) {
        nearest = std::min(nearest, (mark.centre_world - p).norm());
      }
      EXPECT_LT(nearest, 1.5 * 0.05e-3);
    }
  }
  EXPECT_GT(seen, 5);
}

TEST_F(ImageData, OneFileHoldsAllKindsOfPairsOverTime) {
  const auto result = render("--data " + scratch_.path("all.h5") +
                             " --fps 20 --from 0.1 --to 0.3 --stereo 2 --camera 30,60");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("10 pictures of 5 kinds"), std::string::npos) << result.out;
  // Read by another program; the disparity of matched points is f b / depth.
  const std::string script = scratch_.write("read.py", R"(
import h5py, numpy as np, sys
f = h5py.File(sys.argv[1])
l, r = f['30_60'], f['30_60_right']
assert l['colour'].shape == (5, 150, 200, 3) and l['colour'].dtype == 'u1'
assert l['normals'].shape == (5, 150, 200, 3) and l['depth_mm'].shape == (5, 150, 200)
assert np.allclose(f['time_s'][:], [0.1, 0.15, 0.2, 0.25, 0.3], atol=2e-3), f['time_s'][:]
names = {int(row['label']): row['name'] for row in f['labels']}
assert set(np.unique(l['labels'])) <= set(names) and names[255] == b'background'
a, b = l['scene_from_camera_mm'][0], r['scene_from_camera_mm'][0]
assert np.allclose(b[:3, 3] - a[:3, 3], 2 * a[:3, 0], atol=1e-5)
assert np.allclose(a[:3, :3] @ a[:3, :3].T, np.eye(3), atol=1e-6) and np.linalg.det(a) > 0.99
z, n = l['depth_mm'][0], l['normals'][0]
there = z > 0
assert np.allclose(np.linalg.norm(n[there], axis=1), 1, atol=1e-3) and (n[~there] == 0).all()
v, u = np.nonzero(there)
at = u - l.attrs['f'] * l.attrs['baseline_mm'] / z[v, u]
low = np.floor(at).astype(int)
ok = (low >= 0) & (low + 1 < 200)
v, at, low, d = v[ok], at[ok], low[ok], z[v[ok], u[ok]]
part = at - low
other = (1 - part) * r['depth_mm'][0][v, low] + part * r['depth_mm'][0][v, low + 1]
share = np.mean(np.abs(other - d) < 0.025)
assert len(d) > 2000 and share > 0.9, (len(d), share)
)");
  const auto read = test::program_command(
      "/usr/bin/python3", script + ' ' + scratch_.path("all.h5"), scratch_.path("python"));
  EXPECT_EQ(read.status, 0) << read.err;
}

TEST_F(ImageData, PicturesOfAGoalAreCutOpenAndHaveOneScale) {
  const auto picture = [&](const std::string& options) {
    const auto result = render("--at 0.3 --colour-by goal " + options, "goal");
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out.substr(0, result.out.find('\n'));
  };
  const std::string usual = picture("");
  EXPECT_NE(usual.find("_by_goal_y=0.png"), std::string::npos) << usual;
  EXPECT_EQ(picture("--camera occlusal").find("y=0"), std::string::npos);
  EXPECT_EQ(picture("--section none").find("y=0"), std::string::npos);
  const auto bytes = [](const std::string& file) { return test::read_file(file); };
  EXPECT_EQ(bytes(picture("--scale 0.5")), bytes(usual));
  EXPECT_NE(bytes(picture("--scale 0.1")), bytes(usual));
  EXPECT_NE(bytes(picture("--ghost")), bytes(usual));
  EXPECT_NE(bytes(picture("--no-tool")), bytes(usual));
}

TEST_F(ImageData, PicturesReplacePictures) {
  const std::string options = "--at 0.3 --data " + scratch_.path("p.h5");
  EXPECT_EQ(render(options).status, 0);
  EXPECT_EQ(render(options).status, 0);
}

TEST_F(ImageData, TheSmallestPictureIsDrawnWithItsFigures) {
  const auto result = command("render " + recording() + " --size 16x16 -o " + scratch_.path("p"));
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST_F(ImageData, WhatCannotBeIsRefused) {
  const auto refused = [&](const std::string& options, const std::string& says) {
    const auto result = render(options);
    EXPECT_EQ(result.status, 2) << options;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
  };
  refused("--kind depth,heat", "--kind");
  refused("--kind depth --sheet " + scratch_.path("x.png"), "--sheet");
  refused("--stereo 2 --video " + scratch_.path("x.mp4"), "--video");
  refused("--scale 1", "--colour-by goal");
  refused("--from 0.1", "--fps");
  refused("--fps 5 --from 0.2 --to 0.1", "--to");
  refused("--fps 5 --to 100", "--to");
  refused("--data " + scratch_.path("x.txt"), "--data");
  const std::string before = test::read_file(recording());
  refused("--data " + recording(), "--data");
  EXPECT_EQ(test::read_file(recording()), before) << "nothing recorded is lost";
  refused("--section y=99", "something to cut open");
  refused("--at 100", "--at");
  refused("--at=-1", "--at");
}

}  // namespace
}  // namespace sulcus::image_data_test
