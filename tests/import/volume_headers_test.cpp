#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"

// One phantom in more than a hundred headers of other writers (write_volumes.py): units, sides,
// orders, byte orders, packings, frames and damage. What a header states is read, what it does not
// state is asked for, what is damaged is refused in one line.

namespace sulcus::volume_headers_test {
namespace {

constexpr double kPlace_mm = 0.05;

/// A label of the phantom, in the file's space.
struct LabelPlace {
  Eigen::Vector3d middle_mm = Eigen::Vector3d::Zero();
  double volume_mm3 = 0.0;
};
using Labels = std::array<LabelPlace, 3>;

/// A line of truth.txt.
struct Truth {
  std::string verdict, name, text;      // text: of a refusal
  double offset = 0.0, slope = 1.0;     // grey value = offset + slope * label
  Eigen::Vector3d spacing_mm{0, 0, 0};  // to be told where the file does not say it
  Labels labels;
};

std::vector<Truth> read_truth(const std::string& path) {
  std::vector<Truth> all;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    Truth truth;
    words >> truth.verdict >> truth.name;
    if (truth.verdict == "refuse") {
      std::getline(words >> std::ws, truth.text);
    } else {
      words >> truth.offset >> truth.slope;
      if (truth.verdict == "ask") {
        for (double& step : truth.spacing_mm) words >> step;
      }
      for (LabelPlace& label : truth.labels) {
        for (double& x : label.middle_mm) words >> x;
        words >> label.volume_mm3;
      }
      if (!words) ADD_FAILURE() << line;
    }
    all.push_back(truth);
  }
  return all;
}

Labels labels_of(const MedicalVolume& volume, const Truth& truth) {
  const Eigen::Vector3d spacing_mm =
      volume.spacing_known ? volume.spacing_m * 1e3 : truth.spacing_mm;
  const Eigen::Matrix3d steps_mm = volume.direction * spacing_mm.asDiagonal();
  Labels labels;
  for (std::size_t label = 0; label < labels.size(); ++label) {
    const double grey = truth.offset + truth.slope * static_cast<double>(label + 1);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (int k = 0; k < volume.sizes.z(); ++k) {
      for (int j = 0; j < volume.sizes.y(); ++j) {
        for (int i = 0; i < volume.sizes.x(); ++i) {
          if (std::abs(volume.at(i, j, k) - grey) > 1e-3) continue;
          sum += Eigen::Vector3d(i, j, k);
          ++count;
        }
      }
    }
    if (count == 0) continue;
    labels[label] = {volume.origin_m * 1e3 + steps_mm * sum / count,
                     count * std::abs(steps_mm.determinant())};
  }
  return labels;
}

/// Empty: as it should be.
std::string what_is_wrong(const MedicalVolume& volume, const Truth& truth) {
  std::ostringstream wrong;
  if (truth.verdict == "refuse") return "read, where it is to be refused: " + truth.text;
  if (volume.spacing_known != (truth.verdict == "read")) {
    return volume.spacing_known ? "takes a spacing that is not said" : "misses the spacing";
  }
  const Labels found = labels_of(volume, truth);
  for (std::size_t label = 0; label < found.size(); ++label) {
    const LabelPlace &is = found[label], &should = truth.labels[label];
    const double off_mm = (is.middle_mm - should.middle_mm).norm();
    if (off_mm < kPlace_mm &&
        std::abs(is.volume_mm3 - should.volume_mm3) < 1e-3 * should.volume_mm3 + 1e-9) {
      continue;
    }
    wrong << "label " << label + 1 << ": " << is.volume_mm3 << " mm3 at ("
          << is.middle_mm.transpose() << "), and not " << should.volume_mm3 << " at ("
          << should.middle_mm.transpose() << "); ";
  }
  return wrong.str();
}

/// What a reader makes of one, in a line; `wrong`: why that is not right.
std::string verdict_on(const std::string& folder, const Truth& truth, std::string& wrong) {
  const std::string path = folder + "/" + truth.name;
  try {
    const MedicalVolume volume = read_medical_volume(path);
    wrong = what_is_wrong(volume, truth);
    std::string line = volume.spacing_known ? "read" : "asks for spacing_mm";
    for (const std::string& warning : volume.warnings) line += "; " + warning;
    return line;
  } catch (const InputError& error) {
    const std::string line = error.what();
    if (truth.verdict != "refuse") wrong = "refused: " + line;
    if (truth.verdict == "refuse" && line.find(truth.text) == std::string::npos) {
      wrong = "refused by \"" + line + "\", and not by \"" + truth.text + "\"";
    }
    if (line.find('\n') != std::string::npos || !line.starts_with(path)) wrong = "no line: " + line;
    return "refused: " + line.substr(std::min(folder.size() + 1, line.size()));
  }
}

TEST(VolumeHeaders, OfOtherWritersAreReadRightlyOrRefused) {
  if (std::system(
          "command -v dcmcjpeg >/dev/null && "
          "/usr/bin/python3 -c 'import gdcm, nibabel, pydicom, tifffile, PIL' 2>/dev/null") != 0) {
    FAIL() << "its writers are not all installed (tools/test_packages.txt)";
  }
  const ScratchFolder folder;
  const test::CommandResult written = test::program_command(
      "/usr/bin/python3",
      "-B -W ignore " SULCUS_SOURCE_DIR "/tests/import/write_volumes.py " + folder.path("all"),
      folder.path("err"));
  ASSERT_EQ(written.status, 0) << written.err;
  int read = 0, asked = 0, refused = 0;
  for (const Truth& truth : read_truth(folder.path("all/truth.txt"))) {
    std::string wrong;
    std::cout << truth.name << ": " << verdict_on(folder.path("all"), truth, wrong) << "\n";
    EXPECT_EQ(wrong, "") << truth.name;
    ++(truth.verdict == "read" ? read : truth.verdict == "ask" ? asked : refused);
  }
  std::cout << read << " read, " << asked << " asked about, " << refused << " refused\n";
  EXPECT_GE(read, 140);
  EXPECT_GE(asked, 20);
  EXPECT_GE(refused, 45);
}

/// The phantom of the shared cases, and the same under a tilted gantry.
Truth shared_truth(const std::string& name, bool tilted, double slope = 1.0) {
  Truth truth{.verdict = "read", .name = name, .text = {}, .slope = slope, .labels = {}};
  if (tilted) {
    truth.labels = {{{{-4.847, 8.633, 102.873}, 114.984},
                     {{-0.25, 7.898, 101.974}, 8.346},
                     {{-7.45, 12.341, 101.283}, 18.778}}};
  } else {
    truth.labels = {{{{-4.847, 8.761, 103.847}, 119.04},
                     {{-0.25, 8.0, 102.75}, 8.64},
                     {{-7.45, 12.6, 103.25}, 19.44}}};
  }
  return truth;
}

TEST(VolumeHeaders, OfTheSharedCasesAreReadRightlyOrRefused) {
  const std::string folder = SULCUS_SOURCE_DIR "/../shared/cases";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  std::vector<Truth> cases{shared_truth("tilt", true), shared_truth("sheared.nrrd", true),
                           shared_truth("enhanced_interleaved.dcm", false),
                           shared_truth("monochrome1", false, 100.0)};
  cases.push_back(shared_truth("no_pixel_spacing", false));
  cases.back().verdict = "ask";
  cases.back().spacing_mm = {0.3, 0.4, 0.5};
  cases.push_back(
      {.verdict = "refuse", .name = "missing_three", .text = "3 slices are absent", .labels = {}});
  cases.push_back(
      {.verdict = "refuse", .name = "zero_tail.mha", .text = "data: found", .labels = {}});
  for (const Truth& truth : cases) {
    std::string wrong;
    std::cout << truth.name << ": " << verdict_on(folder, truth, wrong) << "\n";
    EXPECT_EQ(wrong, "") << truth.name;
  }
}

}  // namespace
}  // namespace sulcus::volume_headers_test
