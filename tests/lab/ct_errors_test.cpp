#include "tools/sulcus_lab/fractions/ct_errors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "engine/import/volumes/medical_volume.hpp"
#include "engine/volume/workpiece.hpp"
#include "tests/lab/grey_volumes.hpp"
#include "tests/support/command.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/sulcus_lab/fractions/fractions.hpp"
#include "tools/sulcus_lab/truth/grey_surface.hpp"

namespace sulcus::lab::ct_errors_test {
namespace {

using Eigen::Vector3d;
using namespace test;

void say_nothing(const std::string&) {}

// Off the lattice, in a file with an odd and an even number of voxels along its axes.
const GreyBall kBall{Vector3d(17.3, 16.9, 18.2), 11.4};
const Eigen::Vector3i kSizes(35, 34, 37);

class OfABall : public ::testing::Test {
 protected:
  CtFile file(const std::array<double, 3>& edges_mm = {0.1, 0.1, 0.1}) const {
    return {folder_.write("ball.nrrd", nrrd_of(scanned(kSizes, kBall, Smeared()), edges_mm)),
            kHalfGrey};
  }
  ScratchFolder folder_;
};

/// That the voxels of a model are those of its file, shifted by whole voxels.
void expect_the_files_voxels(const CtFile& file) {
  const MedicalVolume volume = read_medical_volume(file.path);
  const CtModel ct = load_ct(file, SurfaceKind::kBinary);
  const Vector3d place = ct.lattice_from_index * Vector3d::Zero();
  const Cell shift = place.array().round().cast<int>();
  EXPECT_LT((place - shift.cast<double>()).norm(), 1e-9);
  EXPECT_TRUE(ct.lattice_from_index.linear().isIdentity(1e-9));
  EXPECT_TRUE(load_ct(file, SurfaceKind::kFractions)
                  .lattice_from_index.isApprox(ct.lattice_from_index, 1e-9));
  std::size_t other = 0, solid = 0;
  for_each_cell(Cell::Zero(), volume.sizes, [&](const Cell& c) {
    const bool is = volume.at(c.x(), c.y(), c.z()) >= file.solid_above;
    solid += is ? 1 : 0;
    other += ct.model.solid(c - shift) == is ? 0 : 1;
  });
  EXPECT_EQ(other, 0u);
  EXPECT_EQ(ct.model.solid_count(), solid);
  EXPECT_FALSE(ct.model.clipped);
}

struct Mean {
  double offset = 0.0, offset_rms = 0.0, normal_deg = 0.0;
};
Mean mean_of(const CtErrors& errors) {
  Mean mean;
  for (const CtVoxel& voxel : errors.voxels) {
    mean.offset += voxel.offset_error;
    mean.offset_rms += voxel.offset_error * voxel.offset_error;
    mean.normal_deg += voxel.normal_error_deg;
  }
  const auto count = static_cast<double>(errors.voxels.size());
  return {mean.offset / count, std::sqrt(mean.offset_rms / count), mean.normal_deg / count};
}

TEST_F(OfABall, VoxelsAreThoseOfTheFile) { expect_the_files_voxels(file()); }

/// The import's kernel moves the surface of a ball inwards by 1 / (3 R): by so much the fitted
/// surface lies too deep against the values' own, and by nothing against that of the smoothed ones.
/// A shift of half a voxel between file and grid would be 0.3 of a voxel RMS.
TEST_F(OfABall, FractionsAreOffByWhatTheImportSmooths) {
  for (const int finer : {1, 2}) {
    const auto [through, smoothed] = ct_errors(file(), finer, say_nothing);
    for (const CtErrors& of : {through[0], through[1], smoothed[0], smoothed[1]}) {
      EXPECT_GT(of.voxels.size(), 1000u);
      EXPECT_EQ(of.thin + of.flat + of.undefined, 0u);
    }
    const double radius = finer * kBall.radius;  // voxels
    EXPECT_NEAR(mean_of(through[1]).offset, -finer / (3.0 * kBall.radius), 2e-3 * finer);
    EXPECT_NEAR(mean_of(smoothed[1]).offset, 0.0, 2e-3 * finer);
    EXPECT_LT(mean_of(smoothed[1]).offset_rms, 0.01);
    EXPECT_LT(mean_of(smoothed[1]).normal_deg, 0.3);
    EXPECT_GT(mean_of(smoothed[0]).offset_rms, 3.0 * mean_of(smoothed[1]).offset_rms);
    EXPECT_GT(mean_of(smoothed[0]).normal_deg, 2.0 * mean_of(smoothed[1]).normal_deg);
    for (const CtVoxel& voxel : through[1].voxels) {
      ASSERT_NEAR(voxel.curvature, 1.0 / radius, 0.02);
    }
  }
}

TEST_F(OfABall, BinsHoldEveryVoxelOnce) {
  const auto errors = ct_errors(file(), 1, say_nothing);
  const std::vector<CtVoxel>& voxels = errors[0][1].voxels;
  std::map<std::string, OfSurfaces> sums;
  for (const CtBin& bin : ct_bins(errors)) {
    EXPECT_LT(bin.from, bin.to);
    OfSurfaces& sum = sums[std::string(bin.quantity) + std::string(bin.truth)];
    for (std::size_t s = 0; s < 2; ++s) sum[s] += bin.share_pct[s];
    if (bin.quantity != "offset_error_voxels" || bin.truth != "through") continue;
    // Those of it, counted.
    double share_pct = 0.0;
    for (const CtVoxel& voxel : voxels) {
      const double e = voxel.offset_error;
      if (e >= bin.from && e < bin.to) share_pct += 100.0 / static_cast<double>(voxels.size());
    }
    EXPECT_NEAR(bin.share_pct[1], share_pct, 0.2);
  }
  EXPECT_EQ(sums.size(), 4u);
  for (const auto& [name, sum] : sums) {
    for (const double share_pct : sum) EXPECT_NEAR(share_pct, 100.0, 0.5) << name;
  }
}

TEST_F(OfABall, VoxelsThatAreNoCubesAreAnError) {
  EXPECT_THROW(load_ct(file({0.1, 0.1, 0.2}), SurfaceKind::kBinary), InputError);
  EXPECT_THROW(load_ct({folder_.path("none.nrrd"), 600.0}, SurfaceKind::kBinary), InputError);
}

TEST_F(OfABall, TheCommandMeasuresIt) {
  const std::string out = folder_.path("out");
  const auto run = [&](const std::string& options) {
    return program_command(SULCUS_LAB_PROGRAM,
                           "fractions --quick --measure ct -o " + out + " " + options,
                           folder_.path("err"));
  };
  const auto skipped = run("");
  EXPECT_EQ(skipped.status, 0) << skipped.err;
  EXPECT_NE(skipped.out.find("ct: not measured without --ct FILE\n"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(out + "/fractions_ct.png"));

  const auto measured = run("--solid-above 650 --ct " + file().path);
  EXPECT_EQ(measured.status, 0) << measured.err;
  EXPECT_TRUE(std::filesystem::exists(out + "/fractions_ct.png"));
  EXPECT_NE(read_file(out + "/fractions_ct.csv").find("normal_error_deg,smoothed,"),
            std::string::npos);
  EXPECT_NE(read_file(out + "/fractions.csv")
                .find("offset_error_voxels,\"ct, through\",\"the file's voxels, all\""),
            std::string::npos);

  const std::string text = folder_.write("text.nrrd", "no volume");
  for (const std::string& bad :
       {"--solid-above 650 --ct " + text, "--solid-above 650 --ct " + folder_.path("none.nrrd"),
        "--solid-above 2000 --ct " + file().path, "--ct " + file().path,
        std::string("--solid-above 650")}) {
    const auto failed = run(bad);
    EXPECT_EQ(failed.status, 2) << bad;
    EXPECT_EQ(failed.err_lines(), 1) << failed.err;
  }
}

#ifndef SULCUS_SANITIZED
const std::string kTooth = SULCUS_SOURCE_DIR "/../shared/data/ge_tooth/tooth_103x94x161_u16.nrrd";
constexpr double kToothAbove = 600.0;

class OfARealTooth : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kTooth)) GTEST_SKIP() << "no " << kTooth;
  }
};

