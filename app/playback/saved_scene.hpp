#pragma once

#include <optional>
#include <string>

#include "engine/scene/scene.hpp"
#include "engine/scene/section.hpp"

namespace sulcus {

/// What was done under the mouse as a scene: that with which it ended, with the recording as its
/// trajectory, so that a run of it does the work again: where there was a device, its limits and no
/// hand on it. It is to lie in the folder of the recording, to which its paths are relative where
/// they have any of it in common. `section`: of the picture. InputError where another body is read
/// from a file, whose path would not hold.
std::string saved_scene(const Scene& scene, const std::string& recording,
                        const std::optional<Section>& section);

}  // namespace sulcus
