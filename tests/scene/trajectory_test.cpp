#include "engine/scene/trajectory.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "engine/core/error.hpp"

namespace sulcus::trajectory_test {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
namespace fs = std::filesystem;

Trajectory along(std::vector<Vector3d> points_m, double speed_m_per_s = 2e-3) {
  TrajectorySettings settings;
  settings.points_m = std::move(points_m);
  settings.speed_m_per_s = speed_m_per_s;
  return make_trajectory(settings);
}

Quaterniond about_z(double angle_rad) {
  return Quaterniond(Eigen::AngleAxisd(angle_rad, Vector3d::UnitZ()));
}

TEST(Trajectory, GoesAtConstantSpeedAroundCorners) {
  const Trajectory t = along({{0, 0, 0}, {4e-3, 0, 0}, {4e-3, 3e-3, 0}, {0, 3e-3, 0}});
  EXPECT_DOUBLE_EQ(t.duration_s(), 5.5);
  for (int ms = 0; ms < 5500; ms += 250) {
    const Vector3d a = t.pose_at(ms * 1e-3).position, b = t.pose_at((ms + 1) * 1e-3).position;
    EXPECT_NEAR((b - a).norm(), 2e-6, 1e-15) << ms;
  }
  EXPECT_TRUE(t.pose_at(2.0).position.isApprox(Vector3d(4e-3, 0, 0), 1e-12));
  EXPECT_TRUE(t.pose_at(2.75).position.isApprox(Vector3d(4e-3, 1.5e-3, 0), 1e-12));
}

TEST(Trajectory, RestsBeforeAndAfter) {
  const Trajectory t = along({{1e-3, 0, 0}, {2e-3, 0, 0}});
  EXPECT_EQ(t.pose_at(-1.0).position, Vector3d(1e-3, 0, 0));
  EXPECT_EQ(t.pose_at(0.0).position, Vector3d(1e-3, 0, 0));
  EXPECT_EQ(t.pose_at(t.duration_s()).position, Vector3d(2e-3, 0, 0));
  EXPECT_EQ(t.pose_at(1e9).position, Vector3d(2e-3, 0, 0));
}

TEST(Trajectory, OfOnePointRestsThere) {
  const Trajectory t = along({{1e-3, 2e-3, 3e-3}});
  EXPECT_EQ(t.duration_s(), 0.0);
  EXPECT_EQ(t.pose_at(0.5).position, Vector3d(1e-3, 2e-3, 3e-3));
}

TEST(Trajectory, APointSaidTwiceTakesNoTime) {
  const Trajectory t = along({{0, 0, 0}, {0, 0, 0}, {2e-3, 0, 0}, {2e-3, 0, 0}});
  EXPECT_DOUBLE_EQ(t.duration_s(), 1.0);
  EXPECT_TRUE(t.pose_at(0.5).position.isApprox(Vector3d(1e-3, 0, 0), 1e-12));
}

TEST(Trajectory, TheShankPointsAlongTheAxis) {
  for (const Vector3d& axis :
       {Vector3d(0, 0, 1), Vector3d(0, 1, 0), Vector3d(0, -1, 0), Vector3d(1, 2, 3).normalized()}) {
    TrajectorySettings settings;
    settings.points_m = {Vector3d(0, 0, 0), Vector3d(1, 0, 0)};
    settings.axis = axis;
    const Pose pose = make_trajectory(settings).pose_at(0.3);
    EXPECT_NEAR(pose.orientation.norm(), 1.0, 1e-14);
    EXPECT_TRUE(pose.direction(Vector3d::UnitY()).isApprox(axis, 1e-12)) << axis.transpose();
  }
}

TEST(Trajectory, OrientationsTurnTheShortWay) {
  // The second is said by the opposite quaternion, which is the same rotation.
  const Quaterniond from = about_z(0.2), to = about_z(0.8);
  const Quaterniond opposite(-to.w(), -to.x(), -to.y(), -to.z());
  const Trajectory t({{0.0, {Vector3d::Zero(), from}}, {1.0, {Vector3d::Zero(), opposite}}});
  for (double time_s = 0.0; time_s <= 1.0; time_s += 0.125) {
    const Quaterniond q = t.pose_at(time_s).orientation;
    EXPECT_NEAR(q.norm(), 1.0, 1e-14);
    EXPECT_NEAR(q.angularDistance(from) + q.angularDistance(to), 0.6, 1e-7) << time_s;
  }
  EXPECT_NEAR(t.pose_at(0.5).orientation.angularDistance(about_z(0.5)), 0.0, 1e-7);
}

TEST(Trajectory, GivenPosesAreMet) {
  const Trajectory t({{0.0, {Vector3d(1, 0, 0), about_z(0.0)}},
                      {0.5, {Vector3d(2, 0, 0), about_z(0.3)}},
                      {2.0, {Vector3d(2, 3, 0), about_z(1.3)}}});
  EXPECT_TRUE(t.pose_at(0.5).position.isApprox(Vector3d(2, 0, 0), 1e-15));
  EXPECT_NEAR(t.pose_at(0.5).orientation.angularDistance(about_z(0.3)), 0.0, 1e-7);
  EXPECT_TRUE(t.pose_at(1.25).position.isApprox(Vector3d(2, 1.5, 0), 1e-15));
}

class TrajectoryFile : public ::testing::Test {
 protected:
  void SetUp() override {
    file_ = (fs::path(::testing::TempDir()) /
             ("sulcus_" + std::to_string(getpid()) +
              ::testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv"))
                .string();
  }
  void TearDown() override { fs::remove(file_); }

  Trajectory read(const std::string& text) const {
    std::ofstream(file_, std::ios::binary) << text;
    TrajectorySettings settings;
    settings.file = file_;
    return make_trajectory(settings);
  }
  /// The message for rows under a good header, less the file's name.
  std::string error_of_rows(const std::string& rows) const { return error_of(kHeader + rows); }
  std::string error_of(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      const std::string message = error.what();
      return message.starts_with(file_ + ": ") ? message.substr(file_.size() + 2) : message;
    }
    return "no error";
  }

  static inline const std::string kHeader = "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
  std::string file_;
};

TEST_F(TrajectoryFile, GivesItsPosesInMetres) {
  const Trajectory t = read(kHeader + "0,1,2,3,1,0,0,0\n0.5,3,2,1,0,0,0,1\n");
  EXPECT_EQ(t.duration_s(), 0.5);
  EXPECT_TRUE(t.pose_at(0.0).position.isApprox(Vector3d(1e-3, 2e-3, 3e-3), 1e-14));
  EXPECT_TRUE(t.pose_at(0.25).position.isApprox(Vector3d(2e-3, 2e-3, 2e-3), 1e-14));
  EXPECT_NEAR(t.pose_at(0.5).orientation.z(), 1.0, 1e-15);
}

TEST_F(TrajectoryFile, ItsClockNeedNotStartAtZero) {
  const Trajectory t = read(kHeader + "100,0,0,0,1,0,0,0\n102,4,0,0,1,0,0,0\n");
  EXPECT_EQ(t.duration_s(), 2.0);
  EXPECT_TRUE(t.pose_at(1.0).position.isApprox(Vector3d(2e-3, 0, 0), 1e-14));
}

TEST_F(TrajectoryFile, LineEndsMayBeThoseOfWindows) {
  EXPECT_EQ(read("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\r\n0,0,0,0,1,0,0,0\r\n\r\n1,0,0,0,1,0,0,0\r\n")
                .duration_s(),
            1.0);
}

TEST_F(TrajectoryFile, ALastLineWithoutAnEndCounts) {
  EXPECT_EQ(read(kHeader + "0,0,0,0,1,0,0,0\n3,0,0,0,1,0,0,0").duration_s(), 3.0);
}

TEST_F(TrajectoryFile, QuaternionsAreMadeUnit) {
  const Trajectory t = read(kHeader + "0,0,0,0,0.995,0,0,0\n");
  EXPECT_NEAR(t.pose_at(0).orientation.norm(), 1.0, 1e-15);
}

TEST_F(TrajectoryFile, EachKindOfBadRowIsRefusedWithItsLine) {
  const std::string numbers = "8 finite numbers t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz";
  const std::string good = "0,0,0,0,1,0,0,0\n";
  const auto expect_form = [&](const std::string& row) {
    EXPECT_EQ(error_of_rows(good + row + "\n"), "line 3: found '" + row + "', expected " + numbers);
  };
  expect_form("1,0,0,0,1,0,0");       // one too few
  expect_form("1,0,0,0,1,0,0,0,0");   // one too many
  expect_form("1,0,0,0,1,0,0,0,");    // a comma too many
  expect_form("1,,0,0,1,0,0,0");      // a gap
  expect_form("1,0,0,zero,1,0,0,0");  // a word
  expect_form("1,0,0,0,1,0,0,0 mm");  // more after the number
  expect_form("1;0;0;0;1;0;0;0");     // another separator
  expect_form("1,nan,0,0,1,0,0,0");   // not finite
  expect_form("1,0,inf,0,1,0,0,0");
  expect_form("1,0,1e999,0,1,0,0,0");  // beyond a double
}

TEST_F(TrajectoryFile, WhatSpreadsheetsPutAboutTheNumbersMeansNothing) {
  // The mark before UTF-8, blanks, comments, other columns, another order.
  const Trajectory t = read(
      "\xef\xbb\xbf# of the morning\r\nname, qw,qx , qy,qz,z_mm,y_mm,x_mm,t_s\r\n"
      "a, 1,0,0,0, 3,2,1,  0\r\n\r\n  # a pause\nb,1, 0,0,0,\t6,4,2,2\n");
  EXPECT_EQ(t.duration_s(), 2.0);
  EXPECT_TRUE(t.pose_at(1.0).position.isApprox(Vector3d(1.5e-3, 3e-3, 4.5e-3), 1e-14));
  EXPECT_EQ(error_of("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,note\n0,0,0,0,1,0,0,0\n"),
            "line 2: found '0,0,0,0,1,0,0,0', expected 9 fields, as the first line has, finite "
            "numbers among them");
}

TEST_F(TrajectoryFile, TheColumnsOfAnExportAreKnown) {
  const std::string tool = "tool_x_mm,tool_y_mm,tool_z_mm,tool_qw,tool_qx,tool_qy,tool_qz";
  const std::string device =
      "device_x_mm,device_y_mm,device_z_mm,device_qw,device_qx,device_qy,device_qz";
  EXPECT_EQ(read("tick,time_s," + tool + "\n7,0,1,0,0,1,0,0,0\n").pose_at(0).position,
            Vector3d(1e-3, 0, 0));
  // The device's go before the tool's, which hangs on it.
  EXPECT_EQ(read("time_s," + tool + "," + device + "\n0,1,0,0,1,0,0,0,2,0,0,1,0,0,0\n")
                .pose_at(0)
                .position,
            Vector3d(2e-3, 0, 0));
}

TEST_F(TrajectoryFile, AColumnThatIsMissingOrThereTwiceIsNamed) {
  EXPECT_EQ(error_of("t_s,x_mm,y_mm,qw,qx,qy,qz\n"),
            "line 1: found no column z_mm, expected t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz");
  EXPECT_EQ(error_of("t_s,x_mm,x_mm,y_mm,z_mm,qw,qx,qy,qz\n"),
            "line 1: found x_mm twice, expected one column of that name");
}

TEST_F(TrajectoryFile, ItsClockIsKept) {
  EXPECT_EQ(read(kHeader + "0.5,0,0,0,1,0,0,0\n").clock_at_start_s(), 0.5);
  EXPECT_EQ(read(kHeader + "0,0,0,0,1,0,0,0\n").clock_at_start_s(), 0.0);
}

TEST_F(TrajectoryFile, TimeMustRise) {
  EXPECT_EQ(error_of_rows("0,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n"),
            "line 4: found t_s = 1.000000, expected times that rise");
  EXPECT_EQ(error_of_rows("0,0,0,0,1,0,0,0\n-1,0,0,0,1,0,0,0\n"),
            "line 3: found t_s = -1.000000, expected times that rise");
}

TEST_F(TrajectoryFile, AQuaternionMustBeARotation) {
  EXPECT_EQ(error_of_rows("0,0,0,0,0.5,0.5,0,0\n"),
            "line 2: found a quaternion of length 0.707107, expected a unit quaternion "
            "qw,qx,qy,qz (1 % off at most)");
  EXPECT_NE(error_of_rows("0,0,0,0,0,0,0,0\n"), "no error");
  EXPECT_NE(error_of_rows("0,0,0,0,1e200,0,0,0\n"), "no error");
}

TEST_F(TrajectoryFile, AWrongOrMissingHeaderIsRefused) {
  EXPECT_EQ(error_of("x,y,z\n0,0,0\n"),
            "line 1: found 'x,y,z', expected t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz");
  EXPECT_EQ(error_of(""), "line 1: found '', expected t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz");
  EXPECT_EQ(error_of(kHeader), "found no poses, expected at least one row");
}

TEST_F(TrajectoryFile, LongRowsAreShortenedInTheMessage) {
  std::string long_line(100000, '7');
  long_line += '\n';  // GCC 12 sees an overrun in operator+ here
  EXPECT_LT(error_of_rows(long_line).size(), 200u);
}

TEST_F(TrajectoryFile, LinesAndFilesHaveAnEnd) {
  EXPECT_EQ(error_of_rows(std::string(5000, '7')),
            "line 2: found a line of more than 4096 bytes, expected "
            "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz");
  std::string rows;
  for (int i = 0; i < 9; ++i) rows += std::to_string(i) + ",0,0,0,1,0,0,0\n";
  std::ofstream(file_, std::ios::binary) << kHeader << rows;
  TrajectorySettings settings;
  settings.file = file_;
  EXPECT_EQ(make_trajectory(settings, {.memory_bytes = 9 * 128}).duration_s(), 8.0);
  try {
    make_trajectory(settings, {.memory_bytes = 8 * 128});
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), file_ + ": line 10: found more rows, expected at most 8 (--limit-gib)");
  }
}

TEST_F(TrajectoryFile, PosesAreWithinAKilometreAndTwelveDays) {
  EXPECT_EQ(error_of_rows("0,0,1e7,0,1,0,0,0\n"),
            "line 2: found y_mm = 1e+07, expected -1e+06 to 1e+06");
  EXPECT_EQ(error_of_rows("-1e300,0,0,0,1,0,0,0\n1e300,0,0,0,1,0,0,0\n"),
            "line 2: found t_s = -1e+300, expected -1e+11 to 1e+11");
  EXPECT_EQ(error_of_rows("1700000000,0,0,0,1,0,0,0\n1702000000,0,0,0,1,0,0,0\n"),
            "line 3: found a pose 2000000.000000 s after the first, expected at most 1000000 s");
}

TEST_F(TrajectoryFile, AMissingFileIsBadInput) {
  TrajectorySettings settings;
  settings.file = file_ + ".none";
  EXPECT_THROW(make_trajectory(settings), InputError);
}

}  // namespace
}  // namespace sulcus::trajectory_test
