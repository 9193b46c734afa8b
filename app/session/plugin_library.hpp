#pragma once

#include <string>
#include <vector>

#include "haptics/device/sulcus_device.h"

namespace sulcus {

/// Loads the plug-in of a name, which has been checked to be no path, from the first folder that
/// has it; it stays loaded until the process ends, since threads of its own may outlive its device.
/// InputError where there is none (`scene_file` is what named it), or where it cannot be loaded,
/// lacks the entry or a function, or is of a version of the interface that is not known.
const SulcusDevicePlugin& load_plugin(const std::string& name,
                                      const std::vector<std::string>& folders,
                                      const std::string& scene_file);

}  // namespace sulcus
