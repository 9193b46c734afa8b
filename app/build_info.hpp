#pragma once

#include <string>

namespace sulcus {

/// Which program this is: version, revision, compiler, build type.
std::string build_info();

}  // namespace sulcus
