#pragma once

#include <optional>

#include "engine/cache/hash128.hpp"

namespace sulcus {

/// Which code is running: the hash of the build ids that the linker wrote into the program and
/// into every library it has loaded. It changes with every change of a source, a compiler, a flag
/// or a library, also where no revision is committed, and costs no file to be read. Found once,
/// at the first call. Empty where the program carries no build id.
std::optional<Hash128> program_id();

}  // namespace sulcus
