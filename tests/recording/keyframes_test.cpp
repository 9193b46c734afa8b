// What version 2 of the layout added: states, gaps, a parent.
#include <cstring>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "tests/recording/sample_recording.hpp"

namespace sulcus::keyframes_test {
namespace {

using sample::append;
using sample::header;
using sample::tick;
using sample::workpiece;

std::vector<std::byte> state_of(std::uint64_t tick) {
  std::vector<std::byte> state(100 + 7 * tick);
  for (std::size_t i = 0; i < state.size(); ++i) {
    state[i] = static_cast<std::byte>(hash_bytes(&i, sizeof i, tick));
  }
  return state;
}

/// The last of ticks that are left out, with the edits of all of them.
TickRecord after_gap(std::uint64_t number) {
  TickRecord row = tick(number);
  row.faults |= kFaultRowsDropped;
  seal(row);
  return row;
}

class Keyframes : public sample::RecordingTest {
 protected:
  /// States every 10 ticks.
  RecordingWriter written(std::uint64_t ticks) const {
    RecordingWriter writer(path(), header(), workpiece(), nullptr);
    for (std::uint64_t t = 1; t <= ticks; ++t) {
      append(writer, t, t);
      if (t % 10 == 0) writer.append_keyframe(t, state_of(t));
    }
    return writer;
  }
};

TEST_F(Keyframes, AreReadAsTheyWereWritten) {
  written(300).close();
  const RecordingReader reader(path());
  EXPECT_EQ(reader.missing(), "");
  ASSERT_EQ(reader.keyframes().size(), 30u);
  for (const KeyframeInfo& info : reader.keyframes()) {
    EXPECT_EQ(reader.keyframe(info), state_of(info.tick));
  }
}

TEST_F(Keyframes, OfTicksThatAreNotThereAreNotGiven) {
  {
    RecordingWriter writer = written(95);
    writer.append_keyframe(100, state_of(100));
    writer.flush();
  }
  const RecordingReader reader(path());
  ASSERT_EQ(reader.keyframes().size(), 9u);
  EXPECT_EQ(reader.keyframes().back().tick, 90u);
}

TEST_F(Keyframes, ADamagedOneIsNotGivenAndTheOthersAre) {
  written(100).close();
  std::string bytes;
  {
    std::FILE* file = std::fopen(path().c_str(), "rb");
    ASSERT_NE(file, nullptr);
    bytes.resize(std::filesystem::file_size(path()));
    ASSERT_EQ(std::fread(bytes.data(), 1, bytes.size(), file), bytes.size());
    std::fclose(file);
  }
  const std::vector<std::byte> state = state_of(50);
  const std::size_t at =
      bytes.find(std::string_view(reinterpret_cast<const char*>(state.data()), state.size()));
  ASSERT_NE(at, std::string::npos);
  bytes[at + 33] ^= 4;
  std::FILE* file = std::fopen(path().c_str(), "wb");
  std::fwrite(bytes.data(), 1, bytes.size(), file);
  std::fclose(file);
  const RecordingReader reader(path());
  EXPECT_EQ(reader.tick_count(), 100u);
  for (const KeyframeInfo& info : reader.keyframes()) {
    EXPECT_EQ(reader.keyframe(info).has_value(), info.tick != 50) << info.tick;
  }
}

TEST_F(Keyframes, MayStandBeforeTheFirstRowOfOneThatGoesOn) {
  RecordingHeader goes_on = header();
  goes_on.parent = "earlier.h5, after tick 20";
  {
    RecordingWriter writer(path(), goes_on, workpiece(), nullptr);
    writer.append_keyframe(20, state_of(20));
    std::uint64_t edits_end = 0;
    for (std::uint64_t t = 21; t <= 60; ++t) {
      TickRecord row = tick(t);
      writer.append_edits(sample::edits(t));
      row.edits_end = edits_end += sample::edits_of(t);
      seal(row);
      writer.append_ticks({&row, 1});
    }
    writer.close();
  }
  const RecordingReader reader(path());
  EXPECT_EQ(reader.missing(), "");
  EXPECT_EQ(reader.header().parent, goes_on.parent);
  EXPECT_EQ(reader.tick_count(), 40u);
  ASSERT_EQ(reader.keyframes().size(), 1u);
  EXPECT_EQ(reader.keyframe(reader.keyframes()[0]), state_of(20));
}

TEST_F(Keyframes, RowsMayBeLeftOutWhereTheNextSaysSo) {
  for (const bool says : {true, false}) {
    {
      RecordingWriter writer(path(), header(), workpiece(), nullptr);
      append(writer, 1, 20);
      for (std::uint64_t t = 21; t <= 30; ++t) writer.append_edits(sample::edits(t));
      const TickRecord row = says ? after_gap(30) : tick(30);
      writer.append_ticks({&row, 1});
      append(writer, 31, 50);
      writer.close();
    }
    const RecordingReader reader(path());
    EXPECT_EQ(reader.tick_count(), says ? 41u : 20u);
    EXPECT_EQ(reader.missing().empty(), says) << reader.missing();
    ASSERT_EQ(reader.gaps().size(), says ? 1u : 0u);
    if (!says) continue;
    EXPECT_EQ(reader.gaps()[0].first, 21u);
    EXPECT_EQ(reader.gaps()[0].end, 30u);
    EXPECT_EQ(reader.edit_count(), sample::edits_end(50));
  }
}

TEST_F(Keyframes, EditsOfAGapBelongToItsTicks) {
  RecordingWriter writer(path(), header(), workpiece(), nullptr);
  append(writer, 1, 20);
  auto foreign = sample::edits(20);  // once more, in the gap
  foreign.resize(1);
  writer.append_edits(foreign);
  TickRecord row = after_gap(30);
  row.edits_end = sample::edits_end(20) + 1;
  seal(row);
  writer.append_ticks({&row, 1});
  writer.close();
  EXPECT_EQ(RecordingReader(path()).tick_count(), 20u);
}

TEST(OldRecordings, OfVersion1AreRead) {
  const RecordingReader reader(SULCUS_SOURCE_DIR "/tests/recording/version_1.h5");
  EXPECT_EQ(reader.missing(), "");
  EXPECT_EQ(reader.header().version, 1u);
  EXPECT_EQ(reader.tick_count(), 100u);
  EXPECT_EQ(reader.edit_count(), 36u);
  EXPECT_TRUE(reader.keyframes().empty());
  EXPECT_EQ(reader.cutting().size(), 100u);
}

}  // namespace
}  // namespace sulcus::keyframes_test
