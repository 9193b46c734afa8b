#include <array>
#include <optional>
#include <string>

#include "app/report/assessment.hpp"
#include "app/report/measure_list.hpp"
#include "app/terminal/terminal.hpp"
#include "engine/assessment/insertion_frame.hpp"
#include "engine/assessment/preparation_shape.hpp"
#include "engine/core/error.hpp"

namespace sulcus {

Assessment assess_meshes(const TriangleMesh& before, const TriangleMesh& after,
                         const std::array<std::string, 2>& names,
                         const AssessmentSettings& settings) {
  constexpr double kMostOutside = 0.02;
  if (const double outside = share_outside(before, after, settings.insertion);
      outside > kMostOutside) {
    throw InputError(names[1], "--after",
                     formatted("%.0f %% of it outside of --before", 100.0 * outside),
                     "the same tooth in the same place");
  }
  const std::optional<PreparationShape> shape =
      preparation_shape(before, after, shape_settings(settings));
  if (!shape) {
    throw InputError(names[1], "--after", "nothing removed", "less tooth than --before");
  }
  MeasureList all(names[0] + ", " + names[1], settings);
  all.add(*shape);
  return all.finish();
}

}  // namespace sulcus
