#include <cmath>

#include "engine/scene/trajectory.hpp"
#include "tools/fuzz/fuzz_targets.hpp"
#include "tools/fuzz/handed_file.hpp"

namespace sulcus::fuzz {

void fuzz_trajectory(Bytes bytes) {
  const HandedFile file(bytes, "poses.csv");
  TrajectorySettings settings;
  settings.file = file.path();
  constexpr InputLimits kLimits{.memory_bytes = 1 << 16};  // so that 512 rows are too many
  reads([&] {
    const Trajectory trajectory = make_trajectory(settings, kLimits);
    const double duration_s = trajectory.duration_s();
    expect(std::isfinite(duration_s) && duration_s >= 0.0, "a duration that is none");
    for (int i = 0; i <= 8; ++i) {
      const Pose pose = trajectory.pose_at(duration_s * i / 8);
      expect(pose.position.allFinite(), "a position that is not finite");
      expect(std::abs(pose.orientation.norm() - 1.0) < 1e-9, "an orientation that is none");
    }
  });
}

}  // namespace sulcus::fuzz
