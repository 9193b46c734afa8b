#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/recording/recording_reader.hpp"
#include "engine/recording/recording_writer.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::bad_files_test {
namespace {

using test::sulcus_command;

std::string bytes_of(auto value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

/// A tetrahedron of edge 1 mm; `triangles` of it, `announced` in the header.
std::string stl(std::uint32_t announced = 4, int triangles = 4, bool flipped = false,
                float height = 1.0f) {
  const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, height}};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::string file = std::string(80, ' ') + bytes_of(announced);
  for (int f = 0; f < triangles; ++f) {
    file += std::string(12, '\0');
    for (int c = 0; c < 3; ++c) {
      for (const float x : corners[faces[f][flipped ? 2 - c : c]]) file += bytes_of(x);
    }
    file += std::string(2, '\0');
  }
  return file;
}

std::string nrrd(const std::string& sizes, const std::string& data,
                 const std::string& type = "uchar") {
  return "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: " + sizes +
         "\nendian: little\nencoding: raw\nspacings: 0.5 0.5 0.5\n\n" + data;
}

constexpr const char* kPoses = "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";

/// The whole error stream, less the folder of the test.
struct Refused {
  int status = -1;
  std::string says;
};

Refused refused(const ScratchFolder& scratch, const std::string& arguments) {
  const auto result = sulcus_command(arguments, scratch.path("err"));
  std::string says = result.err;
  const std::string folder = scratch.path("");
  for (std::size_t at; (at = says.find(folder)) != std::string::npos;)
    says.erase(at, folder.size());
  return {result.status, says};
}

TEST(BadFiles, AreRefusedByRunAndInspectInTheSameLine) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const struct {
    const char* name;
    std::string contents;
    const char* says;
  } cases[] = {
      {"announced.stl", stl(100000000),
       "triangle count: found 100000000 in a file of 284 bytes, expected 5000000084 bytes for "
       "them"},
      {"few.stl", stl(1, 1), "found 1 triangles, expected at least 4"},
      {"nan.stl", stl(4, 4, false, nan),
       "triangle 1: found a coordinate of nan, expected a finite one within 1 km"},
      {"range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\nf 1 2 3\nf 1 2 3\nf 1 2 3\n",
       "line 4: found vertex 9, expected 1 to 3 or -1 to -3"},
      {"overflow.nrrd", nrrd("4294967296 4294967296 4294967297", ""),
       "sizes: found 4294967296 x 4294967296 x 4294967297 voxels, expected at most 1073741824 "
       "(--limit-gib)"},
      {"cut.nrrd", nrrd("8 8 8", "short"),
       "data: found 5 bytes, expected 512 bytes after the header"},
  };
  for (const auto& bad : cases) {
    SCOPED_TRACE(bad.name);
    const ScratchFolder scratch;
    const std::string scene = scratch.write("s.toml", test::probe_scene());
    const std::string file = scratch.write(bad.name, bad.contents);
    const std::string line = "sulcus: " + std::string(bad.name) + ": " + bad.says + "\n";
    const Refused run = refused(
        scratch, "run " + scene + " --set workpiece.file=" + file + " -o " + scratch.path("out"));
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(run.says, line);
    const Refused inspect = refused(scratch, "inspect " + file);
    EXPECT_EQ(inspect.status, 2);
    EXPECT_EQ(inspect.says, line);
  }
}

TEST(BadFiles, TheLimitIsRaisedByAnOption) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", test::probe_scene());
  scratch.write("a.nrrd", nrrd("100 100 100", std::string(1000000, '\1')));
  const std::string run =
      "run " + scene + " --duration 0.01 --set workpiece.file=" + scratch.path("a.nrrd") +
      " --set workpiece.spacing_mm=[0.02,0.02,0.02] -o " + scratch.path("out") + " --limit-gib ";
  const Refused little = refused(scratch, run + "0.001");
  EXPECT_EQ(little.status, 2);
  EXPECT_EQ(little.says,
            "sulcus: a.nrrd: sizes: found 100 x 100 x 100 voxels, expected at most 268435 "
            "(--limit-gib)\n");
  const Refused enough = refused(scratch, run + "0.01");
  EXPECT_EQ(enough.status, 0) << enough.says;
  EXPECT_EQ(refused(scratch, run + "0").status, 2);
}

TEST(BadFiles, AVolumeOfOneValueIsEmptyOrABlock) {
  const ScratchFolder scratch;
  const std::string scene = scratch.write("s.toml", test::probe_scene());
  const auto run = [&](const std::string& file) {
    return refused(scratch, "run " + scene + " --duration 0.01 --set workpiece.file=" + file +
                                " --set workpiece.box={} -o " + scratch.path("out"));
  };
  const Refused zeros = run(scratch.write("zeros.nrrd", nrrd("4 4 4", std::string(64, '\0'))));
  EXPECT_EQ(zeros.status, 2);
  EXPECT_EQ(zeros.says,
            "sulcus: zeros.nrrd: data: found grey values from 0 to 0, expected a mask with some "
            "above 0\n");
  const Refused ones = run(scratch.write("ones.nrrd", nrrd("4 4 4", std::string(64, '\1'))));
  EXPECT_EQ(ones.status, 0) << ones.says;
  const auto inspected =
      sulcus_command("inspect " + scratch.path("ones.nrrd"), scratch.path("err"));
  EXPECT_NE(inspected.out.find("voxels above 0   64 (8.000 mm3)"), std::string::npos)
      << inspected.out;
  const Refused high =
      refused(scratch, "run " + scene + " --set workpiece.file=" + scratch.path("ones.nrrd") +
                           " --set workpiece.solid_above=600 -o " + scratch.path("out"));
  EXPECT_EQ(high.says,
            "sulcus: ones.nrrd: solid_above: found grey values from 1 to 1, expected some at or "
            "above 600\n");
}

