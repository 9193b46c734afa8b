#pragma once

#include <string>
#include <vector>

namespace sulcus {

// What `sulcus inspect` prints, one room for each kind of file. All throw InputError for a file
// that is not what its name says.

/// Header, ticks, edits, what is missing.
void inspect_recording(const std::string& file);
/// What it names; the files that it names are not opened.
void inspect_scene(const std::string& file, const std::vector<std::string>& overrides);
/// Size, signed volume within the triangles, and how many edges have no partner in the other
/// direction.
void inspect_mesh(const std::string& file);
/// Size, spacing and values.
void inspect_volume(const std::string& file);

}  // namespace sulcus
