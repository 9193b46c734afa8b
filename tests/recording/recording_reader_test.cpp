#include "engine/recording/recording_reader.hpp"

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <random>

#include <sys/wait.h>

#include "engine/core/error.hpp"
#include "engine/recording/hdf5_handle.hpp"
#include "engine/recording/recording_format.hpp"
#include "tests/recording/sample_recording.hpp"

namespace sulcus::sample::recording_reader_test {
namespace {

class RecordingReaderTest : public RecordingTest {
 protected:
  static std::vector<char> bytes_of(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write_bytes(const std::string& file, const std::vector<char>& bytes) const {
    std::ofstream(file, std::ios::binary)
        .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }

  /// The InputError's line, or "" where it opens.
  static std::string refusal(const std::string& file) {
    try {
      RecordingReader reader(file);
      reader.workpiece();
      reader.burr_mesh();
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      return error.what();
    }
    return "";
  }

  struct Outcome {
    int refused = 0, shortened = 0, whole = 0;
  };

  /// Reads damaged bytes: a refusal, or nothing but what was written.
  void expect_no_lie(const std::vector<char>& bytes, std::uint64_t ticks, Outcome& outcome) const {
    write_bytes(path("damaged.h5"), bytes);
    try {
      const RecordingReader reader(path("damaged.h5"));
      expect_same_header(reader.header());
      expect_true_prefix(reader);
      ASSERT_LE(reader.tick_count(), ticks);
      if (reader.missing().empty()) {
        ASSERT_EQ(reader.tick_count(), ticks);
        ASSERT_EQ(reader.state_hashes().size(), ticks / 10);
      }
      ++(reader.missing().empty() ? outcome.whole : outcome.shortened);
      try {
        expect_same_workpiece(reader.workpiece(), workpiece());
        const auto mesh = reader.burr_mesh();
        ASSERT_TRUE(mesh.has_value());
        ASSERT_EQ(mesh->positions, burr().positions);
        ASSERT_EQ(mesh->triangles, burr().triangles);
      } catch (const InputError&) {
      }
    } catch (const InputError&) {
      ++outcome.refused;
    }
    ASSERT_EQ(H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_ALL), 0);
  }

  /// The bytes of a recording whose writer never closed it.
  std::vector<char> unclosed(std::uint64_t ticks) const {
    const TriangleMesh mesh = burr();
    RecordingWriter writer(path("open.h5"), header(), workpiece(), &mesh);
    append(writer, 1, ticks);
    writer.flush();
    return bytes_of(path("open.h5"));
  }