TEST(BadFiles, OpenAndFlippedMeshesAreTakenAndInspectTells) {
  const ScratchFolder scratch;
  const auto inspect = [&](const std::string& contents) {
    const auto result =
        sulcus_command("inspect " + scratch.write("a.stl", contents), scratch.path("err"));
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  };
  EXPECT_NE(inspect(stl()).find("volume           0.167 mm3\nopen edges       0 (closed)\n"),
            std::string::npos);
  EXPECT_NE(inspect(stl(4, 4, true)).find("volume           -0.167 mm3\nopen edges       0"),
            std::string::npos);
  // Two tetrahedra, of which one lacks its last face.
  std::string open = stl(7) + stl(3, 3).substr(84);
  for (std::size_t at = 84 + 200; at < open.size(); at += 50) {
    for (int c = 0; c < 3; ++c) {
      float x = 0;
      std::memcpy(&x, open.data() + at + 12 + 12 * c, sizeof x);
      x += 5.0f;
      std::memcpy(open.data() + at + 12 + 12 * c, &x, sizeof x);
    }
  }
  EXPECT_NE(inspect(open).find("open edges       3\n"), std::string::npos) << inspect(open);
}

TEST(BadFiles, TrajectoriesAreRefusedWithTheirLine) {
  const struct {
    const char *rows, *says;
  } cases[] = {
      {"", "found no poses, expected at least one row"},
      {"0,,0,0,1,0,0,0\n",
       "line 2: found '0,,0,0,1,0,0,0', expected 8 finite numbers t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz"},
      {"0,nan,0,0,1,0,0,0\n",
       "line 2: found '0,nan,0,0,1,0,0,0', expected 8 finite numbers "
       "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz"},
      {"1,0,0,9,1,0,0,0\n0.5,0,0,9,1,0,0,0\n",
       "line 3: found t_s = 0.500000, expected times that rise"},
  };
  const std::string points =
      "points_mm = [[-0.6, 0, 1.2], [-0.6, 0, 0.92], [0.6, 0, 0.92], "
      "[0.6, 0, 1.2]]";
  std::string text = test::probe_scene();
  ASSERT_NE(text.find(points), std::string::npos);
  text.replace(text.find(points), points.size(), "file = 'poses.csv'");
  for (const auto& bad : cases) {
    const ScratchFolder scratch;
    const std::string scene = scratch.write("s.toml", text);
    scratch.write("poses.csv", std::string(kPoses) + bad.rows);
    const Refused run = refused(scratch, "run " + scene + " -o " + scratch.path("out"));
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(run.says, "sulcus: poses.csv: " + std::string(bad.says) + "\n");
  }
}

/// A short cut that has been recorded, and recordings made of its rows.
class BadRecordings : public testing::Test {
 protected:
  void SetUp() override {
    const std::string scene = scratch_.write("s.toml", test::cut_scene());
    const auto result = sulcus_command(
        "run " + scene + " --duration 0.1 -o " + scratch_.path("out"), scratch_.path("err"));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  Refused with(const std::function<void(RecordingHeader&, std::vector<TickRecord>&)>& change,
               const std::string& command = "replay --verify ") const {
    const RecordingReader reader(scratch_.path("out/recording.h5"));
    RecordingHeader header = reader.header();
    std::vector<TickRecord> rows = reader.ticks();
    change(header, rows);
    for (TickRecord& row : rows) seal(row);
    const std::string path = scratch_.path("changed.h5");
    RecordingWriter writer(path, header, reader.workpiece(), nullptr);
    writer.append_edits(reader.edits());
    writer.append_ticks(rows);
    writer.close();
    return refused(scratch_, command + path);
  }

  ScratchFolder scratch_;
};

TEST_F(BadRecordings, NoRows) {
  for (const char* command : {"replay ", "render ", "export --csv rows.csv "}) {
    const Refused none = with([](auto&, auto& rows) { rows.clear(); }, command);
    EXPECT_EQ(none.status, 2);
    EXPECT_EQ(none.says, "sulcus: changed.h5: /ticks: found no rows, expected at least one tick\n");
  }
}

TEST_F(BadRecordings, TimeRunningBackward) {
  const Refused back = with([](auto&, auto& rows) { rows[50].tick = rows[48].tick; });
  EXPECT_EQ(back.status, 1) << "half of it cannot be looked at";
  EXPECT_NE(back.says.find("row 50 of /ticks does not follow on the one before it"),
            std::string::npos)
      << back.says;
}

TEST_F(BadRecordings, AGap) {
  const Refused gap = with([](auto&, auto& rows) { rows.erase(rows.begin() + 50); });
  EXPECT_EQ(gap.status, 1) << "half of it cannot be looked at";
  EXPECT_NE(gap.says.find("row 50 of /ticks does not follow on the one before it"),
            std::string::npos)
      << gap.says;
}

TEST_F(BadRecordings, AnotherBuild) {
  const Refused other = with([](auto& header, auto& rows) {
    header.build = "another one";
    rows[50].contacts += 1;
  });
  EXPECT_EQ(other.status, 1);
  EXPECT_EQ(other.says.substr(other.says.find(": tick")),
            ": tick 50 differs in contacts (recorded by another build, another one)\n");
}

}  // namespace
}  // namespace sulcus::bad_files_test
