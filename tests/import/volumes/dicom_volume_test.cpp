#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <zlib.h>

#include "engine/core/error.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "tests/support/scratch_folder.hpp"

// What a DICOM file says of its slices, and how its pixels may lie.

namespace sulcus::dicom_volume_test {
namespace {

const std::string kExplicit = "1.2.840.10008.1.2.1", kDeflated = "1.2.840.10008.1.2.1.99",
                  kRle = "1.2.840.10008.1.2.5", kLosslessJpeg = "1.2.840.10008.1.2.4.70",
                  kJpegLs = "1.2.840.10008.1.2.4.80", kJpeg2000 = "1.2.840.10008.1.2.4.90";

template <class T>
std::string bytes_of(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}
std::string word(int value) { return bytes_of(static_cast<std::uint16_t>(value)); }
std::string long_word(std::size_t value) { return bytes_of(static_cast<std::uint32_t>(value)); }

std::string element(std::uint32_t tag, const std::string& kind, std::string value) {
  if (value.size() % 2 != 0) value += kind == "DS" || kind == "IS" ? ' ' : '\0';
  const std::string head =
      word(static_cast<int>(tag >> 16u)) + word(static_cast<int>(tag & 0xffffu));
  const bool long_length = kind == "OB" || kind == "OW";
  return head + kind +
         (long_length ? word(0) + long_word(value.size()) : word(static_cast<int>(value.size()))) +
         value;
}

/// Elements before the pixels, by their tags.
using Elements = std::map<std::uint32_t, std::pair<std::string, std::string>>;

/// Of `columns` x `rows` pixels of 8 bits.
Elements plain(int columns, int rows) {
  return {{0x00280002, {"US", word(1)}},    {0x00280004, {"CS", "MONOCHROME2 "}},
          {0x00280010, {"US", word(rows)}}, {0x00280011, {"US", word(columns)}},
          {0x00280030, {"DS", "0.2\\0.1"}}, {0x00280100, {"US", word(8)}},
          {0x00280101, {"US", word(8)}},    {0x00280102, {"US", word(7)}},
          {0x00280103, {"US", word(0)}}};
}

std::string data_set(const Elements& elements) {
  std::string bytes;
  for (const auto& [tag, value] : elements) bytes += element(tag, value.first, value.second);
  return bytes;
}
std::string file(const std::string& syntax, const std::string& data) {
  const std::string meta = element(0x00020010, "UI", syntax);
  return std::string(128, '\0') + "DICM" + meta + data;
}
std::string pixels(const std::string& values) { return element(0x7fe00010, "OB", values); }

std::string packed(std::string frame) {
  if (frame.size() % 2 != 0) frame += '\0';
  const std::string item = word(0xfffe) + word(0xe000);
  return word(0x7fe0) + word(0x10) + "OB" + word(0) + long_word(0xffffffff) + item + long_word(0) +
         item + long_word(frame.size()) + frame + word(0xfffe) + word(0xe0dd) + long_word(0);
}

/// Rows of four bytes, each behind a code that says so.
std::string run_lengths(int rows, const std::string& end = "") {
  std::string coded = long_word(1) + long_word(64) + std::string(56, '\0');
  for (int r = 0; r < rows; ++r) {
    coded += '\3';
    for (int c = 0; c < 4; ++c) coded += static_cast<char>(4 * r + c);
  }
  return coded + end;
}

std::string error_of(const std::string& path, const InputLimits& limits = {}) {
  try {
    (void)read_medical_volume(path, limits);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

void expect_says(const std::string& error, const std::string& text) {
  EXPECT_NE(error.find(text), std::string::npos) << error;
}

TEST(DicomVolume, TellsWhichInstanceNumbersAreAbsent) {
  const ScratchFolder folder;
  const auto warnings = [&](const std::string& name, const std::vector<int>& numbers) {
    for (const int number : numbers) {
      Elements slice = plain(4, 1);
      slice[0x00200013] = {"IS", std::to_string(number)};
      folder.write(name + "/" + std::to_string(number) + ".dcm",
                   file(kExplicit, data_set(slice) + pixels("abcd")));
    }
    std::string all;
    for (const std::string& line : read_medical_volume(folder.path(name)).warnings) {
      all += line + "\n";
    }
    return all;
  };
  expect_says(warnings("gap", {1, 2, 3, 5, 6}),
              "the slices' numbers go from 3 to 5 (3.dcm, 5.dcm): what is absent there is not made "
              "up for");
  EXPECT_EQ(warnings("even", {2, 4, 6, 8}).find("absent"), std::string::npos);
}

TEST(DicomVolume, RunLengthsFillTheirPicture) {
  const ScratchFolder folder;
  const auto coded = [&](int rows, const std::string& frame) {
    return folder.write("a.dcm", file(kRle, data_set(plain(4, rows)) + packed(frame)));
  };
  const std::string filled = std::string(2, '\x80');
  for (const std::string& end : {std::string(), std::string(1, '\0'), filled}) {
    const MedicalVolume volume = read_medical_volume(coded(5, run_lengths(5, end)));
    ASSERT_EQ(volume.values.size(), 20u);
    for (int v = 0; v < 20; ++v) EXPECT_EQ(volume.values[static_cast<std::size_t>(v)], v);
  }
  expect_says(error_of(coded(5, run_lengths(6))),
              "PixelData, frame 1: found packed pixels that are damaged, or of another size");
  expect_says(error_of(coded(5, run_lengths(4))), "PixelData, frame 1: found packed pixels");
}

TEST(DicomVolume, PackedPicturesSayTheSizeThatIsSaid) {
  const ScratchFolder folder;
  const auto said = [&](const std::string& syntax, const std::string& frame) {
    const std::string path =
        folder.write("a.dcm", file(syntax, data_set(plain(30000, 20000)) + packed(frame)));
    return error_of(path);
  };
  const std::string size = std::string("\0\x11\0\x13", 4);  // 17 rows of 19
  const std::string rest(20, '\0');
  const std::string jpeg_size = size + std::string("\1\1\x11\0", 4);
  expect_says(said(kRle, run_lengths(5)),
              "PixelData: found 90 bytes of run lengths, expected at least 9375000 for rows");
  expect_says(
      said(kLosslessJpeg, "\xff\xd8\xff\xc3" + std::string("\0\x0b\x08", 3) + jpeg_size + rest),
      "PixelData: found a picture of 19 x 17, expected a whole picture of 30000 x 20000");
  expect_says(said(kJpegLs, "\xff\xd8\xff\xe0" + std::string("\0\4ab\xff\xf7\0\x0b\x08", 9) +
                                jpeg_size + rest),
              "PixelData: found a picture of 19 x 17");
  const std::string corners = std::string("\0\0\0\x14\0\0\0\x12\0\0\0\1\0\0\0\1", 16);
  expect_says(said(kJpeg2000, "\xff\x4f\xff\x51" + std::string("\0\x29\0\0", 4) + corners + rest),
              "PixelData: found a picture of 19 x 17");
  expect_says(said(kJpeg2000, "nothing of the kind, and long enough"),
              "PixelData: found packed pixels that are damaged");
}

TEST(DicomVolume, NumbersThatMakeNothingOfAllValuesAreRefused) {
  const ScratchFolder folder;
  Elements dose = plain(4, 2);
  dose[0x00280008] = {"IS", "2"};
  dose[0x00200032] = {"DS", "1\\2\\3"};
  dose[0x00200037] = {"DS", "1\\0\\0\\0\\1\\0"};
  const auto with = [&](const std::string& scale, const std::string& offsets) {
    Elements all = dose;
    all[0x3004000c] = {"DS", offsets};
    all[0x3004000e] = {"DS", scale};
    return folder.write("a.dcm", file(kExplicit, data_set(all) + pixels("abcdefghijklmnop")));
  };
  const MedicalVolume volume = read_medical_volume(with("0.5", "0\\0.3"));
  EXPECT_EQ(volume.at(1, 0, 0), 'b' * 0.5f);
  EXPECT_NEAR(volume.spacing_m.z(), 3e-4, 1e-9);
  expect_says(error_of(with("0", "0\\0.3")), "DoseGridScaling: found 0, expected another number");
  expect_says(error_of(with("0.5", "0\\nan")),
              "GridFrameOffsetVector: found \"0\\nan\", expected finite numbers");
  expect_says(error_of(with("0.5", "0\\far")),
              "GridFrameOffsetVector: found \"0\\far\", expected finite numbers");
}

TEST(DicomVolume, InflatesNoFurtherThanThePixels) {
  const ScratchFolder folder;
  const auto deflated = [&](std::string data, std::size_t zeros_behind) {
    data += std::string(zeros_behind, '\0');
    z_stream stream{};
    deflateInit2(&stream, 9, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY);
    std::string out(deflateBound(&stream, data.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(data.data());
    stream.avail_in = static_cast<uInt>(data.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return folder.write("a.dcm", file(kDeflated, out));
  };
  const std::string head = data_set(plain(4, 1)), whole = head + pixels("abcd");
  // A limit that all of it would be beyond.
  const InputLimits limits{.memory_bytes = std::uint64_t{8} << 20};
  EXPECT_EQ(error_of(deflated(whole, 0), limits), "no error");
  EXPECT_EQ(error_of(deflated(whole, std::size_t{32} << 20), limits), "no error");
  expect_says(error_of(deflated(head, std::size_t{32} << 20), limits),
              "data set: found a deflate stream that is damaged, or too long");
}

TEST(DicomVolume, PaddingIsTakenAsTheSmallestOfWhatIsMeasured) {
  const ScratchFolder folder;
  const auto values = [&](const Elements& more, const std::string& frame) {
    Elements slice = plain(4, 1);
    for (const auto& [tag, value] : more) slice[tag] = value;
    return read_medical_volume(
               folder.write("a.dcm", file(kExplicit, data_set(slice) + pixels(frame))))
        .values;
  };
  const std::string frame = "\xff\x07\x09\xfe";
  const auto us = [](int value) { return std::pair<std::string, std::string>("US", word(value)); };
  const auto ss = [](int value) { return std::pair<std::string, std::string>("SS", word(value)); };
  EXPECT_EQ(values({}, frame), (std::vector<float>{255, 7, 9, 254}));
  EXPECT_EQ(values({{0x00280120, us(255)}}, frame), (std::vector<float>{7, 7, 9, 254}));
  // From the value to its limit, whichever is the larger.
  EXPECT_EQ(values({{0x00280120, us(255)}, {0x00280121, us(254)}}, frame),
            (std::vector<float>{7, 7, 9, 7}));
  EXPECT_EQ(values({{0x00280120, us(7)}, {0x00280121, us(9)}}, frame),
            (std::vector<float>{255, 254, 254, 254}));
  // As stored, before it is rescaled, and signed where pixels are.
  EXPECT_EQ(values({{0x00280103, us(1)},
                    {0x00280120, ss(-1)},
                    {0x00281052, {"DS", "100"}},
                    {0x00281053, {"DS", "-2"}}},
                   frame),
            (std::vector<float>{82, 86, 82, 104}));
  // What eight bits cannot say is in no pixel.
  EXPECT_EQ(values({{0x00280120, us(0x07ff)}}, frame), (std::vector<float>{255, 7, 9, 254}));
}

TEST(DicomVolume, NothingButPaddingIsRefused) {
  const ScratchFolder folder;
  Elements slice = plain(4, 1);
  slice[0x00280120] = {"US", word('a')};
  expect_says(error_of(folder.write("a.dcm", file(kExplicit, data_set(slice) + pixels("aaaa")))),
              "no finite grey value");
  slice[0x00280010] = {"US", word(2)};
  const MedicalVolume volume = read_medical_volume(
      folder.write("b.dcm", file(kExplicit, data_set(slice) + pixels("aaaabcde"))));
  ASSERT_FALSE(volume.warnings.empty());
  expect_says(volume.warnings.back(),
              "4 values are no number, padding, or below all: taken as the smallest, 98");
}

}  // namespace
}  // namespace sulcus::dicom_volume_test
