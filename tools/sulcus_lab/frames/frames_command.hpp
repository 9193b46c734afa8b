#pragma once

#include <CLI/CLI.hpp>

namespace sulcus::lab {

/// sulcus-lab frames: frames.csv, how fluently a run at real pace is drawn, and what drawing it
/// costs its ticks.
void add_frames_command(CLI::App& program);

}  // namespace sulcus::lab
