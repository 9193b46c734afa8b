#include "tools/sulcus_lab/truth/truth_file.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "tests/support/scratch_folder.hpp"

namespace sulcus::lab::truth_file_test {
namespace {

constexpr const char* kHeader = "i,j,k,nx,ny,nz,zone\n";

/// A cube of 4 voxels, (2, 2, 2) to (5, 5, 5), in a file of 9 x 8 x 8.
VoxelModel small_cube() {
  MedicalVolume volume;
  volume.file = "cube.nrrd";
  volume.sizes = {9, 8, 8};
  volume.values.assign(9 * 8 * 8, 0.0f);
  for (int k = 2; k < 6; ++k) {
    for (int j = 2; j < 6; ++j) {
      for (int i = 2; i < 6; ++i) volume.values[volume.index(i, j, k)] = 3.0f;
    }
  }
  return model_of_mask(volume);
}

class TruthFile : public ::testing::Test {
 protected:
  TruthShape read(const std::string& text) {
    folder_.write("truth.csv", text);
    return read_truth_file(path(), small_cube(), "cube");
  }
  /// The one line that a table is refused with; empty where it is not.
  std::string refusal(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  std::string path() const { return folder_.path("truth.csv"); }

 private:
  ScratchFolder folder_;
};

TEST_F(TruthFile, AMaskKeepsItsIndices) {
  const VoxelModel model = small_cube();
  EXPECT_EQ(model.grid.cells, Eigen::Vector3i(16, 8, 8)) << "padded to multiples of 8";
  EXPECT_EQ(model.solid_count(), 64u);
  EXPECT_TRUE(model.solid({2, 2, 2}));
  EXPECT_FALSE(model.solid({6, 5, 5}));
}

TEST_F(TruthFile, AMaskThatIsTooLargeIsRefused) {
  MedicalVolume volume;
  volume.sizes = {1025, 1, 1};
  volume.values.assign(1025, 1.0f);
  EXPECT_THROW(model_of_mask(volume), InputError);
}

TEST_F(TruthFile, RowsBecomeVoxelsWithZonesInTheOrderOfTheFile) {
  const TruthShape truth = read(std::string(kHeader) +
                                "2,3,3,-1,0,0,flat\r\n"
                                "\n"
                                "5,5,3,0.705,0.705,0,edge\n"
                                "3,3,5,0,0,1.0e0,flat\n");
  EXPECT_EQ(truth.zones, (std::vector<std::string>{"flat", "edge"}));
  ASSERT_EQ(truth.voxels.size(), 3u);
  EXPECT_EQ(truth.voxels[0].cell, Cell(2, 3, 3));
  EXPECT_EQ(truth.voxels[0].normal, Eigen::Vector3d(-1, 0, 0));
  EXPECT_EQ(truth.voxels[1].zone, 1);
  EXPECT_NEAR(truth.voxels[1].normal.norm(), 1.0, 1e-12) << "0.3 % off is put right";
  EXPECT_EQ(truth.voxels[2].zone, 0);
  EXPECT_FALSE(truth.tool_direction);
}

TEST_F(TruthFile, BadRowsAreRefusedWithTheirLine) {
  const auto row = [&](const std::string& text) {
    return refusal(std::string(kHeader) + "2,3,3,-1,0,0,a\n" + text + "\n");
  };
  EXPECT_EQ(row("5,3,3,1,0,0,a"), "");
  const std::vector<std::pair<std::string, std::string>> cases{
      {"3,3,3,1,0,0,a", "inside the solid"},
      {"7,3,3,1,0,0,a", "empty"},
      {"16,3,3,1,0,0,a", "outside the volume"},
      {"-1,3,3,1,0,0,a", "outside the volume"},
      {"99999999999,3,3,1,0,0,a", "'99999999999'"},
      {"5.0,3,3,1,0,0,a", "'5.0'"},
      {"5,3,3,one,0,0,a", "'one'"},
      {"5,3,3,,0,0,a", "''"},
      {"5,3,3,nan,0,0,a", "length nan"},
      {"5,3,3,inf,0,0,a", "length inf"},
      {"5,3,3,0.9,0,0,a", "length 0.9"},
      {"5,3,3,0,0,0,a", "length 0"},
      {"5,3,3,1,0,0,", "''"},
      {"5,3,3,1,0,0,a b", "'a b'"},
      {"5,3,3,1,0,0,all", "'all'"},
      {"5,3,3,1,0,0", "seven fields"},
      {"5,3,3,1,0,0,a,b", "seven fields"},
      {"2,3,3,-1,0,0,a", "listed before"},
  };
  for (const auto& [text, part] : cases) {
    const std::string line = row(text);
    EXPECT_NE(line.find("line 3"), std::string::npos) << text << " -> " << line;
    EXPECT_NE(line.find(part), std::string::npos) << text << " -> " << line;
    EXPECT_NE(line.find("expected"), std::string::npos) << text << " -> " << line;
  }
}

TEST_F(TruthFile, AFileThatIsNoTableIsRefused) {
  EXPECT_NE(refusal("x,y,z\n1,2,3\n").find("line 1"), std::string::npos);
  EXPECT_NE(refusal("").find("line 1"), std::string::npos);
  EXPECT_NE(refusal(kHeader).find("no normals"), std::string::npos);
  EXPECT_THROW(read_truth_file(path() + ".none", small_cube(), "cube"), InputError);
}

}  // namespace
}  // namespace sulcus::lab::truth_file_test
