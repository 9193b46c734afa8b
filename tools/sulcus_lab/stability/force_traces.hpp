#pragma once

#include <span>
#include <string>

#include "tools/sulcus_lab/stability/stability_row.hpp"

namespace sulcus::lab {

/// A case's runs as stability_forces.gp reads them: run,method,label,time_s,force_N,depth_mm, an
/// empty line between two runs. Of long runs what is seen of them in a picture; the depth is empty
/// where it was not measured.
void write_force_traces(std::span<const ForceTrace> traces_of_one_case,
                        const std::string& file_csv);

}  // namespace sulcus::lab
