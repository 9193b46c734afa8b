#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/recording/recording_reader.hpp"
#include "tests/pipeline/small_scenes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::sound_test {
namespace {

class Sound : public ::testing::Test {
 protected:
  test::CommandResult command(const std::string& arguments) {
    return test::sulcus_command(arguments, scratch_.path("err"));
  }
  /// A bar that is cut on its side under a load, by a spindle that sags under it. It is heavy
  /// enough to have one speed, and no band of them, for as long as a line of the spectrum takes.
  void cut(const std::string& load_N) {
    const auto result = command(
        "run " + std::string(SULCUS_SOURCE_DIR) +
        "/scenes/side_cut.toml --set burr.speed_rpm=150000 --set trajectory.hold_s=1.2 --set "
        "spindle.stall_torque_mNm=1 --set spindle.inertia_g_mm2=5 --set trajectory.load_N=" +
        load_N + " --set workpiece.voxel_mm=0.05 --set 'workpiece.cells=[24, 72, 56]' -o " +
        scratch_.path(load_N));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  std::string recording(const std::string& name) const {
    return scratch_.path(name + "/recording.h5");
  }
  std::string sound_of(const std::string& name, const std::string& file) {
    const auto result = command("export " + recording(name) + " --sound " + scratch_.path(file));
    EXPECT_EQ(result.status, 0) << result.err;
    return test::read_file(scratch_.path(file));
  }

  const ScratchFolder scratch_;
};

std::vector<double> samples_of(const std::string& wav) {
  std::vector<double> samples((wav.size() - 44) / 2);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::int16_t sample = 0;
    std::memcpy(&sample, wav.data() + 44 + 2 * i, sizeof(sample));
    samples[i] = sample / 32768.0;
  }
  return samples;
}

/// The loudest frequency of some samples, by the transform's definition, to a bin.
double loudest_hz(const std::vector<double>& samples, std::size_t first, std::size_t count) {
  std::size_t best = 0;
  double most = 0.0;
  for (std::size_t bin = 1; bin < count / 2; ++bin) {
    const std::complex<double> step = std::polar(
        1.0, -2.0 * std::numbers::pi * static_cast<double>(bin) / static_cast<double>(count));
    std::complex<double> turn = 1.0, sum = 0.0;
    for (std::size_t i = 0; i < count; ++i, turn *= step) sum += turn * samples[first + i];
    if (std::norm(sum) > most) {
      most = std::norm(sum);
      best = bin;
    }
  }
  return 44100.0 * static_cast<double>(best) / static_cast<double>(count);
}

TEST_F(Sound, TheLoudestIsTheRecordedSpeedAtThreeLoads) {
  constexpr std::size_t kCount = 4096;  // 93 ms: in twice as long the speed goes on changing
  double last_hz = 2500.0;
  for (const std::string load_N : {"0.25", "0.5", "1.0"}) {
    cut(load_N);
    const std::vector<double> samples = samples_of(sound_of(load_N, load_N + ".wav"));
    const RecordingReader reader(recording(load_N));
    const std::vector<CuttingRecord> rows = reader.cutting();
    ASSERT_NEAR(static_cast<double>(samples.size()), 44.1 * static_cast<double>(rows.size()), 1.0);
    double turns_hz = 0.0;  // the mean over the ticks that these samples are of
    const std::size_t ticks = kCount * 1000 / 44100;
    for (std::size_t i = rows.size() - ticks; i < rows.size(); ++i) {
      turns_hz += rows[i].spindle_rad_per_s / (2.0 * std::numbers::pi * static_cast<double>(ticks));
    }
    const double loudest = loudest_hz(samples, samples.size() - kCount, kCount);
    EXPECT_NEAR(loudest, turns_hz, 44100.0 / kCount) << load_N;
    EXPECT_LT(loudest, last_hz - 20.0) << "it sags further under " << load_N << " N";
    last_hz = loudest;
  }
}

TEST_F(Sound, TheSameRecordingGivesTheSameBytes) {
  cut("0.5");
  const std::string once = sound_of("0.5", "a.wav");
  EXPECT_GT(once.size(), 100000u);
  EXPECT_EQ(once, sound_of("0.5", "b.wav"));
}

TEST_F(Sound, WhatHasNoSoundIsSaid) {
  const auto run =
      command("run " + scratch_.write("probe.toml", test::probe_scene() + "[record]\n") + " -o " +
              scratch_.path("probe"));
  ASSERT_EQ(run.status, 0) << run.err;
  const auto refused = [&](const std::string& arguments, const std::string& says) {
    const auto result = command(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_NE(result.err.find(says), std::string::npos) << result.err;
  };
  refused("export " + recording("probe") + " --sound " + scratch_.path("a.wav"),
          "without [cutting]");
  refused("export " + recording("probe") + " --sound " + scratch_.path("a.mp3"), ".wav");
  refused("render " + recording("probe") + " --sound", "--video or --review");
}

/// Of the streams of a video, by ffprobe.
std::string streams_of(const std::string& video, const std::string& scratch) {
  return test::program_command(
             "ffprobe", "-v error -show_entries stream=codec_type,duration -of csv=p=0 " + video,
             scratch)
      .out;
}

TEST_F(Sound, AVideoAndTheReviewPageHaveIt) {
  const auto run = command("run " + scratch_.write("cut.toml", test::cut_scene()) + " -o " +
                           scratch_.path("cut"));
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string video = scratch_.path("cut.mp4");
  const auto drawn =
      command("render " + recording("cut") + " --fps 10 --size 160x120 --sound --video " + video);
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  const std::string streams = streams_of(video, scratch_.path("err"));
  EXPECT_NE(streams.find("video"), std::string::npos) << streams;
  EXPECT_NE(streams.find("audio"), std::string::npos) << streams;

  // Of a part of the run the sound of that part.
  const auto part =
      command("render " + recording("cut") +
              " --fps 20 --from 0.1 --to 0.2 --size 160x120 --sound --video " + video + ".mp4");
  ASSERT_EQ(part.status, 0) << part.err;
  const std::string of_part = streams_of(video + ".mp4", scratch_.path("err"));
  double sound_s = 0.0;
  const std::string audio = of_part.substr(std::min(of_part.find("audio,"), of_part.size()));
  ASSERT_EQ(std::sscanf(audio.c_str(), "audio,%lf", &sound_s), 1) << of_part;
  EXPECT_NEAR(sound_s, 0.15, 0.06);

  const auto page =
      command("render " + recording("cut") + " --sound --review " + scratch_.path("cut.html"));
  ASSERT_EQ(page.status, 0) << page.err;
  const std::string html = test::read_file(scratch_.path("cut.html"));
  EXPECT_NE(html.find("<video controls"), std::string::npos);
  EXPECT_NE(html.find("src=\"data:video/mp4;base64,AAAA"), std::string::npos);
  for (const auto& left : {".wav", ".mp4"}) {
    EXPECT_TRUE(test::read_file(scratch_.path("cut.html") + left).empty()) << left;
  }
}

}  // namespace
}  // namespace sulcus::sound_test
