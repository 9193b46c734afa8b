#include <algorithm>
#include <cmath>

#include "engine/import/volumes/medical_volume.hpp"
#include "tools/fuzz/fuzz_targets.hpp"
#include "tools/fuzz/handed_file.hpp"

namespace sulcus::fuzz {
namespace {

const char* name_of(std::uint8_t letter) {
  switch (letter) {
    case 'd':
      return "a.dcm";
    case 'm':
      return "a.mha";
    case 'i':
      return "a.nii";
    case 'g':
      return "a.nii.gz";
    case 't':
      return "a.tif";
    default:
      return "a.nrrd";
  }
}

}  // namespace

void fuzz_volume(Bytes bytes) {
  if (bytes.empty()) return;
  const HandedFile file(bytes.subspan(1), name_of(bytes[0]));
  constexpr InputLimits kLimits{.memory_bytes = std::uint64_t{16} << 20};
  MedicalVolume volume;
  if (!reads([&] { volume = read_medical_volume(file.path(), kLimits); })) return;
  expect((volume.sizes.array() > 0).all() &&
             volume.values.size() == volume.index(0, 0, volume.sizes.z()),
         "another number of values than the sizes say");
  expect(std::ranges::all_of(volume.values, [](float v) { return std::isfinite(v); }),
         "a value that is not finite");
  expect(volume.spacing_m.allFinite() && (volume.spacing_m.array() > 0).all() &&
             volume.origin_m.allFinite() && volume.direction.allFinite(),
         "a place that is not finite");
}

}  // namespace sulcus::fuzz
