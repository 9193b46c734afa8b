#pragma once

#include <CLI/CLI.hpp>

namespace sulcus::lab {

/// `sulcus-lab stability`: see its --help.
void add_stability_command(CLI::App& program);

}  // namespace sulcus::lab
