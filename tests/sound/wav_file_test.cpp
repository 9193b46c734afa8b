#include "engine/sound/wav_file.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::wav_file_test {
namespace {

void write(const std::string& file, const std::vector<float>& samples) {
  std::size_t done = 0;
  WholeFile whole(file);
  write_wav(whole, 44100, [&](std::span<float> block) {
    const std::size_t count = std::min(block.size(), samples.size() - done);
    std::copy_n(samples.begin() + static_cast<std::ptrdiff_t>(done), count, block.begin());
    done += count;
    return count;
  });
  whole.finish();
}

template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number number{};
  std::memcpy(&number, bytes.data() + at, sizeof(number));
  return number;
}

// Read by the format's own description: a header of 44 bytes, then the samples.
TEST(WavFile, IsWhatTheFormatSays) {
  const ScratchFolder scratch;
  std::vector<float> samples(10001);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i] = 0.9f * static_cast<float>(std::sin(0.1 * static_cast<double>(i)));
  }
  samples[5] = 3.0f;  // louder than there can be
  write(scratch.path("a.wav"), samples);
  const std::string bytes = test::read_file(scratch.path("a.wav"));
  ASSERT_EQ(bytes.size(), 44 + 2 * samples.size());
  EXPECT_EQ(bytes.substr(0, 4) + bytes.substr(8, 8), "RIFFWAVEfmt ");
  EXPECT_EQ(number_at<std::uint16_t>(bytes, 20), 1);  // whole numbers
  EXPECT_EQ(number_at<std::uint16_t>(bytes, 22), 1);  // channel
  EXPECT_EQ(number_at<std::uint32_t>(bytes, 24), 44100u);
  EXPECT_EQ(number_at<std::uint16_t>(bytes, 34), 16);  // bits
  EXPECT_EQ(bytes.substr(36, 4), "data");
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double expected = std::min(1.0, static_cast<double>(samples[i]));
    EXPECT_NEAR(number_at<std::int16_t>(bytes, 44 + 2 * i) / 32768.0, expected, 1.0 / 32000.0) << i;
  }
}

TEST(WavFile, TheSameSamplesGiveTheSameBytes) {
  const ScratchFolder scratch;
  const std::vector<float> samples(5000, 0.25f);
  write(scratch.path("a.wav"), samples);
  write(scratch.path("b.wav"), samples);
  EXPECT_EQ(test::read_file(scratch.path("a.wav")), test::read_file(scratch.path("b.wav")));
}

TEST(WavFile, SaysWhereItCannotBeWritten) {
  const ScratchFolder scratch;
  try {
    write(scratch.path("none/a.wav"), {0.5f});
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("none/a.wav"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace sulcus::wav_file_test
