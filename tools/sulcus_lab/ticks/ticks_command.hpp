#pragma once

#include <CLI/CLI.hpp>

namespace sulcus::lab {

/// `sulcus-lab ticks`: time of a whole tick against the voxels in contact.
void add_ticks_command(CLI::App& program);

}  // namespace sulcus::lab
