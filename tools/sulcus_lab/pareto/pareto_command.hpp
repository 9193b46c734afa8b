#pragma once

#include <CLI/CLI.hpp>

namespace sulcus::lab {

/// `sulcus-lab pareto`: what a tick costs against how true its force is, on the molar.
void add_pareto_command(CLI::App& program);

}  // namespace sulcus::lab