  /// Opens a closed recording as any HDF5 program would, to change it.
  Hdf5Handle open_to_change() const {
    silence_hdf5();
    return hdf5_checked(H5Fopen(path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose, "file");
  }
  static void change_number(hid_t object, const char* name, std::uint32_t value) {
    const auto attribute = hdf5_checked(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, name);
    const std::uint32_t values[3] = {value, value, value};
    hdf5_check(H5Awrite(attribute, H5T_NATIVE_UINT32, values), name);
  }
};

/// Flushes every 20 ticks and tells the pipe how many ticks are safe; never ends by itself.
[[noreturn]] void record_until_killed(const std::string& where, int pipe_end) {
  RecordingWriter writer(where, header(), workpiece(), nullptr);
  for (std::uint64_t t = 1;; ++t) {
    append(writer, t, t);
    if (t % 20 != 0) continue;
    writer.flush();
    if (write(pipe_end, &t, sizeof t) != sizeof t) _exit(1);
  }
}

TEST_F(RecordingReaderTest, AKilledWriterLeavesAllUpToItsLastFlush) {
  for (const std::uint64_t kill_after : {20u, 400u, 1540u}) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) record_until_killed(path(), ends[1]);
    close(ends[1]);
    std::uint64_t safe = 0;
    while (safe < kill_after && read(ends[0], &safe, sizeof safe) == sizeof safe) {
    }
    ASSERT_GE(safe, kill_after);
    {
      const RecordingReader living(path());
      EXPECT_GE(living.tick_count(), safe);
      expect_true_prefix(living);
    }
    kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    while (read(ends[0], &safe, sizeof safe) == sizeof safe) {
    }
    close(ends[0]);
    const RecordingReader reader(path());
    EXPECT_GE(reader.tick_count(), safe);
    EXPECT_NE(reader.missing().find("not closed cleanly"), std::string::npos);
    expect_same_header(reader.header());
    expect_true_prefix(reader);
    expect_same_workpiece(reader.workpiece(), workpiece());
  }
}

TEST_F(RecordingReaderTest, TruncatedAnywhereItNeverLies) {
  constexpr std::uint64_t kTicks = 400;
  for (const bool closed : {true, false}) {
    const auto bytes = closed ? bytes_of(write_whole(kTicks)) : unclosed(kTicks);
    const std::size_t step = bytes.size() / 100 + 1;
    Outcome outcome;
    for (std::size_t length = 0; length < bytes.size(); length += step) {
      const std::vector<char> cut(bytes.begin(),
                                  bytes.begin() + static_cast<std::ptrdiff_t>(length));
      expect_no_lie(cut, kTicks, outcome);
      if (HasFatalFailure()) FAIL() << "cut at " << length << " of " << bytes.size();
    }
    EXPECT_GT(outcome.refused, 0);
    EXPECT_GT(outcome.shortened, 0);
  }
}

TEST_F(RecordingReaderTest, FlippedBitsNeverMakeALie) {
  constexpr std::uint64_t kTicks = 400;
  std::mt19937 random(7);
  for (const bool closed : {true, false}) {
    auto bytes = closed ? bytes_of(write_whole(kTicks)) : unclosed(kTicks);
    Outcome outcome;
    for (int i = 0; i < 100; ++i) {
      // Every other flip where the structure of the file is, at its start.
      const std::size_t at = random() % (i % 2 ? bytes.size() : std::size_t{8192});
      const char bit = static_cast<char>(1 << random() % 8);
      bytes[at] ^= bit;
      expect_no_lie(bytes, kTicks, outcome);
      if (HasFatalFailure()) FAIL() << "bit " << int{bit} << " of byte " << at;
      bytes[at] ^= bit;
    }
    EXPECT_GT(outcome.refused, 0);
    EXPECT_GT(outcome.shortened, 0);
  }
}

TEST_F(RecordingReaderTest, ADamagedRowEndsTheRecordingBeforeIt) {
  auto bytes = bytes_of(write_whole(400));
  const TickRecord row = tick(251);
  const auto* raw = reinterpret_cast<const char*>(&row);
  const auto at = std::search(bytes.begin(), bytes.end(), raw, raw + sizeof row);
  ASSERT_NE(at, bytes.end());
  at[40] ^= 1;
  write_bytes(path(), bytes);
  const RecordingReader reader(path());
  EXPECT_EQ(reader.tick_count(), 250u);
  EXPECT_EQ(reader.missing(),
            "recording ends at tick 250 (250 of 400): row 250 of /ticks is damaged");
}

TEST_F(RecordingReaderTest, ADamagedEditEndsTheRecordingBeforeItsTick) {
  auto bytes = bytes_of(write_whole(400));
  const EditRow row = packed(edits(100).back());
  const auto* raw = reinterpret_cast<const char*>(&row);
  const auto at = std::search(bytes.begin(), bytes.end(), raw, raw + sizeof row);
  ASSERT_NE(at, bytes.end());
  at[12] ^= 1;
  write_bytes(path(), bytes);
  const RecordingReader reader(path());
  EXPECT_EQ(reader.tick_count(), 99u);
  EXPECT_EQ(reader.edit_count(), edits_end(99));
  EXPECT_NE(reader.missing().find("of /edits is damaged"), std::string::npos) << reader.missing();
  expect_true_prefix(reader);
}

TEST_F(RecordingReaderTest, ALeftOutOrForeignTickEndsIt) {
  for (const bool left_out : {true, false}) {
    RecordingWriter writer(path(), header(), workpiece(), nullptr);
    append(writer, 1, 7);
    TickRecord row = tick(8);
    if (left_out) row.tick = 9;  // else: its one edit says another tick than the row
    auto foreign = edits(8);
    foreign[0].tick = left_out ? 9 : 7;
    writer.append_edits(foreign);
    seal(row);
    writer.append_ticks({&row, 1});
    writer.close();
    const RecordingReader reader(path());
    EXPECT_EQ(reader.tick_count(), 7u);
    EXPECT_NE(reader.missing(), "");
  }
}

TEST_F(RecordingReaderTest, WhatIsNoRecordingIsRefused) {
  EXPECT_NE(refusal(path("none.h5")).find("found no such file"), std::string::npos);
  EXPECT_NE(refusal(folder_.string()).find("found no regular file"), std::string::npos);
  write_bytes(path("empty.h5"), {});
  EXPECT_NE(refusal(path("empty.h5")).find("found no HDF5 file"), std::string::npos);
  std::mt19937 random(3);
  for (int i = 0; i < 20; ++i) {
    std::vector<char> noise(1 + random() % 5000);
    for (char& c : noise) c = static_cast<char>(random());
    if (i % 2) {  // noise that begins like HDF5
      const char signature[] = "\x89HDF\r\n\x1a\n\x03\x08\x08";
      noise.insert(noise.begin(), signature, signature + sizeof signature - 1);
    }
    write_bytes(path("noise.h5"), noise);
    EXPECT_NE(refusal(path("noise.h5")), "");
  }
  silence_hdf5();
  hdf5_checked(H5Fcreate(path("other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
               H5Fclose, "file");
  EXPECT_NE(refusal(path("other.h5")), "");
}

TEST_F(RecordingReaderTest, ANewerVersionIsRefusedNamingBoth) {
  write_whole(5);
  change_number(open_to_change(), "version", 9);
  const std::string line = refusal(path());
  EXPECT_NE(line.find("version: found 9, expected 1 to 2"), std::string::npos) << line;
}

TEST_F(RecordingReaderTest, ChangedPartsAreRefused) {
  const auto changed = [this](auto change) {
    write_whole(5);
    change(open_to_change());
    return refusal(path());
  };
  const auto said = [](const std::string& line, const char* what) {
    return line.find(what) != std::string::npos ? "" : "got: " + line;
  };
  EXPECT_EQ(said(changed([](const Hdf5Handle& file) {
                   const auto a = hdf5_checked(H5Aopen(file, "rate_hz", H5P_DEFAULT), H5Aclose, "");
                   const double rate_hz = 500.0;
                   H5Awrite(a, H5T_NATIVE_DOUBLE, &rate_hz);
                 }),
                 "header_check"),
            "");
  EXPECT_EQ(said(changed([](const Hdf5Handle& file) { H5Adelete(file, "scene"); }), "scene: no"),
            "");
  EXPECT_EQ(said(changed([](const Hdf5Handle& file) { H5Adelete(file, "format"); }), "format: "),
            "");
  for (const char* name : {"ticks", "edits", "state_hashes", "end", "workpiece"}) {
    EXPECT_EQ(
        said(changed([&](const Hdf5Handle& file) { H5Ldelete(file, name, H5P_DEFAULT); }), name),
        "");
  }
  for (const std::uint32_t cells : {0u, 12u, 1032u, 0xfffffff8u}) {
    EXPECT_EQ(said(changed([&](const Hdf5Handle& file) {
                     const auto group =
                         hdf5_checked(H5Gopen2(file, "workpiece", H5P_DEFAULT), H5Gclose, "");
                     change_number(group, "cells", cells);
                   }),
                   "no multiple of 8 up to 1024"),
              "");
  }
  // Another grid of as many leaves: every index is in range, but the check is not right.
  EXPECT_EQ(said(changed([](const Hdf5Handle& file) {
                   const auto group =
                       hdf5_checked(H5Gopen2(file, "workpiece", H5P_DEFAULT), H5Gclose, "");
                   change_number(group, "cells", 64);
                 }),
                 "its check does not fit"),
            "");
}

/// A data set in the place of another, announcing rows that are not there.
void announce_rows(const Hdf5Handle& file, const char* name, hid_t type, hsize_t rows,
                   hsize_t chunk) {
  hdf5_check(H5Ldelete(file, name, H5P_DEFAULT), name);
  const hsize_t unlimited = H5S_UNLIMITED;
  const auto space = hdf5_checked(H5Screate_simple(1, &rows, &unlimited), H5Sclose, name);
  const auto properties = hdf5_checked(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, name);
  hdf5_check(H5Pset_chunk(properties, 1, &chunk), name);
  hdf5_checked(H5Dcreate2(file, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose,
               name);
}

TEST_F(RecordingReaderTest, AnnouncedSizesTakeNoMemory) {
  write_whole(5);
  announce_rows(open_to_change(), "ticks", row_type<TickRecord>(), hsize_t{1} << 50,
                kRowTable<TickRecord>.chunk_rows);
  {
    const RecordingReader reader(path());
    EXPECT_EQ(reader.tick_count(), 0u);
    EXPECT_NE(reader.missing().find("holds no tick"), std::string::npos) << reader.missing();
  }

  write_whole(5);
  announce_rows(open_to_change(), "ticks", row_type<TickRecord>(), 1, hsize_t{1} << 23);
  EXPECT_NE(refusal(path()).find("ticks: another layout"), std::string::npos);

  write_whole(5);
  announce_rows(open_to_change(), "ticks", row_type<EditRow>(), 1,
                kRowTable<TickRecord>.chunk_rows);
  EXPECT_NE(refusal(path()).find("ticks: rows of another type"), std::string::npos);

  for (const hsize_t rows : {hsize_t{1} << 62, hsize_t{100}}) {
    write_whole(5);
    {
      const auto file = open_to_change();
      const auto group = hdf5_checked(H5Gopen2(file, "workpiece", H5P_DEFAULT), H5Gclose, "");
      announce_rows(group, "leaves", H5T_STD_U32LE, rows, 256);
    }
    EXPECT_NE(refusal(path()).find("leaves: "), std::string::npos);
  }
}

}  // namespace
}  // namespace sulcus::sample::recording_reader_test
