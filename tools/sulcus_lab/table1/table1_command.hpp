#pragma once

#include <CLI/CLI.hpp>

namespace sulcus::lab {

/// Adds `table1`: Table 1 and figs. 5 and 6 of Kim and Park (2019) from one run. Its callback
/// throws InputError (status 2) or another std::exception (status 1).
void add_table1_command(CLI::App& program);

}  // namespace sulcus::lab
