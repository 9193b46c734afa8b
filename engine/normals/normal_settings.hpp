#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace sulcus {

enum class NormalMethod : std::uint8_t {
  kLdm,
  kLdmFast,
  kLdmPaper,
  kWeightedSum,    // 1 / d, as [Kim and Park 2019] states it
  kWeightedSumD2,  // 1 / d^2, as it plots it
  kExact           // its offline reference
};
/// As scenes and tables name them.
inline constexpr std::array<std::string_view, 6> kNormalMethodNames{
    "ldm", "ldm_fast", "ldm_paper", "weighted_sum", "weighted_sum_d2", "exact"};

/// How normals are estimated: the part of a scene's [haptics] that this folder knows.
struct NormalSettings {
  NormalMethod normals = NormalMethod::kLdm;
  /// NS, voxels. 10 on a coupling under `ldm` and `ldm_fast`: a stiff contact on a soft spring
  /// rests on a few voxels, so that no mean over many evens out what a window of 6 leaves of the
  /// steps of a gentle slope.
  int neighbourhood = 6;
  int trace = 12;  // alpha, voxels; 5 under ldm_paper
};

}  // namespace sulcus
