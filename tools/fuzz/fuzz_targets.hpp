#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace sulcus::fuzz {

// Each gives bytes to a reader as if they were a file that somebody handed over. It returns where
// the reader takes them or refuses them in one line (InputError); whatever else comes out is a
// finding: an exception that the program would not expect, a sanitizer's report, a hang.
// tools/fuzz/run searches for such bytes; tests/fuzz/corpus_test.cpp runs those that are kept.

using Bytes = std::span<const std::uint8_t>;

/// A scene; behind a byte of 0, one a line, what --set changes of it.
void fuzz_scene(Bytes bytes);
/// A mesh; the first byte is the first letter of its format: stl, obj, ply.
void fuzz_mesh(Bytes bytes);
/// A volume; the first byte tells its format: nrrd, mha, nii, g for nii.gz, tif, dcm.
void fuzz_volume(Bytes bytes);
/// A table of poses.
void fuzz_trajectory(Bytes bytes);
/// A title or a name, for every language that it gets into.
void fuzz_text(Bytes bytes);
/// A recording: see fuzz_recording.cpp for how the bytes change one.
void fuzz_recording(Bytes bytes);

struct FuzzTarget {
  const char* name;  // of its folder in tests/fuzz, too
  void (*run)(Bytes);
};

inline constexpr std::array<FuzzTarget, 6> kFuzzTargets{{{"scene", fuzz_scene},
                                                         {"mesh", fuzz_mesh},
                                                         {"volume", fuzz_volume},
                                                         {"trajectory", fuzz_trajectory},
                                                         {"text", fuzz_text},
                                                         {"recording", fuzz_recording}}};

}  // namespace sulcus::fuzz