TEST_F(OfARealTooth, VoxelsAreThoseOfTheFile) { expect_the_files_voxels({kTooth, kToothAbove}); }

TEST_F(OfARealTooth, FractionsAreBetter) {
  FractionOptions options;
  options.quick = true;
  options.ct = {kTooth, kToothAbove};
  const std::vector<FractionRow> rows = fractions_of_ct(options);
  EXPECT_EQ(rows.size(), 12u);
  for (const FractionRow& row : rows) {
    SCOPED_TRACE(row.quantity + ", " + row.shape + ", " + row.setting);
    EXPECT_GT(row.fractions(), 0.0);
    // Binary voxels of the file are not smoothed: where it hardly curves they lie about the surface
    // through the values, which the import's smoothing leaves by more than they scatter.
    const bool smoothing_shows = row.shape == "ct, through" &&
                                 row.quantity == "offset_error_voxels" &&
                                 row.setting.ends_with("gently curved");
    EXPECT_LT(row.fractions(), smoothing_shows ? 0.1 : row.binary());
  }
}

/// Against counting points on which side of the smoothed surface they lie.
TEST_F(OfARealTooth, FillsAreWhatTheSmoothedSurfaceCutsOff) {
  const GreySpline spline(read_medical_volume(kTooth), GreyTruth::kSmoothed);
  const GreySurface surface(spline, kToothAbove);
  const CtModel ct = load_ct({kTooth, kToothAbove}, SurfaceKind::kFractions);
  const Workpiece workpiece{VoxelModel(ct.model)};
  double squares = 0.0, sum = 0.0, part_filled = 0.0;
  int count = 0, number = 0;
  for_each_cell(Cell::Zero(), workpiece.grid().cells, [&](const Cell& c) {
    if (!workpiece.is_surface(c) || number++ % 29 != 0) return;
    constexpr int kParts = 8;
    int in = 0;
    for_each_cell(Cell::Zero(), Cell::Constant(kParts), [&](const Cell& part) {
      const Vector3d to = (part.cast<double>().array() + 0.5) / kParts - 0.5;
      in += surface.solid(ct.lattice_from_index * (c.cast<double>() + to)) ? 1 : 0;
    });
    const double off =
        workpiece.level(c) / static_cast<double>(kFullLevel) - in / std::pow(kParts, 3);
    squares += off * off;
    sum += off;
    part_filled += in % (kParts * kParts * kParts) != 0 ? 1 : 0;
    ++count;
  });
  EXPECT_GT(count, 1000);
  EXPECT_GT(part_filled, 0.8 * count);
  EXPECT_LT(std::sqrt(squares / count), 0.015);
  EXPECT_LT(std::abs(sum / count), 0.003);
}

