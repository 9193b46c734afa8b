#pragma once

#include <CLI/CLI.hpp>

namespace sulcus::lab {

/// `sulcus-lab recordings`: what a recording survives, and how fast it is gone through.
void add_recordings_command(CLI::App& program);

}  // namespace sulcus::lab
