#pragma once

#include "engine/graphics/camera.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/graphics/hud_pen.hpp"
#include "engine/surface/colour_scale.hpp"

namespace sulcus {

/// A scale of colours on a card, the `place`-th from the left, above the scale bar of a frame that
/// is `tall` high.
void draw_colour_scale(const Pen& pen, int place, float tall, const ColourScale& scale);

/// By how much force each voxel in contact has, from 0 to a round number.
ColourScale contact_scale(const FrameState& state);

/// FrameState::contact_marks over the picture, through whatever stands before them, the farthest
/// from the eye first.
void draw_contact_marks(const Pen& pen, const FrameState& state, const View& view, float wide,
                        float tall, const ColourScale& scale);

}  // namespace sulcus
