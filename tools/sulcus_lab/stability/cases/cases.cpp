#include "tools/sulcus_lab/stability/cases/cases.hpp"

#include <array>

namespace sulcus::lab {

std::span<const StabilityCase> stability_cases() {
  static constexpr std::array<StabilityCase, 20> kCases{
      {{"thin_wall", thin_wall},
       {"thin_wall_stiffness", thin_wall_stiffness},
       {"tunnelling", tunnelling},
       {"sticking", sticking},
       {"buzz", buzz_case},
       {"edge_normals", edge_normals},
       {"tilted_planes", tilted_planes},
       {"opposing_faces", opposing_faces},
       {"vanishing_voxels", vanishing_voxels},
       {"count_steps", count_steps},
       {"deep_inside", deep_inside},
       {"sample_and_hold", sample_and_hold},
       {"coupling_mismatch", coupling_mismatch},
       {"spur", spur},
       {"loose_piece", loose_piece},
       {"wedge", wedge},
       {"proxy_thrown", proxy_thrown},
       {"overload", overload},
       {"late_tick", late_tick},
       {"cutting_energy", cutting_energy}}};
  return kCases;
}

}  // namespace sulcus::lab
