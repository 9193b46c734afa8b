#include "engine/normals/normal_choice.hpp"

namespace sulcus {

namespace {

// The front of cost against error. The error is the worst of four shapes' means, in degrees:
//   sulcus-lab normals --shape sphere|torus|rotated_cube|molar --method ldm_fast,ldm --ns 1,..,12
// of the cube its faces, of the others all; rounded up to the next twentieth, as a margin. The
// molar at 0.07 mm, whose fissures are the finest, sets nearly all of them. Rows rise in cost. What
// costs more than a row and is no better once rounded is left out: ldm_fast from NS 7 on, ldm but
// at 5, which is within 0.04 of the best. No other method is on the front at any error.
constexpr int kTrace = 12;
constexpr NormalChoice kFront[] = {
    {{NormalMethod::kLdmFast, 1, kTrace}, 8.70}, {{NormalMethod::kLdmFast, 2, kTrace}, 3.10},
    {{NormalMethod::kLdmFast, 3, kTrace}, 1.75}, {{NormalMethod::kLdmFast, 4, kTrace}, 1.30},
    {{NormalMethod::kLdmFast, 5, kTrace}, 1.20}, {{NormalMethod::kLdmFast, 6, kTrace}, 1.15},
    {{NormalMethod::kLdm, 5, kTrace}, 1.05},
};

}  // namespace

std::optional<NormalChoice> choose_normals(double error_deg) {
  for (const NormalChoice& choice : kFront) {
    if (choice.error_deg <= error_deg) return choice;
  }
  return std::nullopt;
}

NormalChoice most_accurate_normals() { return std::end(kFront)[-1]; }

}  // namespace sulcus
