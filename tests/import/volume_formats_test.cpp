#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "engine/import/volumes/voxelise_volume.hpp"
#include "tests/import/oblique_volume.hpp"
#include "tests/support/itk_files.hpp"
#include "tests/support/scratch_folder.hpp"

// One volume, written by ITK in every format that is read, gives the same grey values, lies at the
// same place and becomes the same voxels.

namespace sulcus::volume_formats_test {
namespace {

const std::vector<TissueSettings> kTwoTissues = {{.name = "dentine", .above = {}},
                                                 {.name = "enamel", .above = 900.0}};

struct Case {
  MedicalVolume volume;
  double solid_above;
  VoxelGrid grid;
};

VoxelModel voxels_of(const MedicalVolume& volume, const Case& c, bool spacing_said = false) {
  WorkpieceSettings settings;
  settings.solid_above = c.solid_above;
  settings.rotation = {0.1, -0.2, 0.3};
  if (spacing_said) settings.spacing_m = c.volume.spacing_m;
  return voxelise_volume(volume, c.grid, settings, kTwoTissues);
}

void expect_same_voxels(const VoxelModel& expected, const VoxelModel& model) {
  ASSERT_GT(expected.solid_count(), 10000u);
  EXPECT_EQ(expected.leaves, model.leaves);
  ASSERT_TRUE(expected.tissues && model.tissues);
  std::size_t others = 0;
  for (std::uint32_t v = 0; v < expected.grid.cell_count(); ++v) {
    const Cell c = expected.grid.cell_of_linear(v);
    others += expected.solid(c) && expected.tissue(c) != model.tissue(c) ? 1 : 0;
  }
  EXPECT_EQ(others, 0u);
}

void expect_same_geometry(const MedicalVolume& expected, const MedicalVolume& read) {
  EXPECT_TRUE(read.spacing_known);
  const double voxel = expected.spacing_m.minCoeff();
  EXPECT_LT((read.spacing_m - expected.spacing_m).norm(), 1e-6 * voxel);
  EXPECT_LT((read.origin_m - expected.origin_m).norm(), 1e-3 * voxel);
  EXPECT_LT((read.direction - expected.direction).norm(), 1e-6);
}

std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// Turns the data of a detached header over, two bytes a voxel.
void make_big_endian(const std::string& header, const std::string& data, const std::string& little,
                     const std::string& big) {
  std::string bytes = contents(data);
  for (std::size_t b = 0; b + 1 < bytes.size(); b += 2) std::swap(bytes[b], bytes[b + 1]);
  std::ofstream(data, std::ios::binary) << bytes;
  std::string text = contents(header);
  const std::size_t at = text.find(little);
  ASSERT_NE(at, std::string::npos) << text;
  std::ofstream(header, std::ios::binary) << text.replace(at, little.size(), big);
}

void check_all_formats(const Case& c) {
  const ScratchFolder folder;
  const test::PlainVolume plain = test::plain(c.volume);
  const VoxelModel expected = voxels_of(c.volume, c);
  const auto check = [&](const std::string& path) {
    SCOPED_TRACE(path);
    const MedicalVolume read = read_medical_volume(path);
    EXPECT_EQ(read.values, c.volume.values);
    expect_same_geometry(c.volume, read);
    expect_same_voxels(expected, voxels_of(read, c));
  };
  for (const char* name : {"a.nrrd", "b.nhdr", "c.mha", "d.mhd", "e.nii", "f.nii.gz"}) {
    test::write_with_itk(folder.path(name), plain);
    check(folder.path(name));
  }
  ASSERT_TRUE(std::filesystem::exists(folder.path("b.raw")));  // they are detached
  ASSERT_TRUE(std::filesystem::exists(folder.path("d.raw")));
  make_big_endian(folder.path("b.nhdr"), folder.path("b.raw"), "endian: little", "endian: big");
  make_big_endian(folder.path("d.mhd"), folder.path("d.raw"), "BinaryDataByteOrderMSB = False",
                  "BinaryDataByteOrderMSB = True");
  check(folder.path("b.nhdr"));
  check(folder.path("d.mhd"));
  test::write_slices_with_itk(folder.path("dicom"), ".dcm", plain);
  check(folder.path("dicom"));

  // TIFF and PNG hold neither spacing nor origin nor directions: the spacing comes from the scene,
  // and the solid is that of a lattice along the axes.
  MedicalVolume upright = c.volume;
  upright.direction.setIdentity();
  const VoxelModel expected_upright = voxels_of(upright, c);
  test::write_with_itk(folder.path("g.tif"), plain);
  test::write_slices_with_itk(folder.path("tiffs"), ".tif", plain);
  test::write_slices_with_itk(folder.path("pngs"), ".png", plain);
  for (const char* name : {"g.tif", "tiffs", "pngs"}) {
    SCOPED_TRACE(name);
    const MedicalVolume read = read_medical_volume(folder.path(name));
    EXPECT_FALSE(read.spacing_known);
    EXPECT_THROW(voxels_of(read, c), InputError);
    EXPECT_EQ(read.values, c.volume.values);
    expect_same_voxels(expected_upright, voxels_of(read, c, true));
  }
}

TEST(VolumeFormats, AnObliqueAnisotropicVolumeIsTheSameInEach) {
  check_all_formats({test::oblique_volume(), test::kObliqueSolidAbove, {{64, 64, 64}, 8e-5}});
}

TEST(VolumeFormats, ARealToothIsTheSameInEach) {
  const std::string path = SULCUS_SOURCE_DIR "/../shared/data/ge_tooth/tooth_103x94x161_u16.nrrd";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  MedicalVolume volume = read_medical_volume(path);
  volume.origin_m = {-0.021, 0.034, 0.11};
  volume.direction = test::oblique_direction();
  check_all_formats({volume, 600.0, {{96, 96, 192}, 1.5e-4}});
}

TEST(VolumeFormats, SlicesGoByTheNumbersInTheirNames) {
  // Eleven slices: slice_10 and slice_11 come last, not after slice_1.
  test::PlainVolume volume;
  volume.sizes = {3, 2, 11};
  volume.spacing_mm = {1, 1, 1};
  volume.axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int v = 0; v < 66; ++v) volume.values.push_back(static_cast<std::uint16_t>(v * 500));
  const ScratchFolder folder;
  for (const char* extension : {".png", ".tif"}) {
    test::write_slices_with_itk(folder.path(extension + 1), extension, volume);
    const MedicalVolume read = read_medical_volume(folder.path(extension + 1));
    ASSERT_EQ(read.values.size(), 66u);
    for (int v = 0; v < 66; ++v)
      EXPECT_EQ(read.values[v], static_cast<float>(500 * v)) << extension;
  }
}

TEST(VolumeFormats, PngSlicesThatFitNothingAreRefusedInALine) {
  test::PlainVolume volume;
  volume.sizes = {8, 8, 2};
  volume.spacing_mm = {1, 1, 1};
  volume.axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int v = 0; v < 128; ++v) volume.values.push_back(static_cast<std::uint16_t>(v * 511));
  const ScratchFolder folder;
  const auto error_of = [&](const std::string& name) -> std::string {
    try {
      (void)read_medical_volume(folder.path(name));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  test::write_slices_with_itk(folder.path("cut"), ".png", volume);
  const std::string whole = contents(folder.path("cut/slice_2.png"));
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    folder.write("cut/slice_2.png", whole.substr(0, bytes));
    EXPECT_NE(error_of("cut").find("slice_2.png: "), std::string::npos) << bytes;
  }
  folder.write("cut/slice_2.png", whole);
  EXPECT_EQ(error_of("cut"), "no error");
  std::string wide = whole;
  wide[16] = '\x7f';  // 2 thousand million pixels wide
  folder.write("cut/slice_2.png", wide);
  EXPECT_NE(error_of("cut").find("slice_2.png: "), std::string::npos);

  volume.sizes = {4, 8, 2};
  test::write_slices_with_itk(folder.path("mixed"), ".png", volume);
  folder.write("mixed/slice_3.png", whole);
  EXPECT_NE(error_of("mixed").find("slice_3.png: found a slice of another size"),
            std::string::npos);
  folder.write("mixed/slice_4.tif", "II*");
  EXPECT_NE(error_of("mixed").find("slices of more than one of TIFF, PNG"), std::string::npos);
}

}  // namespace
}  // namespace sulcus::volume_formats_test
