#include "haptics/cutting_law.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "engine/core/units.hpp"
#include "tests/haptics/tick_run.hpp"
#include "tests/support/allocation_count.hpp"

namespace sulcus::cutting_law_test {
namespace {

constexpr double kEnamel = 3.5e9, kDentine = 0.65e9;  // J/m3
constexpr double kMuch_N = 1e6;
const SaturatingConstants kConstants;

BurrSettings diamond(Grit grit, double worn_m = 0.0) {
  BurrSettings burr;
  burr.grit = grit;
  burr.worn_m = worn_m;
  return burr;
}
BurrSettings carbide() {
  BurrSettings burr;
  burr.material = BurrMaterial::kCarbide;
  return burr;
}

/// Of removal, over that with all of the work at 1 N and 1 m/s.
double rate(const BurrSettings& burr, double load_N, double rim_m_per_s, double energy = kEnamel) {
  return SaturatingLaw(burr).share(energy, load_N, rim_m_per_s) * load_N * rim_m_per_s / energy;
}

TEST(SaturatingLaw, LightAndSlowAllOfTheWorkRemoves) {
  for (const BurrSettings& burr : {diamond(Grit::kFine), diamond(Grit::kSuperCoarse), carbide()}) {
    EXPECT_EQ(SaturatingLaw(burr).share(kEnamel, 0.0, 0.0), 1.0);
    EXPECT_LT(SaturatingLaw(burr).share(kEnamel, 0.1, 0.0), 1.0);
    EXPECT_LT(SaturatingLaw(burr).share(kEnamel, 0.0, 1.0), 1.0);
  }
}

TEST(SaturatingLaw, TheRateRisesWithTheLoadToALimitThatIsTheSameForAllTissues) {
  const BurrSettings burr = diamond(Grit::kMedium);
  for (const double energy : {kEnamel, kDentine}) {
    double before = 0.0;
    for (const double load_N : {0.1, 0.5, 1.0, 2.0, 5.0}) {
      EXPECT_GT(rate(burr, load_N, 1.0, energy), before);
      before = rate(burr, load_N, 1.0, energy);
    }
    const double speed = 1.0 / kConstants.diamond_m_per_s;
    EXPECT_NEAR(rate(burr, kMuch_N, 1.0, energy), kConstants.grain_area_m2 / (1.0 + speed * speed),
                1e-5 * kConstants.grain_area_m2);
    // Half of it at u A.
    EXPECT_NEAR(rate(burr, energy * kConstants.grain_area_m2, 1.0, energy),
                0.5 * rate(burr, kMuch_N, 1.0, energy), 1e-5 * kConstants.grain_area_m2);
  }
}

TEST(SaturatingLaw, TheRateIsGreatestAtOneSpeed) {
  for (const auto& [burr, best] : {std::pair{diamond(Grit::kCoarse), kConstants.diamond_m_per_s},
                                   std::pair{carbide(), kConstants.carbide_m_per_s}}) {
    for (const double part : {0.2, 0.8, 1.25, 5.0}) {
      EXPECT_LT(rate(burr, 1.0, part * best), rate(burr, 1.0, best)) << part;
      EXPECT_NEAR(rate(burr, 1.0, part * best), rate(burr, 1.0, best / part), 1e-9 * best);
    }
  }
}

TEST(SaturatingLaw, GritTakesLoadAndWearByTheCrossSectionOfItsGrains) {
  double before = 0.0;
  for (const Grit grit : {Grit::kFine, Grit::kMedium, Grit::kCoarse, Grit::kSuperCoarse}) {
    EXPECT_GT(rate(diamond(grit), 1.0, 1.0), before);
    before = rate(diamond(grit), 1.0, 1.0);
  }
  EXPECT_NEAR(
      rate(diamond(Grit::kCoarse), kMuch_N, 1.0) / rate(diamond(Grit::kMedium), kMuch_N, 1.0),
      std::pow(151.0 / 107.0, 2), 1e-4);
  const auto left = [](Grit grit, double worn_m) {
    return rate(diamond(grit, worn_m), 1.0, 1.0) / rate(diamond(grit), 1.0, 1.0);
  };
  EXPECT_NEAR(left(Grit::kMedium, kConstants.wear_length_m), 0.5, 1e-12);
  EXPECT_NEAR(left(Grit::kCoarse, std::pow(151.0 / 107.0, 2) * kConstants.wear_length_m), 0.5,
              1e-12);
  EXPECT_GT(left(Grit::kMedium, 10e-3), left(Grit::kMedium, 20e-3));
}

TEST(SaturatingLaw, CarbideHasNeitherGritNorWear) {
  BurrSettings burr = carbide();
  burr.grit = Grit::kSuperCoarse;
  burr.worn_m = 0.1;
  EXPECT_EQ(rate(burr, 1.0, 5.0), rate(carbide(), 1.0, 5.0));
}

/// Cut with a burr at a speed that takes some of the work; what it does in every tick.
class SaturatingTicks : public ::testing::Test {
 protected:
  SaturatingTicks() : run_(true), fast_(test::burr()) {
    run_.scene.cutting->law = CuttingLaw::kSaturating;
    run_.scene.spindle.emplace();
    run_.scene.burr.grit = Grit::kSuperCoarse;
    run_.scene.tissues[0].specific_energy_J_per_m3 = 0.5e9;
    fast_.speed_rad_per_s = run_.scene.burr.speed_rad_per_s = 150e3 * kRevolutionPerMinute;
    run_.begin_again();
  }

  test::TickRun run_;
  Burr fast_;
};

TEST_F(SaturatingTicks, TheShareIsOfTheNetNormalForceAndTheSpeedOfTheRim) {
  test::ListDevice device(test::path(100));
  const TickContext context{run_.scene, fast_};
  const SaturatingLaw law(run_.scene.burr);
  const double energy = run_.scene.tissues[0].specific_energy_J_per_m3;
  double removes_J = 0.0, least = 1.0, most = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double before_J = run_.state.work_J();
    const TickResult result = tick(context, device, run_.state, run_.scratch);
    const Wrench &all = result.contact.wrench, &tangential = result.contact.tangential;
    const double load_N = (all.force_N - tangential.force_N).norm();
    const double share = law.share(energy, load_N, result.spindle_rad_per_s * fast_.rim_radius_m);
    removes_J += share * (run_.state.work_J() - before_J);
    if (result.contact.contacts == 0) continue;
    least = std::min(least, share);
    most = std::max(most, share);
  }
  const RemovalState& removal = run_.removal();
  EXPECT_LT(2.0 * least, most) << "it changes";
  EXPECT_GT(removal.removed_J, 0.0);
  // What a voxel does not need when it goes is heat besides.
  EXPECT_LE(removal.removed_J + removal.stored_J(), removes_J * (1.0 + 1e-12));
  EXPECT_GT(removal.removed_J + removal.stored_J(), 0.9 * removes_J);
  EXPECT_NEAR(removal.removed_J + removal.stored_J() + removal.heat_J, removal.work_J,
              1e-12 * removal.work_J);
}

TEST_F(SaturatingTicks, NothingIsAllocated) {
  test::ListDevice device(test::path(100));
  const TickContext context{run_.scene, fast_};
  tick(context, device, run_.state, run_.scratch);
  const std::uint64_t before = test::allocation_count();
  for (int i = 1; i < 100; ++i) tick(context, device, run_.state, run_.scratch);
  EXPECT_EQ(test::allocation_count(), before);
}

}  // namespace
}  // namespace sulcus::cutting_law_test
