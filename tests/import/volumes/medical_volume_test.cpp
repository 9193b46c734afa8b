#include "engine/import/volumes/medical_volume.hpp"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <zlib.h>

#include "engine/core/error.hpp"
#include "engine/import/volumes/write_volume.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::medical_volume_test {
namespace {

template <class T>
std::string bytes_of(T value) {
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));
  return bytes;
}

/// 4 x 5 x 6 voxels that hold their own index.
std::string counting_data() {
  std::string data;
  for (std::uint16_t v = 0; v < 120; ++v) data += bytes_of(v);
  return data;
}

std::string nrrd(const std::string& sizes = "4 5 6", const std::string& more = "",
                 const std::string& data = counting_data(), const std::string& encoding = "raw",
                 const std::string& dimension = "3", const std::string& type = "uint16") {
  return "NRRD0004\ntype: " + type + "\ndimension: " + dimension + "\nsizes: " + sizes +
         "\nendian: little\nencoding: " + encoding + "\n" + more + "\n" + data;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

std::string meta(const std::string& sizes = "4 5 6", const std::string& more = "",
                 const std::string& data = counting_data(),
                 const std::string& type = "MET_USHORT") {
  return "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n" +
         more + "DimSize = " + sizes + "\nElementType = " + type + "\nElementDataFile = LOCAL\n" +
         data;
}

std::string nifti(std::array<std::int16_t, 3> sizes = {4, 5, 6},
                  std::array<float, 3> spacing = {0.1f, 0.2f, 0.3f}, std::int16_t type = 512,
                  const std::string& data = counting_data()) {
  std::string header(352, '\0');
  const auto put = [&](std::size_t at, auto value) {
    std::memcpy(header.data() + at, &value, sizeof(value));
  };
  put(0, std::int32_t{348});
  put(40, std::int16_t{3});
  for (std::size_t d = 0; d < 3; ++d) {
    put(42 + 2 * d, sizes[d]);
    put(80 + 4 * d, spacing[d]);
  }
  put(70, type);
  put(72, std::int16_t{16});
  put(76, 1.0f);
  put(108, 352.0f);
  header[123] = 2;  // mm
  std::memcpy(header.data() + 344, "n+1", 3);
  return header + data;
}

/// A TIFF of `pages` pages of 4 x 5 16-bit grey values; the tag `change` of the last is `to`.
std::string tiff(int pages, int first_value = 0, std::uint16_t change = 0, std::uint32_t to = 0) {
  std::string file = "II*" + std::string(1, '\0') + bytes_of(std::uint32_t{8});
  for (int page = 0; page < pages; ++page) {
    constexpr std::uint16_t kEntries = 9;
    const auto data_at = static_cast<std::uint32_t>(file.size() + 2 + 12 * kEntries + 4);
    const auto entry = [&](std::uint16_t tag, std::uint16_t type, std::uint32_t value) {
      if (tag == change && page + 1 == pages) value = to;
      file += bytes_of(tag) + bytes_of(type) + bytes_of(std::uint32_t{1}) + bytes_of(value);
    };
    file += bytes_of(kEntries);
    entry(256, 3, 4);        // width
    entry(257, 3, 5);        // height
    entry(258, 3, 16);       // bits
    entry(259, 3, 1);        // no compression
    entry(262, 3, 1);        // black is zero
    entry(273, 4, data_at);  // strip
    entry(277, 3, 1);        // one sample
    entry(278, 3, 5);        // rows in the strip
    entry(279, 4, 40);       // bytes of it
    file += bytes_of(page + 1 < pages ? data_at + 40 : std::uint32_t{0});
    for (int v = 0; v < 20; ++v) {
      file += bytes_of(static_cast<std::uint16_t>(first_value + page * 20 + v));
    }
  }
  return file;
}

/// A DICOM slice of 4 x 5 at height z_mm, grey values 2 v - 10 for v from `first_value` on.
std::string dicom(int instance, double z_mm, int first_value) {
  const auto element = [](std::uint16_t group, std::uint16_t tag, const std::string& kind,
                          std::string value) {
    if (value.size() % 2 != 0) value += kind == "UI" ? '\0' : ' ';
    std::string bytes = bytes_of(group) + bytes_of(tag) + kind;
    if (kind == "OB" || kind == "OW") {
      bytes += std::string(2, '\0') + bytes_of(static_cast<std::uint32_t>(value.size()));
    } else {
      bytes += bytes_of(static_cast<std::uint16_t>(value.size()));
    }
    return bytes + value;
  };
  const auto u16 = [](int v) { return bytes_of(static_cast<std::uint16_t>(v)); };
  const std::string ct = "1.2.840.10008.5.1.4.1.1.2";
  const std::string uid = "1.2.3.4." + std::to_string(instance + 1);
  std::ostringstream position;
  position << "1\\2\\" << z_mm;
  std::string meta_group = element(2, 1, "OB", std::string("\0\1", 2)) + element(2, 2, "UI", ct) +
                           element(2, 3, "UI", uid) +
                           element(2, 0x10, "UI", "1.2.840.10008.1.2.1") +
                           element(2, 0x12, "UI", "1.2.3");
  meta_group =
      element(2, 0, "UL", bytes_of(static_cast<std::uint32_t>(meta_group.size()))) + meta_group;
  std::string pixels;
  for (int v = 0; v < 20; ++v) pixels += u16(first_value + v);
  return std::string(128, '\0') + "DICM" + meta_group + element(8, 0x16, "UI", ct) +
         element(8, 0x18, "UI", uid) + element(8, 0x60, "CS", "CT") +
         element(0x20, 0x0d, "UI", "1.2.3.5") + element(0x20, 0x0e, "UI", "1.2.3.6") +
         element(0x20, 0x13, "IS", std::to_string(instance)) +
         element(0x20, 0x32, "DS", position.str()) + element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0") +
         element(0x28, 2, "US", u16(1)) + element(0x28, 4, "CS", "MONOCHROME2") +
         element(0x28, 0x10, "US", u16(5)) + element(0x28, 0x11, "US", u16(4)) +
         element(0x28, 0x30, "DS", "0.2\\0.1") + element(0x28, 0x100, "US", u16(16)) +
         element(0x28, 0x101, "US", u16(16)) + element(0x28, 0x102, "US", u16(15)) +
         element(0x28, 0x103, "US", u16(0)) + element(0x28, 0x1052, "DS", "-10") +
         element(0x28, 0x1053, "DS", "2") + element(0x7fe0, 0x10, "OW", pixels);
}

void expect_counting(const MedicalVolume& volume) {
  ASSERT_EQ(volume.sizes, Eigen::Vector3i(4, 5, 6));
  ASSERT_EQ(volume.values.size(), 120u);
  for (int v = 0; v < 120; ++v) ASSERT_EQ(volume.values[static_cast<std::size_t>(v)], v);
  EXPECT_EQ(volume.at(3, 1, 2), 3 + 4 + 40);
}

/// Deflated, in the wrapping of gzip.
std::string packed(const std::string& bytes) {
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 9, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::string error_of(const std::string& path, const InputLimits& limits = {}) {
  try {
    read_medical_volume(path, limits);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(MedicalVolume, ReadsNrrd) {
  const ScratchFolder folder;
  const MedicalVolume volume =
      read_medical_volume(folder.write("a.nrrd", nrrd("4 5 6", "spacings: 0.1 0.2 0.3\n")));
  expect_counting(volume);
  EXPECT_TRUE(volume.spacing_known);
  EXPECT_TRUE(volume.spacing_m.isApprox(Eigen::Vector3d(1e-4, 2e-4, 3e-4), 1e-6));
}

TEST(MedicalVolume, ReadsNrrdDirectionsAndUnits) {
  const ScratchFolder folder;
  const MedicalVolume volume = read_medical_volume(folder.write(
      "a.nrrd", nrrd("4 5 6",
                     "space: left-posterior-superior\n"
                     "space directions: (0,100,0) (-50,0,0) (0,0,25)\n"
                     "space origin: (1000,0,0)\nspace units: \"um\" \"um\" \"um\"\n")));
  expect_counting(volume);
  EXPECT_TRUE(volume.spacing_m.isApprox(Eigen::Vector3d(1e-4, 5e-5, 2.5e-5), 1e-6));
  EXPECT_TRUE(volume.direction.col(0).isApprox(Eigen::Vector3d(0, 1, 0), 1e-6));
  EXPECT_TRUE(volume.direction.col(1).isApprox(Eigen::Vector3d(-1, 0, 0), 1e-6));
  EXPECT_NEAR(volume.origin_m.x(), 1e-3, 1e-9);
}

TEST(MedicalVolume, KnowsWhereSpacingIsMissing) {
  const ScratchFolder folder;
  EXPECT_FALSE(read_medical_volume(folder.write("a.nrrd", nrrd())).spacing_known);
  EXPECT_FALSE(read_medical_volume(folder.write("b.nrrd", nrrd("4 5 6", "spacings: 0.1 nan 1\n")))
                   .spacing_known);
  EXPECT_FALSE(read_medical_volume(folder.write("a.mha", meta())).spacing_known);
}

TEST(MedicalVolume, ReadsMetaImage) {
  const ScratchFolder folder;
  const MedicalVolume volume =
      read_medical_volume(folder.write("a.mha", meta("4 5 6", "ElementSpacing = 0.1 0.2 0.3\n")));
  expect_counting(volume);
  EXPECT_TRUE(volume.spacing_m.isApprox(Eigen::Vector3d(1e-4, 2e-4, 3e-4), 1e-6));
}

TEST(MedicalVolume, ReadsNifti) {
  const ScratchFolder folder;
  const MedicalVolume volume = read_medical_volume(folder.write("a.nii", nifti()));
  expect_counting(volume);
  EXPECT_TRUE(volume.spacing_m.isApprox(Eigen::Vector3d(1e-4, 2e-4, 3e-4), 1e-6));
}

TEST(MedicalVolume, ReadsTiffStacks) {
  const ScratchFolder folder;
  const MedicalVolume pages = read_medical_volume(folder.write("a.tif", tiff(6)));
  expect_counting(pages);
  EXPECT_FALSE(pages.spacing_known);
  // Numbers count, not letters: 10 comes after 9.
  for (int k = 0; k < 6; ++k) {
    folder.write("slices/slice_" + std::to_string(k + 7) + ".tif", tiff(1, 20 * k));
  }
  expect_counting(read_medical_volume(folder.path("slices")));
}

TEST(MedicalVolume, ReadsDicomSeries) {
  const ScratchFolder folder;
  // Neither names nor instance numbers in the order of space: positions decide.
  for (int k = 0; k < 6; ++k) {
    folder.write("series/" + std::string(1, static_cast<char>('f' - k)), dicom(k, 0.3 * k, 20 * k));
  }
  const MedicalVolume volume = read_medical_volume(folder.path("series"));
  ASSERT_EQ(volume.sizes, Eigen::Vector3i(4, 5, 6));
  EXPECT_TRUE(volume.spacing_m.isApprox(Eigen::Vector3d(1e-4, 2e-4, 3e-4), 1e-6))
      << volume.spacing_m.transpose();
  for (int v = 0; v < 120; ++v) {
    ASSERT_EQ(volume.values[static_cast<std::size_t>(v)], 2 * v - 10) << v;
  }
}

TEST(MedicalVolume, ValuesThatAreNotFiniteBecomeTheLeastOrTheMost) {
  const ScratchFolder folder;
  const auto read = [&](const std::vector<double>& values) {
    std::string data;
    for (const double v : values) data += bytes_of(v);
    return read_medical_volume(
        folder.write("a.nrrd", nrrd("2 3 1", "spacings: 1 1 1\n", data, "raw", "3", "double")));
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const MedicalVolume volume = read({3, std::nan(""), 2, kInfinity, -kInfinity, 1e300});
  EXPECT_EQ(volume.values, (std::vector<float>{3, 2, 2, 3, 2, 3}));
  EXPECT_EQ(volume.warnings,
            (std::vector<std::string>{
                "2 values are infinite, or too large: taken as the largest, 3",
                "2 values are no number, padding, or below all: taken as the smallest, 2"}));
  EXPECT_TRUE(read({3, 1, 2, 3, 4, 5}).warnings.empty());
}

TEST(MedicalVolume, WrittenVolumesComeBack) {
  const ScratchFolder folder;
  VoxelModel model;
  model.grid.cells = {16, 24, 8};
  model.grid.voxel_m = 5e-5;
  model.leaves.resize(model.grid.leaf_count());
  auto tissues = std::make_shared<TissueMap>(model.grid.leaf_count());
  for (int k = 0; k < 8; ++k) {
    for (int j = 3; j < 20; ++j) {
      for (int i = 2; i < 11; ++i) model.set({i, j, k}, (i + j + k) % 3 != 0);
    }
  }
  for (std::uint32_t leaf = 0; leaf < model.grid.leaf_count(); ++leaf) {
    tissues->set_uniform(leaf, static_cast<std::uint8_t>(leaf % 2));
  }
  model.tissues = tissues;
  for (const VolumeContent content : {VolumeContent::kMask, VolumeContent::kLabels}) {
    const std::string path = folder.path("out.nrrd");
    write_volume(path, model, content);
    const MedicalVolume read = read_medical_volume(path);
    ASSERT_EQ(read.sizes, model.grid.cells);
    EXPECT_TRUE(read.spacing_m.isApprox(Eigen::Vector3d::Constant(5e-5), 1e-9));
    // The file's coordinates are the scene's.
    EXPECT_TRUE(read.origin_m.isApprox(model.grid.centre_world({0, 0, 0}), 1e-9));
    for (int k = 0; k < 8; ++k) {
      for (int j = 0; j < 24; ++j) {
        for (int i = 0; i < 16; ++i) {
          const Cell c(i, j, k);
          const int labelled = content == VolumeContent::kLabels ? 1 + model.tissue(c) : 1;
          ASSERT_EQ(read.at(i, j, k), model.solid(c) ? labelled : 0) << c.transpose();
        }
      }
    }
  }
  EXPECT_THROW(write_volume(folder.path("no/such/folder/out.nrrd"), model, VolumeContent::kMask),
               std::runtime_error);
}

struct BadVolume {
  std::string name, contents, says;

  friend std::ostream& operator<<(std::ostream& out, const BadVolume& volume) {
    return out << volume.name;
  }
};

class BadVolumes : public testing::TestWithParam<BadVolume> {};

TEST_P(BadVolumes, OneLineAndNothingElse) {
  const ScratchFolder folder;
  const std::string path = folder.write(GetParam().name, GetParam().contents);
  testing::internal::CaptureStderr();
  const std::string error = error_of(path);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_TRUE(error.starts_with(path)) << error;
  EXPECT_NE(error.find(GetParam().says), std::string::npos) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  EXPECT_LT(error.size(), path.size() + 300);
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    MedicalVolume, BadVolumes,
    testing::Values(
        BadVolume{"truncated.nrrd", nrrd("4 5 7"), "data: found 240 bytes, expected 280"},
        BadVolume{"longer.nrrd", nrrd("4 5 5"), "data: found 240 bytes, expected 200"},
        BadVolume{"overflow.nrrd", nrrd("4000000 5000000 6000000"), "at most 1073741824"},
        BadVolume{"overflow64.nrrd", nrrd("4294967296 4294967296 4294967297"), "at most"},
        BadVolume{"large.nrrd", nrrd("2000 2000 2000"), "sizes: found 2000 x 2000 x 2000"},
        BadVolume{"not_a_number.nrrd", nrrd("4 five 6"), "sizes: found \"five\""},
        BadVolume{"none.nrrd", nrrd("0 5 6"), "sizes: found 0"},
        BadVolume{"negative.nrrd", nrrd("-4 5 6"), "sizes: found -4"},
        BadVolume{"flat.nrrd", nrrd("20 6", "", counting_data(), "raw", "2"), "expected 3"},
        BadVolume{"fewer_sizes.nrrd", nrrd("20 6"), "as many as dimension says"},
        BadVolume{
            "rgb.nrrd",
            nrrd("3 4 5 2", "kinds: RGB-color domain domain domain\n", counting_data(), "raw", "4"),
            "kinds: found an axis of 3 that is not of space"},
        BadVolume{"block.nrrd", nrrd("4 5 6", "", counting_data(), "raw", "3", "block"), "type"},
        BadVolume{"spacing_0.nrrd", nrrd("4 5 6", "spacings: 0.1 0 0.3\n"), "spacings: found 0"},
        BadVolume{"spacing_minus.nrrd", nrrd("4 5 6", "spacings: 0.1 -1 1\n"),
                  "spacings: found -1"},
        BadVolume{"spacing_inf.nrrd", nrrd("4 5 6", "spacings: 0.1 inf 1\n"),
                  "spacings: found inf"},
        BadVolume{"parallel.nrrd",
                  nrrd("4 5 6", "space dimension: 3\nspace directions: (0,1,0) (0,1,0) (0,0,1)\n"),
                  "direction"},
        BadVolume{"small.gz.nrrd", nrrd("400 500 600", "", "0123456789", "gzip"), "data: found 10"},
        BadVolume{"damaged.gz.nrrd", nrrd("4 5 6", "", std::string(50, 'x'), "gzip"),
                  "data: found compressed data that are damaged"},
        BadVolume{"few.nrrd", nrrd("1 2 3", "", "1 2 3 4 5 six", "ascii"), "data: found \"six\""},
        BadVolume{"encoding.nrrd", nrrd("4 5 6", "", "", "morse"), "encoding"},
        BadVolume{"gone.nhdr", nrrd("4 5 6", "data file: gone.raw\n", ""), "data file"},
        BadVolume{"list.nhdr", nrrd("4 5 6", "data file: LIST\n", "a.raw\n"),
                  "data file: found \"a.raw\", expected a file that exists"},
        BadVolume{
            "list.mhd",
            "NDims = 3\nDimSize = 4 5 6\nElementType = MET_UCHAR\nElementDataFile = LIST\na\n",
            "ElementDataFile: found \"a\", expected a file that exists"},
        BadVolume{"other.nrrd", "a poem\n", "NRRD"}, BadVolume{"empty.nrrd", "", "empty file"},
        BadVolume{"twice.nrrd", nrrd("4 5 6", "sizes: 4 5 6\n"),
                  "sizes: found the field twice, expected it once"},
        BadVolume{"text.nrrd", nrrd("400 500 600", "", "1 2 3\n", "ascii"),
                  "data: found 6 bytes, expected at least 239999999 bytes after the header"},
        BadVolume{"hex.nrrd", nrrd("4 5 6", "", "00ff", "hex"),
                  "data: found 4 bytes, expected at least 480 bytes after the header"},
        BadVolume{"bomb.nrrd",
                  nrrd("4 5 6", "byte skip: -1\n", packed(std::string(1 << 20, '\0')), "gzip"),
                  "byte skip: found -1, expected 0 or more"},
        BadVolume{"zeros.nrrd", std::string(300, '\0'), "line 1: found no \"NRRD\", expected"},
        BadVolume{"ones.nrrd", std::string(300, '\xff'), "line 1: found no \"NRRD\", expected"},
        BadVolume{"negative.mha", meta("4 5 6", "CompressedData = True\nCompressedDataSize = -5\n"),
                  "CompressedDataSize: found -5, expected a number of bytes"},
        BadVolume{"twice.mha", meta("4 5 6", "DimSize = 4 5 6\n"),
                  "dimsize: found the field twice, expected it once"},
        BadVolume{"truncated.mha", meta("4 5 7"), "data: found 240 bytes, expected 280"},
        BadVolume{"overflow.mha", meta("4000000 5000000 6000000"), "at most"},
        BadVolume{"spacing.mha", meta("4 5 6", "ElementSpacing = 0 1 1\n"), "ElementSpacing"},
        BadVolume{"type.mha", meta("4 5 6", "", counting_data(), "MET_FOO"), "ElementType"},
        BadVolume{"colour.mha", meta("4 5 2", "ElementNumberOfChannels = 3\n"), "Channels"},
        BadVolume{"cut_off.mha",
                  meta("4 5 6", "CompressedData = True\nCompressedDataSize = 99\n", "0123"),
                  "data: found 4"},
        BadVolume{"truncated.nii", nifti({4, 5, 7}), "data: found 240 bytes"},
        BadVolume{"overflow.nii", nifti({32000, 32000, 32000}), "at most"},
        BadVolume{"negative.nii", nifti({-4, 5, 6}), "dim: found -4"},
        BadVolume{"spacing.nii", nifti({4, 5, 6}, {0.0f, 1.0f, 1.0f}), "pixdim: found 0"},
        BadVolume{"type.nii", nifti({4, 5, 6}, {1, 1, 1}, 9999), "datatype: found 9999"},
        BadVolume{"turned.nii", nifti().replace(256, 4, bytes_of(kNan)),
                  "orientation: found nan, expected numbers up to 1e9"},
        BadVolume{"tiny.nii", nifti({4, 5, 6}, {1e-40f, 1.0f, 1.0f}),
                  "pixdim: found 9.99995e-41, expected a positive length"},
        BadVolume{"second.nii", bytes_of(540) + std::string(600, '\0'),
                  "magic: found none, as ANALYZE 7.5 has it, expected n+2 or ni2"},
        BadVolume{"short.nii", "abc", "3 bytes"},
        BadVolume{"garbage.nii.gz", std::string(3000, '\x1f'), "sizeof_hdr"},
        BadVolume{"zeros.nii", std::string(592, '\0'), "sizeof_hdr: found 0, expected 348"},
        BadVolume{"ones.nii", std::string(592, '\xff'), "sizeof_hdr: found -1, expected 348"},
        BadVolume{"bomb.nii.gz", packed(nifti() + std::string(4 << 20, '\0')),
                  "data: found more than 1049168 bytes, expected as many as the header says"},
        BadVolume{"truncated.nii.gz", packed(nifti()).substr(0, 100),
                  "data: found compressed data that break off"},
        BadVolume{"garbage.tif", std::string(3000, 'x'), "TIFF"},
        BadVolume{"bits.tif", tiff(1, 0, 258, 17),
                  "page 0: found 17 bits of sample format 1, expected 1 to 16, 32 or 64"},
        BadVolume{"width.tif", tiff(2, 0, 256, 2),
                  "page 1: found a page of another form, expected that of the first"},
        BadVolume{"colours.tif", tiff(1, 0, 277, 3), "page 0: found colours (3 samples"},
        BadVolume{"fax.tif", tiff(1, 0, 259, 4), "page 0: found compression 4, expected none, LZW"},
        BadVolume{"huge.tif", tiff(1, 0, 257, 60000),
                  "data: found 162 bytes, expected at least 480000"},
        BadVolume{"garbage.dcm", std::string(3000, 'x'), "DICOM"},
        BadVolume{"tooth.step", "x", "extension \".step\""}),
    [](const auto& tested) {
      std::string name = tested.param.name;
      for (char& c : name) c = c == '.' ? '_' : c;
      return name;
    });

TEST(MedicalVolume, LimitsCanBeRaised) {
  const ScratchFolder folder;
  const std::string path = folder.write("a.nrrd", nrrd());
  EXPECT_EQ(error_of(path, {.memory_bytes = 119 * 4}),
            path + ": sizes: found 4 x 5 x 6 voxels, expected at most 119 (--limit-gib)");
  EXPECT_EQ(error_of(path, {.memory_bytes = 120 * 4}), "no error");
}

TEST(MedicalVolume, BigEndianAndSignedValuesAreRead) {
  const ScratchFolder folder;
  std::string big;
  for (int v = -60; v < 60; ++v) {
    const std::string little = bytes_of(static_cast<std::int16_t>(v));
    big += {little[1], little[0]};
  }
  const std::string header = replaced(nrrd("4 5 6", "", big, "raw", "3", "int16"), "little", "big");
  const MedicalVolume volume = read_medical_volume(folder.write("a.nrrd", header));
  ASSERT_EQ(volume.values.size(), 120u);
  EXPECT_EQ(volume.values.front(), -60.0f);
  EXPECT_EQ(volume.values.back(), 59.0f);
}

TEST(MedicalVolume, MissingFilesAndEmptyFolders) {
  const ScratchFolder folder;
  EXPECT_NE(error_of(folder.path("none.nrrd")).find("no such file"), std::string::npos);
  folder.write("series/readme", "no slice");
  EXPECT_NE(error_of(folder.path("series")).find("no DICOM series"), std::string::npos);
  folder.write("linked/s0.tif", tiff(1));
  std::filesystem::create_symlink("nothing", folder.path("linked/.#s0.tif"));
  EXPECT_EQ(error_of(folder.path("linked")), "no error");
  std::filesystem::create_symlink("nothing", folder.path("linked/s1.tif"));
  EXPECT_EQ(error_of(folder.path("linked")),
            folder.path("linked/s1.tif") +
                ": found a link to nothing, expected a slice, or another file");
}

TEST(MedicalVolume, TruncatedExportIsRefused) {
  const ScratchFolder folder;
  VoxelModel model;
  model.grid.cells = {32, 32, 32};
  model.grid.voxel_m = 1e-4;
  model.leaves.resize(model.grid.leaf_count());
  for (int i = 0; i < 30; ++i) model.set({i, i * i % 32, i * 7 % 32}, true);
  write_volume(folder.path("whole.nrrd"), model, VolumeContent::kMask);
  std::ifstream in(folder.path("whole.nrrd"), std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  bytes.resize(bytes.size() - 40);
  EXPECT_NE(error_of(folder.write("cut.nrrd", bytes)).find("found"), std::string::npos);
}

}  // namespace
}  // namespace sulcus::medical_volume_test