/// Catmull and Rom's interpolation, of floats and of its four nearest along each axis.
double catmull_rom(const MedicalVolume& volume, const Vector3d& p) {
  const Vector3d floor = p.array().floor();
  const Cell base = floor.cast<int>();
  const auto weights = [](double t) -> std::array<double, 4> {
    return {0.5 * t * (t * (2.0 - t) - 1.0), 1.0 + 0.5 * t * t * (3.0 * t - 5.0),
            0.5 * t * (1.0 + t * (4.0 - 3.0 * t)), 0.5 * t * t * (t - 1.0)};
  };
  const Vector3d t = p - floor;
  const auto x = weights(t.x()), y = weights(t.y()), z = weights(t.z());
  double sum = 0.0;
  for_each_cell(Cell::Zero(), Cell::Constant(4), [&](const Cell& to) {
    const Cell c = (base + to - Cell::Ones()).cwiseMax(0).cwiseMin(volume.sizes - Cell::Ones());
    sum += x[static_cast<std::size_t>(to.x())] * y[static_cast<std::size_t>(to.y())] *
           z[static_cast<std::size_t>(to.z())] * volume.at(c.x(), c.y(), c.z());
  });
  return sum;
}

/// Another interpolation, in voxels four times as fine, has the surface where the spline has it: of
/// its points near a surface voxel that are beyond the surface none is nearer than the closest
/// point, but by what the two differ, and some are as near as a fine voxel lets them be.
TEST_F(OfARealTooth, AnotherInterpolationFourTimesAsFineAgrees) {
  const MedicalVolume volume = read_medical_volume(kTooth);
  const GreySpline spline(volume, GreyTruth::kThrough);
  const GreySurface surface(spline, kToothAbove);
  const CtModel ct = load_ct({kTooth, kToothAbove}, SurfaceKind::kBinary);
  const Workpiece workpiece{VoxelModel(ct.model)};
  std::vector<double> beyond;  // of the nearest such point to the closest point's distance
  int number = 0;
  for_each_cell(Cell::Zero(), workpiece.grid().cells, [&](const Cell& c) {
    if (!workpiece.is_surface(c) || number++ % 97 != 0) return;
    const Vector3d p = ct.lattice_from_index * c.cast<double>();
    const auto at = surface.closest_point(p);
    if (!at) return;
    double nearest = 9.0;
    constexpr int kReach = 6;
    for_each_cell(Cell::Constant(-kReach), Cell::Constant(kReach + 1), [&](const Cell& to) {
      const Vector3d q = 0.25 * to.cast<double>();
      if (q.norm() < nearest && catmull_rom(volume, p + q) < kToothAbove) nearest = q.norm();
    });
    if (nearest < 9.0) beyond.push_back(nearest - at->offset);
  });
  std::ranges::sort(beyond);
  const std::size_t count = beyond.size();
  ASSERT_GT(count, 350u);
  EXPECT_GT(beyond[count / 100], -0.05);
  EXPECT_GT(beyond[count / 2], 0.0);
  EXPECT_LT(beyond[count / 2], 0.15);
  EXPECT_LT(beyond[count - 1 - count / 100], 0.35);
}
#endif

}  // namespace
}  // namespace sulcus::lab::ct_errors_test
