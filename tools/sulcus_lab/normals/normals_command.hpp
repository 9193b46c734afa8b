#pragma once

#include <CLI/CLI.hpp>

namespace sulcus::lab {

/// Adds `normals`: errors and times of the normal methods on shapes whose normals are known, as
/// tables and charts. Its callback throws InputError (status 2) or another std::exception
/// (status 1).
void add_normals_command(CLI::App& program);

}  // namespace sulcus::lab
