#pragma once

#include <cstdint>
#include <string>

namespace sulcus {

/// Whether a volume that was just written compressed, as NRRD, MetaImage in one file or NIfTI,
/// holds all of its stream: that it ends where the file ends, and unpacks to these many bytes at
/// least (of the voxels; NIfTI's header comes ahead). Their writer does not see a full disk.
/// @throws std::runtime_error where it cannot be read.
bool is_whole_volume(const std::string& path, std::uint64_t bytes);

}  // namespace sulcus
