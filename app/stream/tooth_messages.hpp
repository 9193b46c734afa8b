#pragma once

#include <string>

#include "app/stream/message_time.hpp"
#include "app/stream/stream_client.hpp"
#include "engine/volume/voxel_model.hpp"

namespace sulcus {

// The tooth as it is at a time, for who asks for it. Any thread; takes seconds of a large one, and
// the memory of a message.

/// POLYDATA: the closed surface, as `sulcus export --mesh` writes it, mm, as float32. Without a
/// body where nothing is left. Computed on the calling thread alone.
StreamBytes tooth_polydata(const VoxelModel& model, const std::string& name, MessageTime time);

/// IMAGE: voxels, 0 empty, else 1 + tissue, as `sulcus export --volume` writes them: of the box of
/// leaves that hold what is left. The axes are the scene's. Without a body where nothing is left.
StreamBytes tooth_image(const VoxelModel& model, const std::string& name, MessageTime time);

// What answers other requests, in a moment.

/// That there is no such data: a message without a body.
StreamBytes no_data(const std::string& type, const std::string& name);
/// CAPABILITY: the types of messages that may be sent. (The library's class for it loses memory
/// each time that it packs.)
StreamBytes capability(const std::string& name);

}  // namespace sulcus
