#include "engine/normals/normal_method.hpp"

#include <array>

#include <gtest/gtest.h>

#include "engine/normals/exact.hpp"
#include "engine/normals/ldm.hpp"
#include "engine/normals/ldm_fast.hpp"
#include "engine/normals/ldm_paper.hpp"
#include "engine/normals/weighted_sum.hpp"
#include "tests/support/normal_errors.hpp"

namespace sulcus::normal_method_test {
namespace {

using test::estimate_ldm, test::estimate_ldm_fast;

TEST(NormalMethod, TheNamedMethodIsTakenWithItsSettings) {
  const Workpiece workpiece(test::two_balls());
  const auto expected = [&](NormalMethod method, const Cell& c) {
    switch (method) {
      case NormalMethod::kLdm:
        return estimate_ldm(workpiece, c, 4, 7);
      case NormalMethod::kLdmFast:
        return estimate_ldm_fast(workpiece, c, 4, 7);
      case NormalMethod::kLdmPaper:
        return estimate_ldm_paper(workpiece, c, 4, 7);
      case NormalMethod::kWeightedSum:
        return estimate_weighted_sum(workpiece, c, 4, WeightedSum::kAsStated);
      case NormalMethod::kWeightedSumD2:
        return estimate_weighted_sum(workpiece, c, 4, WeightedSum::kAsPlotted);
      case NormalMethod::kExact:
        return estimate_exact(workpiece, c, 4);
    }
    return SurfaceEstimate{};
  };
  NormalSettings settings;
  settings.neighbourhood = 4;
  settings.trace = 7;
  std::array<int, kNormalMethodNames.size()> differ{};
  const std::vector<Cell> cells = test::surface_cells(workpiece);
  for (std::size_t k = 0; k < cells.size(); k += 41) {
    std::vector<SurfaceEstimate> found;
    for (std::size_t m = 0; m < kNormalMethodNames.size(); ++m) {
      settings.normals = NormalMethod(m);
      found.push_back(estimate_surface(workpiece, cells[k], settings));
      ASSERT_TRUE(test::same_bits(found[m], expected(settings.normals, cells[k])))
          << kNormalMethodNames[m];
    }
    for (std::size_t m = 1; m < found.size(); ++m) {
      differ[m] += !test::same_bits(found[m - 1], found[m]);
    }
  }
  // None stands in for another.
  for (std::size_t m = 1; m < differ.size(); ++m) EXPECT_GT(differ[m], 5) << kNormalMethodNames[m];
}

}  // namespace
}  // namespace sulcus::normal_method_test
