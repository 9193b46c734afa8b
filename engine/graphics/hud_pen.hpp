#pragma once

#include <string>

#include <imgui.h>

#include "engine/graphics/camera.hpp"
#include "engine/graphics/frame_state.hpp"
#include "engine/surface/colour_scale.hpp"

namespace sulcus {

inline constexpr ImU32 kInk = IM_COL32(34, 40, 49, 255);
inline constexpr ImU32 kFaint = IM_COL32(34, 40, 49, 150);
inline constexpr ImU32 kCard = IM_COL32(255, 255, 255, 150);
inline constexpr ImU32 kGrid = IM_COL32(34, 40, 49, 38);

/// What a drawing function needs: everything in pixels of a frame 720 high, scaled here.
struct Pen {
  ImDrawList* list;
  ImFont* font;
  ImFont* title_font;
  float scale;

  ImVec2 at(float x, float y) const { return {x * scale, y * scale}; }
  void text(float x, float y, ImU32 colour, const std::string& words, float size = 15.0f) const {
    list->AddText(size > 18.0f ? title_font : font, size * scale, at(x, y), colour, words.c_str());
  }
  void text_right(float x, float y, ImU32 colour, const std::string& words,
                  float size = 15.0f) const {
    const float wide = font->CalcTextSizeA(size * scale, 1e6f, 0.0f, words.c_str()).x / scale;
    text(x - wide, y, colour, words, size);
  }
};

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
